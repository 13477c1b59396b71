"""Pictures: every module draws one thing on a figure it returns; ``save`` writes it."""

"""Pilotfish: a robot follows another robot by sight alone.

The rooms of the C++ library are extension modules of the same names, loaded one by one (``pilotfish.core``,
``.fuzzy``, ``.vision``, ``.control``, ``.coordinator``, ``.capture``, ``.bus``, ``.sim``). On top of them, in
Python: ``operating`` talks to a running coordinator, ``harness`` runs scenarios, ``experiments`` holds the source
paper's two, ``metrics`` and ``plots`` judge and draw, ``body_learning`` finds where a leader's tags sit, ``cli`` is the
command line.
"""

__version__ = "0.1.0"

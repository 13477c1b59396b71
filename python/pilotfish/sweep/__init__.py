"""Campaigns: thousands of variants of a scenario, on one machine or many, and what comes of them.

``campaign`` reads a campaign's file, ``run`` simulates it, ``results`` reads what was written; ``intervals`` and
``sensitivity`` are the statistics. The command is ``pilotfish sweep``.
"""

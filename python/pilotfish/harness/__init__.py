"""Runs the machine: in this process, over LCM with the real programs, or on pictures in a folder."""

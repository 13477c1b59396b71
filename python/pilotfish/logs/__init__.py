"""Recorded runs: reading them as arrays, and writing them in other formats.

from pilotfish.logs import read_run

run = read_run("/var/lib/pilotfish")
frames = run.robots["robot1"].frames
print(frames["t_s"], frames["distance_m"], frames.words("status"))
"""

from pilotfish.logs.columns import TABLES, Column
from pilotfish.logs.notes import RunNotes, Settings, SettingsFile, Stage
from pilotfish.logs.reader import read_run
from pilotfish.logs.rows import Row, rows_in
from pilotfish.logs.run import RobotRun, Run, RunEvent, Table

__all__ = [
    "TABLES",
    "Column",
    "RobotRun",
    "Row",
    "Run",
    "RunEvent",
    "RunNotes",
    "Settings",
    "SettingsFile",
    "Stage",
    "Table",
    "read_run",
    "rows_in",
]

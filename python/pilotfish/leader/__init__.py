"""A leader's body, looked at before it drives: what can be wrong with its file, and from where it can be seen."""

from pilotfish.leader.checks import Finding, Level, check_leader
from pilotfish.leader.load import load_leader
from pilotfish.leader.reach import TagReach, Viewer, tag_reach
from pilotfish.leader.sheets import Sheet, sheet_of
from pilotfish.leader.visibility import Sector, Visibility, look_all_round

__all__ = [
    "Finding",
    "Level",
    "Sector",
    "Sheet",
    "TagReach",
    "Viewer",
    "Visibility",
    "check_leader",
    "load_leader",
    "look_all_round",
    "sheet_of",
    "tag_reach",
]

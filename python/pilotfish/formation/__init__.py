"""Formations as data: who stands where and watches whom, how a formation changes, and whether it holds."""

from pilotfish.formation.file import Formation, Stage, find_formation, formations, load_formation
from pilotfish.formation.shapes import SHAPES, Branch, Shape, places
from pilotfish.formation.watching import Watch

__all__ = [
    "SHAPES",
    "Branch",
    "Formation",
    "Shape",
    "Stage",
    "Watch",
    "find_formation",
    "formations",
    "load_formation",
    "places",
]

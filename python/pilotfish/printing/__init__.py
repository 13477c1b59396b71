"""Sheets at true scale: tags, folding leaders and calibration boards as PDF, drawn as vectors.

``loose_tag_pages``, ``body_pages`` and ``board_pages`` make pages, which are data; ``write_pdf`` writes them.
``folded_screen`` designs a leader whose tags sit on one folded sheet.
"""

from pilotfish.printing.board_sheet import board_pages
from pilotfish.printing.body_sheets import body_pages
from pilotfish.printing.page import Page
from pilotfish.printing.paper import Paper, parse_paper
from pilotfish.printing.pdf import write_pdf
from pilotfish.printing.quantities import parse_ids, parse_length_m
from pilotfish.printing.screen import folded_screen
from pilotfish.printing.tag_art import TagArt, tag_art
from pilotfish.printing.tag_sheets import loose_tag_pages

__all__ = [
    "Page",
    "Paper",
    "TagArt",
    "board_pages",
    "body_pages",
    "folded_screen",
    "loose_tag_pages",
    "parse_ids",
    "parse_length_m",
    "parse_paper",
    "tag_art",
    "write_pdf",
]

"""Text from elsewhere (a bus, a file) for a terminal, which obeys control characters."""

from __future__ import annotations

import re

# C0 but newline and tab, DEL, C1, and what turns the direction of writing around (Unicode TR 9)
_CONTROLS = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")


def printable(text: str) -> str:
    r"""With \x1b for the character that it is."""
    return _CONTROLS.sub(lambda found: found[0].encode("unicode_escape").decode(), text)

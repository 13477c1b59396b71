"""Links, headings and code in Markdown, as far as the documents of this repository use it. No Sphinx needed."""

import posixpath
import re
from collections.abc import Callable, Iterator

FENCE = re.compile(r"^\s*(```+|~~~+)")
CODE_SPAN = re.compile(r"(``[^`]*``|`[^`]*`)")
TARGET = re.compile(r"\]\(([^()\s]+)\)")


def lines_with_code_marked(text: str) -> Iterator[tuple[str, bool]]:
    """Each line, and whether it belongs to a fenced block of code (the fences do)."""
    fence = None
    for line in text.splitlines():
        match = FENCE.match(line)
        if fence is None and match:
            fence = match[1]
            yield line, True
        elif fence is not None:
            yield line, True
            if match and match[1].startswith(fence) and line.strip() == match[1]:
                fence = None
        else:
            yield line, False


def with_targets_replaced(text: str, replace: Callable[[str], str]) -> str:
    """The text with every link's and picture's target replaced, outside of code."""

    def in_prose(line: str) -> str:
        # A target is parenthesised behind the bracket, so code within the brackets does not hide it.
        parts = CODE_SPAN.split(line)
        return "".join(
            part if part.startswith("`") else TARGET.sub(lambda match: f"]({replace(match[1])})", part)
            for part in parts
        )

    lines = (line if is_code else in_prose(line) for line, is_code in lines_with_code_marked(text))
    return "\n".join(lines) + "\n"


def targets(text: str) -> list[str]:
    """Every link's and picture's target, in order, with its fragment."""
    found: list[str] = []
    with_targets_replaced(text, lambda target: found.append(target) or target)
    return found


def is_outside(target: str) -> bool:
    """Whether a target is an address rather than a file of this repository or a place on the page."""
    return re.match(r"[a-z][a-z0-9+.-]*:", target) is not None


def headings(text: str) -> list[str]:
    """Every heading's text, in order."""
    found = (re.match(r"#{1,6}\s+(.*?)\s*#*$", line) for line, is_code in lines_with_code_marked(text) if not is_code)
    return [match[1] for match in found if match]


def anchor(heading: str) -> str:
    """What a forge calls the place of a heading: lower case, spaces to hyphens, everything else but letters gone."""
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
    return re.sub(r"[^\w\- ]", "", plain.lower()).replace(" ", "-")


def resolved(page: str, target: str) -> tuple[str, str]:
    """The file or folder that a target on a page means, from the repository's root, and its fragment."""
    path, _, fragment = target.partition("#")
    return (posixpath.normpath(posixpath.join(posixpath.dirname(page), path)) if path else page), fragment

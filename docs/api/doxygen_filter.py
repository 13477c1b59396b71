"""A header as Doxygen shall read it: parameters as the members that they are, with their text and range.

PILOTFISH_PARAMETER (core/parameter.hpp) holds all of them in one line, which Doxygen would not look into.
"""

import re
import sys
from pathlib import Path

TEXT = r'((?:"(?:[^"\\]|\\.)*"\s*)+)\);'
PARAMETER = re.compile(
    r"(?m)^  PILOTFISH_PARAMETER\(\s*([\w:]+),\s*(\w+),\s*([^,]+?),\s*([^,]+?),\s*([^,]+?),\s*" + TEXT
)
WITHOUT_RANGE = re.compile(r"(?m)^  PILOTFISH_PARAMETER_WITHOUT_RANGE\(\s*([\w:]+),\s*(\w+),\s*([^,]+?)(),()\s*" + TEXT)
TABLE = re.compile(r"(?m)^  PILOTFISH_PARAMETERS\((\w+)\);")

SEVERAL = re.compile(
    r"^(\s+)((?:double|Eigen::Vector3d|std::optional<std::string>)) ([\w .=]+(?:, [\w .=]+)+);(?:\s*///<.*)?$"
)


def as_member(match: re.Match) -> str:
    """``double name = default;  ///< text [min, max]``, on as many lines as it had."""
    kind, name, default, low, high, text = match.groups()
    words = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', text)) + (f" [{low}, {high}]" if low else "")
    return f"  {kind} {name} = {default};  ///< {words}" + "\n" * match[0].count("\n")


def as_table(match: re.Match) -> str:
    return (
        f"  static const std::vector<Parameter<{match[1]}>>& parameters();"
        "  ///< The table of its parameters: keys, ranges and texts."
    )


def one_each(line: str, comment: list[str]) -> str:
    """``double a, b;`` as two declarations, each with the comment above: Doxygen gives it to the first alone."""
    match = SEVERAL.match(line)
    if not (match and comment):
        return line
    first, *others = match[3].split(",")
    text = " ".join(part.lstrip("/ ") for part in comment)
    return f"{match[1]}{match[2]} {first};" + "".join(f" /** {text} */ {match[2]} {other.strip()};" for other in others)


def described(text: str) -> str:
    for pattern in (PARAMETER, WITHOUT_RANGE):
        text = pattern.sub(as_member, text)
    comment, lines = [], []
    for line in TABLE.sub(as_table, text).splitlines():
        lines.append(one_each(line, comment))
        comment = [*comment, line.strip()] if line.lstrip().startswith("/// ") else []
    return "\n".join(lines)


if __name__ == "__main__":
    path = Path(sys.argv[1])
    print(described(path.read_text()) if path.suffix == ".hpp" else path.read_text())

"""A header as Doxygen shall read it: members that a table of parameters() describes get the table's text and range.

A parameter is described once, in its table in src/ (CONTRIBUTING.md); the header would only say it again.
"""

import re
import sys
from pathlib import Path

TABLE = re.compile(r"& (\w+)::parameters\(\) \{(.*?)\n\}", re.DOTALL)
ROW = re.compile(r'\{\s*"(\w+)",\s*&\w+::(\w+),\s*([^,{}"]+?),\s*([^,{}"]+?),\s*((?:"(?:[^"\\]|\\.)*"\s*)+)\}')
TEXT_ROW = re.compile(r'\{\s*"(\w+)",\s*&\w+::(\w+),()()\s*\{\},\s*\{\},\s*((?:"(?:[^"\\]|\\.)*"\s*)+)\}')
STRUCT = re.compile(r"^(?:struct|class) (\w+)\b[^;]*$")
MEMBER = re.compile(r"^\s+[\w:<>, ]+ (\w+)(?: = [^;]*|\{[^;]*\})?;$")

SEVERAL = re.compile(
    r"^(\s+)((?:double|Eigen::Vector3d|std::optional<std::string>)) ([\w .=]+(?:, [\w .=]+)+);(?:\s*///<.*)?$"
)


def tables(folder: Path) -> dict[tuple[str, str], str]:
    """(struct, member): text and range."""
    texts = {}
    for source in sorted(folder.glob("*.cpp")):
        for struct, body in TABLE.findall(source.read_text()):
            for pattern in (ROW, TEXT_ROW):
                for _, member, low, high, text in pattern.findall(body):
                    words = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', text))
                    texts[struct, member] = words + (f" [{low}, {high}]" if low else "")
    return texts


def one_each(line: str, comment: list[str]) -> str:
    """``double a, b;`` as two declarations, each with the comment above: Doxygen gives it to the first alone."""
    match = SEVERAL.match(line)
    if not (match and comment):
        return line
    first, *others = match[3].split(",")
    text = " ".join(part.lstrip("/ ") for part in comment)
    return f"{match[1]}{match[2]} {first};" + "".join(f" /** {text} */ {match[2]} {other.strip()};" for other in others)


def described(header: Path) -> str:
    texts = tables(Path("src") / header.parent.name)
    struct, comment, lines = "", [], []
    for line in header.read_text().splitlines():
        if match := STRUCT.match(line):
            struct = match[1]
        text = None
        if not comment:
            if line.strip().endswith(" parameters();"):
                text = "The table of its parameters: keys, ranges and texts."
            elif (match := MEMBER.match(line)) and (struct, match[1]) in texts:
                text = texts[struct, match[1]]
        lines.append(f"{line}  ///< {text}" if text else one_each(line, comment))
        comment = [*comment, line.strip()] if line.lstrip().startswith("/// ") else []
    return "\n".join(lines)


if __name__ == "__main__":
    path = Path(sys.argv[1]).resolve().relative_to(Path.cwd())
    print(described(path) if path.suffix == ".hpp" else path.read_text())

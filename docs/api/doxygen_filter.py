"""A header as Doxygen shall read it: members that a table of parameters() describes get the table's text and range, and
where a list (``#define PILOTFISH_REASONS(X)``, rows ``X(name, ..., "text")``) makes members or enumerators, they stand
there with the list's text.

A thing is described once (CONTRIBUTING.md); the header would only say it again.
"""

import re
import sys
from pathlib import Path

TABLE = re.compile(r"& (\w+)::parameters\(\) \{(.*?)\n\}", re.DOTALL)
ROW = re.compile(r'\{\s*"(\w+)",\s*&\w+::(\w+),\s*([^,{}"]+?),\s*([^,{}"]+?),\s*((?:"(?:[^"\\]|\\.)*"\s*)+)\}')
TEXT_ROW = re.compile(r'\{\s*"(\w+)",\s*&\w+::(\w+),()()\s*\{\},\s*\{\},\s*((?:"(?:[^"\\]|\\.)*"\s*)+)\}')
STRUCT = re.compile(r"^(?:struct|class) (\w+)\b[^;]*$")
MEMBER = re.compile(r"^\s+[\w:<>, ]+ (\w+)(?: = [^;]*|\{[^;]*\})?;$")

LIST = re.compile(r"^#define (PILOTFISH_\w+)\(((?:X|FRAME|LOOP)(?:, \w+)*)\)((?:.*\\\n)+.*)", re.MULTILINE)
MACRO = re.compile(r"^#define (PILOTFISH_\w+)\((\w+(?:, \w+)*)\) (.*)$")
USE = re.compile(r"^\s+(PILOTFISH_\w+)\((PILOTFISH_\w+(?:, PILOTFISH_\w+)*)\)$")
DECLARATION = re.compile(r"^(?:[\w:]+ )?\w+(?: = \w+|\{\})?[;,]$")

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


def split_arguments(text: str) -> tuple[list[str], int]:
    """The arguments up to the closing parenthesis, and where that is."""
    arguments, depth, start = [], 0, 0
    for match in re.finditer(r'"(?:[^"\\]|\\.)*"|[(),]', text):
        if match[0] == "(":
            depth += 1
        elif match[0] == ")" and depth:
            depth -= 1
        elif match[0] in {",", ")"} and not depth:
            arguments.append(text[start : match.start()].strip())
            start = match.end()
            if match[0] == ")":
                return arguments, match.end()
    raise ValueError(f"no end of the arguments: {text[:80]}")


def lists_of(text: str) -> dict[str, list[tuple[int, list[str]]]]:
    """Rows by the name of their list: which of the list's parameters is called, and with what."""
    lists = {}
    for name, parameters, body in LIST.findall(text):
        called, rows, end = parameters.split(", "), [], 0
        row = re.compile(rf"\b({'|'.join(called)})\(")
        body = body.replace("\\\n", " ")
        while match := row.search(body, end):
            arguments, length = split_arguments(body[match.end() :])
            rows.append((called.index(match[1]), arguments))
            end = match.end() + length
        lists[name] = rows
    return lists


def expanded(text: str) -> str:
    """Uses of lists that make members or enumerators, as these."""
    whole = text
    for include in re.findall(r'#include "(pilotfish/[\w/]+\.hpp)"', text):
        whole += Path("include", include).read_text()
    lists, macros, lines = lists_of(whole), {}, []
    for line in text.splitlines():
        if match := MACRO.match(line):
            macros[match[1]] = (match[2].split(", "), match[3].strip())
        use = USE.match(line)
        called = [macros.get(name, ([], "")) for name in use[2].split(", ")] if use else []
        if not (use and use[1] in lists and called and all(DECLARATION.match(body) for _, body in called)):
            lines.append(line)
            continue
        for which, arguments in lists[use[1]]:
            names, body = called[which]
            values = dict(zip(names, arguments, strict=True))
            words = "".join(re.findall(r'"((?:[^"\\]|\\.)*)"', values["text"])) or "nothing to say"
            unit = values.get("unit", '""').strip('"')
            declaration = re.sub(r"\w+", lambda word, by=values: by.get(word[0], word[0]), body)
            lines.append(f"  {declaration}  ///< {words}" + (f" [{unit}]" if unit else ""))
    return "\n".join(lines)


def described(header: Path) -> str:
    texts = tables(Path("src") / header.parent.name)
    struct, comment, lines = "", [], []
    for line in expanded(header.read_text()).splitlines():
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

"""A header as Doxygen shall read it: parameters as the members that they are, with their text and range, and where a list
(``#define PILOTFISH_REASONS(X)``, rows ``X(name, ..., "text")``) makes members or enumerators, these with the list's text.

A thing is described once (CONTRIBUTING.md): PILOTFISH_PARAMETER (core/parameter.hpp) and the lists hold all of it in one
line, which Doxygen would not look into.
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

LIST = re.compile(r"^#define (PILOTFISH_\w+)\(((?:X|FRAME|LOOP)(?:, \w+)*)\)((?:.*\\\n)+.*)", re.MULTILINE)
MACRO = re.compile(r"^#define (PILOTFISH_\w+)\((\w+(?:, \w+)*)\) (.*)$")
USE = re.compile(r"^\s+(PILOTFISH_\w+)\((PILOTFISH_\w+(?:, PILOTFISH_\w+)*)\)$")
DECLARATION = re.compile(r"^(?:[\w:]+ )?\w+(?: = \w+|\{\})?[;,]$")

SEVERAL = re.compile(
    r"^(\s+)((?:static constexpr )?(?:double|std::size_t|Eigen::Vector3d|std::optional<std::string>)) "
    r"([\w ./=-]+(?:, [\w ./=-]+)+);(?:\s*///<\s*(.*))?$"
)
# A comment behind an opening brace is within the body; before it, it belongs to what is declared.
BEHIND_A_BRACE = re.compile(r"^(\s+)(.*?) \{\s*///<\s*(.*)$")
# What a section says of itself wherever it is shown: its text is the struct's own comment once more.
SELF_DESCRIPTION = re.compile(r"^(\s+static constexpr const char\* kText =.*)$", re.MULTILINE)


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
    """``double a, b;`` as two declarations, each with the comment above or behind: Doxygen gives it to one alone."""
    match = SEVERAL.match(line)
    if not match or not (comment or match[4]):
        return line
    text = " ".join([*(part.lstrip("/ ") for part in comment), match[4] or ""]).strip()
    return match[1] + " ".join(f"/** {text} */ {match[2]} {name.strip()};" for name in match[3].split(","))


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


def described(text: str) -> str:
    for pattern in (PARAMETER, WITHOUT_RANGE):
        text = pattern.sub(as_member, text)
    text = SELF_DESCRIPTION.sub(r"  /// The section's text, where it is shown.\n\1", text)
    comment, lines = [], []
    for line in expanded(TABLE.sub(as_table, text)).splitlines():
        lines.append(BEHIND_A_BRACE.sub(r"\1/** \3 */ \2 {", one_each(line, comment)))
        comment = [*comment, line.strip()] if line.lstrip().startswith("/// ") else []
    return "\n".join(lines)


if __name__ == "__main__":
    path = Path(sys.argv[1])
    print(described(path.read_text()) if path.suffix == ".hpp" else path.read_text())

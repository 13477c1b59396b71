"""The fault matrix as Markdown: faults.yaml, and the tests that carry each row's mark.

python tests/faults/matrix.py > docs/faults.md
"""

from __future__ import annotations

import ast
from pathlib import Path

import yaml

TESTS = Path(__file__).parents[1]
HEAD = """# Faults

What can go wrong on a robot, what must happen then, and the tests that see to it. Made from `tests/faults/faults.yaml` and the
tests' own marks (`python tests/faults/matrix.py > docs/faults.md`); a row without a test fails the run. No camera, wheels or
serial line of iron took part: cameras are a fake at the system calls' edge, wheels a pseudo-terminal.
"""


def load_faults() -> dict[str, dict[str, dict[str, str]]]:
    """{chapter: {id: {"fault": ..., "must": ...}}}."""
    return yaml.safe_load((Path(__file__).parent / "faults.yaml").read_text())


def _marks_of(decorators: list[ast.expr]) -> list[str]:
    marks = []
    for call in decorators:
        if isinstance(call, ast.Call) and ast.unparse(call.func) == "pytest.mark.fault":
            marks += [ast.literal_eval(argument) for argument in call.args]
    return marks


def tests_by_fault() -> dict[str, list[str]]:
    """{id: ["tests/bus/test_x.py: test_y", ...]}, read from the sources; marks on classes and in pytestmark count for all."""
    found: dict[str, list[str]] = {}
    for file in sorted(TESTS.rglob("test_*.py")):
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                for mark in _marks_of(node.decorator_list):
                    found.setdefault(mark, []).append(f"{file.relative_to(TESTS.parent)}: {node.name}")
    return found


def as_markdown() -> str:
    tests = tests_by_fault()
    lines = [HEAD]
    for chapter, faults in load_faults().items():
        lines += [f"## {chapter.capitalize()}", "", "| fault | what must happen | tests |", "|---|---|---|"]
        for name, row in faults.items():
            seen = "<br>".join(f"`{test.split(': ')[1]}`" for test in tests.get(name, []))
            lines.append(f"| {row['fault']} | {row['must']} | {seen} |")
        lines.append("")
    return "\n".join(lines).rstrip() + "\n"


if __name__ == "__main__":
    print(as_markdown(), end="")

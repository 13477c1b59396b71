"""Every module of the Python package, and each public class, function and method in it, says what it is."""

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "python" / "pilotfish"
FILES = sorted(PACKAGE.rglob("*.py"))


def undocumented(node, prefix=""):
    """Dotted names below a module or a class. What begins with an underscore is private."""
    for each in node.body:
        if not isinstance(each, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) or each.name.startswith("_"):
            continue
        if not ast.get_docstring(each):
            yield prefix + each.name
        if isinstance(each, ast.ClassDef):
            yield from undocumented(each, f"{prefix}{each.name}.")


@pytest.mark.parametrize("file", FILES, ids=lambda file: str(file.relative_to(PACKAGE)))
def test_everything_public_is_documented(file):
    module = ast.parse(file.read_text())
    assert ast.get_docstring(module), "the module says nothing of itself"
    assert list(undocumented(module)) == []


def test_what_has_no_docstring_is_found():
    text = "def f(): pass\nclass C:\n  'said'\n  def g(self): pass\n  def _h(self): pass\ndef _i(): pass\n"
    assert list(undocumented(ast.parse(text))) == ["f", "C.g"]
    assert len(FILES) > 50, "nothing is tested"

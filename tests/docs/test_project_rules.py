"""Rules of the house that a machine can keep."""

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = [*ROOT.glob("src/*/*.cpp"), *ROOT.glob("include/pilotfish/*/*.hpp")]

# The arrows of the architecture: module -> modules it may include. CMake enforces them at compile time; this says them
# again in one place, so that changing an arrow is a decision and not an accident.
MAY_INCLUDE = {
    "core": set(),
    "fuzzy": set(),
    "vision": {"core"},
    "visp": {"core", "vision"},
    "control": {"core", "fuzzy"},
    "coordinator": {"core", "vision", "control"},
    "jpeg": {"core"},
    "capture": {"core", "jpeg"},
    "bus": {"core", "jpeg"},
    "sim": {"core"},
    "config": {"core", "fuzzy", "vision", "control", "coordinator", "sim", "base"},
    "blackbox": {"core", "coordinator", "config", "jpeg"},
    "base": {"core"},
}


def module_of(path: Path) -> str:
    return path.parent.name


@pytest.mark.parametrize("module", MAY_INCLUDE)
def test_a_module_includes_only_the_modules_it_may(module):
    files = [path for path in SOURCES if module_of(path) == module]
    assert files, f"no file in module {module}: the test would test nothing"
    for path in files:
        included = set(re.findall(r'#include "pilotfish/(\w+)/', path.read_text())) - {module}
        assert included <= MAY_INCLUDE[module], f"{path.relative_to(ROOT)} includes {included - MAY_INCLUDE[module]}"


def test_no_source_file_holds_more_than_400_lines():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
    long = [
        name
        for name in listed
        if name.endswith((".cpp", ".hpp", ".py", ".cmake")) and len((ROOT / name).read_text().splitlines()) > 400
    ]
    assert long == []


def test_every_decision_has_a_number_of_its_own():
    names = sorted(path.name for path in (ROOT / "docs" / "decisions").glob("*.md"))
    assert names and all(re.fullmatch(r"\d{4}-[a-z0-9-]+\.md", name) for name in names)
    assert len({name[:4] for name in names}) == len(names)

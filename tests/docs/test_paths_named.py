"""Paths that the documents name exist: who copies a command from a page finds the file that it names."""

import re

import pytest

from build_tree import ROOT

PAGES = [
    ROOT / "README.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *ROOT.glob("examples/**/*.md"),
]
FOLDERS = "bench|data|docs|examples|include|lcmtypes|packaging|scripts|src"
# Not within another path or an address; up to its last letter, digit, star or slash.
PATH = re.compile(rf"(?<![\w./~$-])(?:\.\./)*(?:{FOLDERS})/(?:[\w./*-]*[\w*/])?")


def named_in(text):
    """The paths, without those in which capitals stand for a name of one's own (data/tuned/NAME.yaml)."""
    return sorted({path for path in PATH.findall(text) if not re.search(r"\b[A-Z]{4,}\b", path) or "README" in path})


def exists(path, page):
    """From the page's folder, as links are, or from the repository's, as commands are; a pattern names one at least."""
    return any(any(place.glob(path)) if "*" in path else (place / path).exists() for place in (page.parent, ROOT))


@pytest.mark.parametrize("page", PAGES, ids=[str(page.relative_to(ROOT)) for page in PAGES])
def test_every_path_that_a_page_names_exists(page):
    assert [path for path in named_in(page.read_text()) if not exists(path, page)] == []


def test_paths_are_found_in_commands_links_and_sentences():
    text = "plot data/a.csv, [it](../examples/b.md), `src/*.cpp`. https://x.y/docs/c data/tuned/NAME.yaml out/data/d"
    assert named_in(text) == ["../examples/b.md", "data/a.csv", "src/*.cpp"]


def test_many_paths_are_named():
    assert sum(len(named_in(page.read_text())) for page in PAGES) > 150

"""The documentation hangs together: every page is in the sidebar, every link leads somewhere, every picture is there.

scripts/docs builds the site with Sphinx, where any warning is an error; here the same sources are looked at without it,
so that a broken link fails in seconds.
"""

from __future__ import annotations

import importlib
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def _load(name: str):
    sys.path.insert(0, str(ROOT / "docs/site"))
    try:
        return importlib.import_module(name)
    finally:
        sys.path.pop(0)


markdown_links, assemble, check_built_pages = map(_load, ("markdown_links", "assemble", "check_built_pages"))


def tracked(*patterns: str) -> list[str]:
    listed = subprocess.run(["git", "ls-files", *patterns], cwd=ROOT, capture_output=True, text=True, check=True)
    return [path for path in listed.stdout.splitlines() if (ROOT / path).is_file()]


MARKDOWN = tracked("*.md")


@pytest.mark.parametrize("page", MARKDOWN)
def test_every_link_and_picture_of_a_page_leads_to_a_file_and_a_heading(page):
    for target in markdown_links.targets((ROOT / page).read_text()):
        if markdown_links.is_outside(target):
            continue
        path, fragment = markdown_links.resolved(page, target)
        assert (ROOT / path).exists(), f"{target}: {path} is not there"
        if fragment and path.endswith(".md"):
            places = map(markdown_links.anchor, markdown_links.headings((ROOT / path).read_text()))
            assert fragment in set(places), f"{target}: no heading of {path} is called so"


def in_the_sidebar(pages: dict[str, str]) -> set[str]:
    """Every page that a table of contents names, from the first page on."""
    found: set[str] = set()
    waiting = ["index.md"]
    while waiting:
        page = waiting.pop()
        found.add(page)
        trees = re.findall(r"```\{toctree\}\n([^`]*)```|^\.\. toctree::\n((?:   .*\n|\n)*)", pages[page], re.M)
        for line in "\n".join(a or b for a, b in trees).splitlines():
            name = re.sub(r"^.*<(.*)>$", r"\1", line.strip())
            if not name or name.startswith(":"):
                continue
            name = name.removeprefix("/") if name.startswith("/") else str(Path(page).parent / name)
            assert name + ".md" in pages or name + ".rst" in pages, f"{page} names {name}"
            (file,) = [name + suffix for suffix in (".md", ".rst") if name + suffix in pages]
            if file not in found:
                waiting.append(file)
    return found


def test_every_guide_decision_and_reference_is_in_the_sidebar():
    pages = assemble.pages()
    there = in_the_sidebar(pages)
    missing = {page for page in pages if page not in there and "orphan: true" not in pages[page]}
    assert missing == set(), "add a line to docs/index.md (or, in Python, to docs/api/python/index.rst)"
    assert {"tutorial.md", "repository/README.md", "decisions/0001-modules-are-link-targets.md"} <= there


def test_every_guide_is_listed_in_the_index():
    listed = {
        markdown_links.resolved("docs/index.md", target)[0]
        for target in markdown_links.targets((ROOT / "docs/index.md").read_text())
    }
    guides = {path for path in MARKDOWN if re.fullmatch(r"docs/[^/]+\.md", path)} - {"docs/index.md"}
    assert guides - listed == set()


def dead_links(pages: dict[str, str]) -> list[tuple[str, str]]:
    """(page, target) of every link in the site's sources that leads to none of them, pages of folders included."""
    pictures = {f"images/{path.name}" for path in (ROOT / "docs/images").iterdir()}
    return [
        (page, target)
        for page, text in pages.items()
        if page.endswith(".md")
        for target in markdown_links.targets(text)
        if not markdown_links.is_outside(target)
        and markdown_links.resolved(page, target)[0] not in set(pages) | pictures
    ]


def test_adapted_links_lead_to_pages_of_the_site():
    assert dead_links(assemble.pages()) == []


@pytest.mark.parametrize(
    "target", ["../examples/ros2", "../examples/ros2/", "../examples", "../data/scenarios", "../bench/"]
)
def test_a_link_to_a_folder_leads_to_its_readme_or_to_a_list_of_its_files(target, monkeypatch):
    """A folder that has a README.md of its own and is not listed among the documents had a page with dead links."""
    before, linked = assemble.pages(), assemble.linked
    said = f"[x]({target})\n"
    ((folder, _),) = [markdown_links.resolved("docs/tutorial.md", found) for found in markdown_links.targets(said)]
    readme = f"{folder}/README.md"
    with_it = readme if (ROOT / readme).is_file() else folder
    read_text = Path.read_text

    def with_link(path, *how, **more):
        return read_text(path, *how, **more) + (said if path.name == "tutorial.md" else "")

    monkeypatch.setattr(Path, "read_text", with_link)
    after = assemble.pages()
    assert dead_links(after) == []
    assert assemble.place(with_it) in after
    assert set(before) <= set(after)
    assert with_it in linked("docs/tutorial.md")


def test_every_picture_is_shown_by_a_page():
    shown = {
        markdown_links.resolved(page, target)[0]
        for page in MARKDOWN
        for target in markdown_links.targets((ROOT / page).read_text())
    }
    named = "\n".join((ROOT / page).read_text() for page in MARKDOWN)
    unused = {path for path in tracked("docs/images/*") if path not in shown and Path(path).name not in named}
    assert unused <= {"docs/images/view-desktop-dark.png", "docs/images/view-phone-light.png"}


def test_every_public_package_has_a_page_of_the_reference():
    """The command line is described by --help, the generated message types by lcmtypes/*.lcm."""
    package = ROOT / "python/pilotfish"
    packages = {path.parent.name for path in package.glob("*/__init__.py")} - {"cli", "lcmtypes"}
    pages = {path.stem for path in (ROOT / "docs/api/python").glob("*.rst")}
    assert packages - pages == set()
    modules = re.findall(
        r"automodule:: ([\w.]+)", "".join(p.read_text() for p in package.parents[1].glob("docs/api/python/*.rst"))
    )
    python_modules = [name for name in modules if not _compiled(name)]
    assert len(python_modules) > 40
    for name in python_modules:
        file = ROOT / "python" / name.replace(".", "/")
        assert file.with_suffix(".py").is_file() or (file / "__init__.py").is_file(), name


def _compiled(name: str) -> bool:
    return name in {f"pilotfish.{path.name}" for path in (ROOT / "src").iterdir() if path.is_dir()}


def test_links_in_code_are_no_links():
    text = "see [`a](b)`](c.md), `[x](y)` and ![p](q.png)\n```sh\n[x](y)\n```\n[last](#here)\n"
    assert markdown_links.targets("[x](a.md) `[x](y)` ![p](q.png)\n```sh\n[x](y)\n```\n[last](#here)\n") == [
        "a.md",
        "q.png",
        "#here",
    ]
    assert "y" not in markdown_links.targets(text)


def test_anchors_are_those_of_a_forge():
    assert markdown_links.anchor("What is different, and what `x_m` is?") == "what-is-different-and-what-x_m-is"
    assert markdown_links.anchor("The [law](law.md)") == "the-law"


def test_built_pages_with_a_dead_link_or_a_foreign_file_are_found(tmp_path):
    (tmp_path / "a.html").write_text(
        '<link rel="stylesheet" href="https://fonts.example/x.css"><script src="//cdn.example/x.js"></script>'
        '<a href="b.html#there">good</a><a href="b.html#gone">bad</a><a href="c.html">bad</a>'
        '<a href="https://example.org">an address is only followed by people</a>'
    )
    (tmp_path / "b.html").write_text('<p id="there">')
    assert check_built_pages.findings(tmp_path) == [
        "a.html: loads https://fonts.example/x.css",
        "a.html: loads //cdn.example/x.js",
        "a.html: b.html#gone has no such place",
        "a.html: c.html is not there",
    ]


def test_a_folder_without_pages_is_no_site(tmp_path):
    assert check_built_pages.findings(tmp_path) == [f"{tmp_path}: there are no pages"]

"""scripts/tidy.py: clang-tidy sees the sources of a folder together, and finds what it would find in each."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest

TIDY = Path(__file__).resolve().parents[2] / "scripts/tidy.py"
FINDING = "int* {name}() {{ return 0; }}\n"  # modernize-use-nullptr
CLASH = "namespace {{ constexpr int kCount = {count}; }}\nint {name}() {{ return kCount; }}\n"


class Tree:
    """A folder of sources and the compile database that says how they are built."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()
        self.sources: list[Path] = []

    def source(self, name: str, text: str) -> Path:
        path = self.root / "src" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        self.sources.append(path)
        return path

    def tidy(self, *options: str, sources: list[Path] | None = None) -> subprocess.CompletedProcess[str]:
        build = self.root / "build"
        build.mkdir(exist_ok=True)
        command = " ".join(["c++ -std=c++17 -Wall -Werror", *options, "-o {0}.o -c {0}"])
        database = [
            {"directory": str(build), "file": str(path), "command": command.format(path)} for path in self.sources
        ]
        (build / "compile_commands.json").write_text(json.dumps(database))
        words = [sys.executable, TIDY, build, *(sources or self.sources)]
        return subprocess.run(words, capture_output=True, text=True, timeout=300)

    def seen_together(self) -> list[list[Path]]:
        """What the generated sources include: a group that was seen, or one that was tried."""
        generated = sorted(self.root.glob("build/tidy/*/together.cpp"))
        return [[Path(name) for name in re.findall(r'#include "(.*?)"', path.read_text())] for path in generated]


@pytest.fixture
def tree(tmp_path: Path) -> Tree:
    return Tree(tmp_path)


def findings(output: str) -> Counter[tuple[str, str]]:
    return Counter(re.findall(r"^(\S+?):\d+:\d+: error: .*\[([\w-]+)", output, re.MULTILINE))


def test_a_finding_names_the_source_it_is_in(tree: Tree) -> None:
    paths = [tree.source(f"{name}.cpp", FINDING.format(name=name)) for name in ("first", "second", "third")]
    result = tree.tidy()
    assert result.returncode == 1
    assert findings(result.stdout) == {(str(path), "modernize-use-nullptr"): 1 for path in paths}
    assert tree.seen_together() == [paths]


def test_sources_without_a_finding_are_clean_although_what_includes_them_includes_cpp_files(tree: Tree) -> None:
    for name in ("first", "second"):
        tree.source(f"{name}.cpp", f"int {name}() {{ return 1; }}\n")
    result = tree.tidy()
    assert (result.returncode, result.stdout) == (0, "")


def test_where_two_sources_have_one_name_each_is_still_seen(tree: Tree) -> None:
    paths = [
        tree.source(f"{name}.cpp", CLASH.format(name=name, count=count) + FINDING.format(name=name + "_size"))
        for count, name in enumerate(("first", "second", "third"))
    ]
    result = tree.tidy()
    assert result.returncode == 1
    assert findings(result.stdout) == {(str(path), "modernize-use-nullptr"): 1 for path in paths}
    assert "redefinition of 'kCount'" in result.stdout  # why it took longer


def test_an_unused_using_declaration_is_found_although_its_check_looks_at_the_main_file_alone(tree: Tree) -> None:
    declared = "namespace other { int number(); }\n"
    path = tree.source("first.cpp", declared + "using other::number;\nnamespace short_name = other;\n")
    tree.source("second.cpp", "int second() { return 2; }\n")
    result = tree.tidy()
    names = ("misc-unused-using-decls", "misc-unused-alias-decls")
    assert findings(result.stdout) == {(str(path), name): 1 for name in names}


def test_a_source_that_does_not_compile_fails_and_hides_nothing_of_the_others(tree: Tree) -> None:
    broken = tree.source("first.cpp", "int first() { return absent; }\n")
    other = tree.source("second.cpp", FINDING.format(name="second"))
    result = tree.tidy()
    assert result.returncode == 1
    found = findings(result.stdout)
    assert found[str(broken), "clang-diagnostic-error"] == 1
    assert found[str(other), "modernize-use-nullptr"] == 1


def test_sources_that_cmake_compiles_as_one_are_each_found_in_it(tree: Tree) -> None:
    paths = [tree.source(f"{name}.cpp", FINDING.format(name=name)) for name in ("first", "second")]
    (tree.root / "build" / "Unity").mkdir(parents=True)
    tree.sources = []  # the database has nothing but what includes them
    tree.source("build/Unity/unity_0_cxx.cxx", "".join(f'#include "{path}"\n\n' for path in paths))
    result = tree.tidy(sources=paths)
    assert findings(result.stdout) == {(str(path), "modernize-use-nullptr"): 1 for path in paths}


@pytest.mark.parametrize("number", [1, 2])
def test_a_source_is_seen_without_the_headers_that_gcc_has_precompiled(tree: Tree, number: int) -> None:
    header = tree.root / "cmake_pch.hxx"
    header.write_text("inline int from_the_header() { return 1; }\n")
    header.with_suffix(".hxx.gch").write_text("nothing that clang reads")
    for name in ("first", "second")[:number]:  # alone, and in a group
        tree.source(f"{name}.cpp", f"int {name}() {{ return 1; }}\n")
    options = ("-Winvalid-pch", "-fpch-preprocess", "-include", str(header))
    clean = tree.tidy(*options)
    assert (clean.returncode, clean.stdout) == (0, "")
    careless = tree.source("careless.cpp", "int careless() { return from_the_header(); }\n")
    result = tree.tidy(*options)
    assert findings(result.stdout)[str(careless), "clang-diagnostic-error"] == 1


def test_a_source_that_is_not_built_is_refused_by_name(tree: Tree) -> None:
    tree.source("first.cpp", "int first() { return 1; }\n")
    build = tree.root / "build"
    assert tree.tidy().returncode == 0
    stranger = tree.root / "src/stranger.cpp"
    stranger.write_text("")
    words = [sys.executable, TIDY, build, *tree.sources, stranger]
    result = subprocess.run(words, capture_output=True, text=True, timeout=300)
    assert result.returncode == 1
    assert str(stranger) in result.stderr


@pytest.fixture
def calls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """How often clang-tidy has looked at a source since the last question."""
    log, real = tmp_path / "calls", shutil.which("clang-tidy")
    wrapper = tmp_path / "bin/clang-tidy"
    wrapper.parent.mkdir()
    wrapper.write_text(f'#!/bin/sh\n[ "$1" = --version ] || echo "$*" >> {log}\nexec {real} "$@"\n')
    wrapper.chmod(0o755)
    monkeypatch.setenv("PATH", f"{wrapper.parent}:{os.environ['PATH']}")

    def since() -> int:
        count = len(log.read_text().splitlines()) if log.exists() else 0
        log.unlink(missing_ok=True)
        return count

    return since


def test_what_was_clean_and_has_not_changed_is_not_looked_at_again(tree: Tree, calls) -> None:
    for name in ("first", "second"):
        tree.source(f"{name}.cpp", f"int {name}() {{ return 1; }}\n")
    tree.source("other/third.cpp", "namespace a { int b(); }\nusing a::b;\nint third() { return b(); }\n")
    assert (tree.tidy().returncode, calls()) == (0, 2)  # two folders
    assert (tree.tidy().returncode, calls()) == (0, 0)


@pytest.mark.parametrize("changed", ["source", "header", "header in front", "options"])
def test_what_changed_in_any_way_is_looked_at_again(tree: Tree, calls, changed: str) -> None:
    source = tree.source("first.cpp", '#include "shown.hpp"\nint first() { return 1; }\n')
    header = tree.root / "behind/shown.hpp"
    header.parent.mkdir()
    header.write_text("// nothing\n")
    (tree.root / "front").mkdir()
    options = f"-I{tree.root}/front -I{tree.root}/behind"
    for _ in range(2):
        assert tree.tidy(options).returncode == 0
    assert calls() == 1
    finding = "inline " + FINDING.format(name="shown")
    if changed == "source":
        source.write_text(source.read_text() + finding)
    elif changed == "options":
        options += " -DUNUSED"
    else:
        (header if changed == "header" else tree.root / "front/shown.hpp").write_text(finding)
    tree.tidy(options)
    assert calls() == 1


def test_a_finding_is_found_in_every_run(tree: Tree, calls) -> None:
    for name in ("first", "second"):
        tree.source(f"{name}.cpp", FINDING.format(name=name))
    said = [tree.tidy().stdout for _ in range(2)]
    assert said[0] == said[1] != ""
    assert calls() == 2


def test_a_public_header_reached_through_the_build_tree_is_looked_at(tree: Tree) -> None:
    """As src/ reaches them: build/modules/NAME/pilotfish/NAME is a link to include/pilotfish/NAME."""
    public = tree.root / "include/pilotfish/core"
    public.mkdir(parents=True)
    (public / "shown.hpp").write_text("inline " + FINDING.format(name="shown"))
    link = tree.root / "build/modules/core/pilotfish/core"
    link.parent.mkdir(parents=True)
    link.symlink_to(public)
    tree.source("first.cpp", '#include "pilotfish/core/shown.hpp"\nint first() { return 1; }\n')
    result = tree.tidy(f"-I{tree.root}/build/modules/core")
    assert findings(result.stdout) == {(str(link / "shown.hpp"), "modernize-use-nullptr"): 1}

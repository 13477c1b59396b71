"""What scripts/mutate does, once universalmutator is there: which mutants of some files survive the tests?

A mutant counts if it compiles to something else than the original: what differs in comments, in the words of a text for
people, or not at all in the object file is no mutant, nor is what the compiler warns of. --tests come first; what
survives them meets --slow-tests. Either may name programs of tests/cpp (vision_cpp_tests), which run before pytest.
"""

from __future__ import annotations

import argparse
import difflib
import json
import os
import random
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORK = Path(os.environ.get("PILOTFISH_MUTATE", ROOT / "build" / "mutate"))  # another for a second run beside the first
TREE = WORK / "tree"
BUILD = TREE / "build" / "release"
PYTHON = ROOT / ".venv/bin/python"
BUILD_WITHIN_S, TEST_WITHIN_S = 600, 300
PROSE = re.compile(r'"(?:[^"\\\n]|\\.)* (?:[^"\\\n]|\\.)*"')  # a text with a blank in it


def run(command: list[object], timeout_s: float, **keywords: object) -> int:
    try:
        words = [str(word) for word in command]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.run(words, timeout=timeout_s, **{**quiet, **keywords}).returncode  # type: ignore[call-overload]
    except subprocess.TimeoutExpired:
        return -1


def build(targets: list[str], within_s: float = BUILD_WITHIN_S) -> bool:
    return run(["ninja", "-C", BUILD, *targets], within_s) == 0


def passes(tests: list[str]) -> bool:
    programs = [test for test in tests if test.endswith("_cpp_tests")]
    if any(run([BUILD / "tests/cpp" / program], TEST_WITHIN_S, cwd=TREE) != 0 for program in programs):
        return False
    tests = [test for test in tests if test not in programs]
    if not tests:
        return True
    environment = {**os.environ, "PYTHONPATH": str(BUILD / "python"), "PYTHONDONTWRITEBYTECODE": "1"}
    pytest = [PYTHON, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
    return run(pytest, TEST_WITHIN_S, cwd=TREE, env=environment) == 0


def copy_tree(targets: list[str]) -> None:
    """A copy with a build of its own: everything the first time, then the targets; only what changed since."""
    TREE.mkdir(parents=True, exist_ok=True)
    files = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, files):
        source, target = ROOT / name, TREE / name
        if source.is_file() and (not target.exists() or source.read_bytes() != target.read_bytes()):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    built = WORK / "built"
    if not built.exists():
        options = ["-DPILOTFISH_TESTS=ON", "-DPILOTFISH_WERROR=ON", f"-DPython_EXECUTABLE={PYTHON}"]
        options += ["-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON"]  # instead of what precompile_headers() makes
        run(["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", *options], BUILD_WITHIN_S)
    if not build(targets if built.exists() else [], 3 * BUILD_WITHIN_S):
        sys.exit(f"the copy in {TREE} does not build")
    built.touch()


def code_of(file: Path) -> str:
    """Without comments, and with all texts for people alike."""
    words = ["g++", "-fpreprocessed", "-dD", "-E", "-P", "-x", "c++", str(file)]
    text = subprocess.run(words, capture_output=True, text=True, check=False).stdout
    return " ".join(PROSE.sub('""', text).split())


def mutants_of(file: str) -> list[Path]:
    folder = WORK / "mutants" / file.replace("/", "_")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    run([ROOT / "build/mutate/venv/bin/mutate", ROOT / file, "--noCheck", "--mutantDir", folder], BUILD_WITHIN_S)
    return sorted(folder.iterdir())


def mutants_by_hand(file: str, replacements: list[list[str]]) -> list[Path]:
    folder = WORK / "mutants" / "by_hand"
    folder.mkdir(parents=True, exist_ok=True)
    original, mutants = (ROOT / file).read_text(), []
    for k, (old, new) in enumerate(replacements):
        if original.count(old) != 1:
            sys.exit(f"{file} has {old!r} {original.count(old)} times, not once")
        mutants.append(folder / f"{Path(file).stem}.{k}{Path(file).suffix}")
        mutants[-1].write_text(original.replace(old, new))
    return mutants


def object_of(file: str) -> str | None:
    """Of a header there is none: then the whole targets say whether it compiles."""
    for entry in json.loads((BUILD / "compile_commands.json").read_text()):
        if Path(entry["file"]) == TREE / file:
            words = shlex.split(entry["command"])
            return words[words.index("-o") + 1]
    return None


PREFIX = """#!/bin/sh
case " $* " in *"$MUTANT "*) exec "$@" -include "$HEADERS" ;; *) exec "$@" ;; esac
"""


def precompile_headers(file: str) -> None:
    """Most of the time to build a mutant goes into headers that are the same for all: ccache's prefix adds them."""
    for entry in json.loads((BUILD / "compile_commands.json").read_text()):
        if Path(entry["file"]) == TREE / file and shutil.which("ccache"):
            break
    else:
        return
    headers, prefix = WORK / "headers.hpp", WORK / "prefix"
    lines = [line for line in (ROOT / file).read_text().splitlines() if line.startswith("#include")]
    headers.write_text("\n".join(lines) + "\n")
    prefix.write_text(PREFIX)
    prefix.chmod(0o755)
    words = shlex.split(entry["command"])
    words = [word for word in words[: words.index("-o")] if not word.endswith("ccache")]
    words += ["-iquote", str((TREE / file).parent), "-x", "c++-header", str(headers), "-o", f"{headers}.gch"]
    if run(words, BUILD_WITHIN_S, cwd=entry["directory"]) == 0:
        os.environ |= {
            "CCACHE_DEPEND": "1",
            "CCACHE_PREFIX": str(prefix),
            "HEADERS": str(headers),
            "MUTANT": f"/{file}",
        }


class File:
    def __init__(self, file: str, options: argparse.Namespace):
        self.file, self.options = TREE / file, options
        self.original = (ROOT / file).read_text()
        self.object = object_of(file)
        precompile_headers(file)
        self.file.touch()
        build([self.object] if self.object else options.targets)
        self.object_bytes = (BUILD / self.object).read_bytes() if self.object else b""
        self.seen = {code_of(ROOT / file)}

    def verdict(self, mutant: Path) -> str:
        code = code_of(mutant)
        if code in self.seen:
            return "same code"
        self.seen.add(code)
        self.file.write_text(mutant.read_text())
        if self.object and not build([self.object]):
            return "does not compile"
        if self.object and (BUILD / self.object).read_bytes() == self.object_bytes:
            return "same object"
        if not build(self.options.targets):
            return "does not compile"
        if not passes(self.options.tests):
            return "killed"
        return "killed slowly" if self.options.slow_tests and not passes(self.options.slow_tests) else "survived"

    def restore(self) -> None:
        self.file.write_text(self.original)
        build(self.options.targets)


def difference(original: str, mutant: Path) -> str:
    lines = difflib.unified_diff(original.splitlines(), mutant.read_text().splitlines(), n=0, lineterm="")
    return "\n".join(f"    {line}" for line in list(lines)[2:])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", help="below src/, include/ or apps/")
    parser.add_argument("--tests", nargs="+", required=True, help="what should notice")
    parser.add_argument("--slow-tests", nargs="+", default=[], help="for those that survive --tests")
    parser.add_argument("--targets", nargs="+", default=[], help="what the tests need built; otherwise everything")
    parser.add_argument("--sample", type=int, default=0, help="so many of each file count, drawn by --seed; 0: all")
    parser.add_argument("--replace", nargs=2, action="append", metavar=("OLD", "NEW"), help="a mutant made by hand")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--within-s", type=float, default=1e9, help="begin no further mutant after this time")
    options = parser.parse_args()
    copy_tree(options.targets)
    if not passes(options.tests) or (options.slow_tests and not passes(options.slow_tests)):
        sys.exit("the tests must pass without a mutant")
    begin_s = time.monotonic()
    total: Counter[str] = Counter()
    for name in options.files:
        file, said = File(name, options), Counter[str]()
        mutants = mutants_by_hand(name, options.replace) if options.replace else mutants_of(name)
        random.Random(options.seed).shuffle(mutants)
        for mutant in mutants:
            if options.sample and said["killed"] + said["killed slowly"] + said["survived"] == options.sample:
                break
            if time.monotonic() - begin_s > options.within_s:
                break
            verdict = file.verdict(mutant)
            said[verdict] += 1
            if verdict in ("killed", "killed slowly", "survived"):
                print(f"{name} {mutant.name}: {verdict}", flush=True)
            if verdict == "survived":
                print(difference(file.original, mutant), flush=True)
        file.restore()
        total += said
        print(f"{name}: {dict(said)}", flush=True)
    killed = total["killed"] + total["killed slowly"]
    print(f"{killed} of {killed + total['survived']} killed in {time.monotonic() - begin_s:.0f} s")


if __name__ == "__main__":
    main()

"""What scripts/mutate does, once universalmutator is there: which mutants of some files survive the tests?"""

from __future__ import annotations

import argparse
import difflib
import os
import random
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
WORK = ROOT / "build" / "mutate"
TREE = WORK / "tree"
BUILD_WITHIN_S, TEST_WITHIN_S = 600, 300


def run(command: list[object], timeout_s: float, **keywords: object) -> int:
    try:
        words = [str(word) for word in command]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        return subprocess.run(words, timeout=timeout_s, **{**quiet, **keywords}).returncode  # type: ignore[call-overload]
    except subprocess.TimeoutExpired:
        return -1


def copy_tree() -> None:
    """A copy with a build of its own, which ccache makes quick; only what changed since the last time."""
    TREE.mkdir(parents=True, exist_ok=True)
    files = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\n")
    for name in filter(None, files):
        source, target = ROOT / name, TREE / name
        if source.is_file() and (not target.exists() or source.read_bytes() != target.read_bytes()):
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(source, target)
    python = f"-DPython_EXECUTABLE={ROOT / '.venv/bin/python'}"
    configure = ["cmake", "-S", TREE, "-B", TREE / "build/release", "-G", "Ninja", "-DPILOTFISH_TESTS=ON", python]
    if run(configure, BUILD_WITHIN_S) or run(["cmake", "--build", TREE / "build/release"], 3 * BUILD_WITHIN_S):
        sys.exit(f"the copy in {TREE} does not build")


def mutants_of(file: str) -> list[Path]:
    folder = WORK / "mutants" / file.replace("/", "_")
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    run([WORK / "venv/bin/mutate", ROOT / file, "--noCheck", "--mutantDir", folder], BUILD_WITHIN_S)
    return sorted(folder.iterdir())


def verdict(file: str, mutant: Path, tests: list[str]) -> str:
    target = TREE / file
    target.write_text(mutant.read_text())
    if run(["cmake", "--build", TREE / "build/release"], BUILD_WITHIN_S):
        return "does not compile"
    environment = {**os.environ, "PYTHONPATH": str(TREE / "build/release/python")}
    pytest = [ROOT / ".venv/bin/python", "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
    return "survived" if run(pytest, TEST_WITHIN_S, cwd=TREE, env=environment) == 0 else "killed"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="+", help="below src/ or apps/")
    parser.add_argument("--tests", nargs="+", required=True, help="what should notice")
    parser.add_argument("--sample", type=int, default=0, help="so many of each file, drawn by --seed; 0: all")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    copy_tree()
    if run([ROOT / ".venv/bin/python", "-m", "pytest", "-q", "--co", *options.tests], TEST_WITHIN_S, cwd=ROOT):
        sys.exit("no such tests")
    total = {"killed": 0, "survived": 0, "does not compile": 0}
    for file in options.files:
        original = (ROOT / file).read_text()
        mutants = mutants_of(file)
        if options.sample and options.sample < len(mutants):
            mutants = random.Random(options.seed).sample(mutants, options.sample)
        for k, mutant in enumerate(mutants, 1):
            said = verdict(file, mutant, options.tests)
            total[said] += 1
            print(f"{file} {k}/{len(mutants)}: {said}", flush=True)
            if said == "survived":
                lines = difflib.unified_diff(original.splitlines(), mutant.read_text().splitlines(), n=0, lineterm="")
                print("\n".join(f"    {line}" for line in list(lines)[2:]), flush=True)
        (TREE / file).write_text(original)
    made = total["killed"] + total["survived"]
    print(f"{total['killed']} of {made} killed; {total['does not compile']} do not compile")


if __name__ == "__main__":
    main()

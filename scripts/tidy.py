"""clang-tidy on sources that it sees together: one generated file a folder includes the folder's sources.

Most of a source's time goes to the headers, so those of a folder take little longer than one of them. A finding names
the file it is in, for what is generated has no line of its own. Sources that do not compile together (a name in an
anonymous namespace, say, that two of them have) are seen in parts, down to the single file; what does not compile alone
is a finding. What was clean and has not changed since is not looked at again (tidy_memory.py).

    tidy.py BUILD_FOLDER SOURCE...     exit status 1 if there is a finding
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
from collections import Counter, defaultdict
from concurrent.futures import Future, ThreadPoolExecutor, wait
from pathlib import Path

from tidy_memory import CleanAnswers

# What these look at is the main file alone, so a source in which they might find something is seen by them once more.
OF_THE_MAIN_FILE = "-*,misc-unused-using-decls,misc-unused-alias-decls"
NAMES_SOMETHING_ANEW = re.compile(r"\busing\s+(?:typename\s+)?[\w:]*::\w+\s*;|\bnamespace\s+\w+\s*=")
# bugprone-exception-escape follows calls whose bodies it sees; a main calls nearly everything, so it stays alone.
IS_A_PROGRAM = re.compile(r"^int main\(", re.MULTILINE)
# A local name may be one that another source has in its anonymous namespace; shadows within one the build complains of.
OF_A_GROUP = ("-Wno-shadow",)
DOES_NOT_COMPILE = "[clang-diagnostic-error"
ROOT = Path(__file__).resolve().parents[1]
Result = subprocess.CompletedProcess[str]


# Headers that GCC has precompiled: clang does not read them, and a source must name what it needs.
OF_GCC_ALONE = ("-Winvalid-pch", "-fpch-preprocess")
PRECOMPILED = "cmake_pch.hxx"


def compiler_options(entry: dict[str, str]) -> tuple[str, ...]:
    """What an entry of the compile database says to the compiler, but for what is of one source or of GCC alone."""
    words = iter(shlex.split(entry["command"]))
    options: list[str] = []
    for word in words:
        if word in ("-o", "-c", "-MT", "-MF"):
            next(words)
        elif word.endswith(PRECOMPILED) and options[-1:] == ["-include"]:
            options.pop()
        elif word not in OF_GCC_ALONE:
            options.append(word)
    return (entry["directory"], *options)


def sources_of(file: Path) -> list[Path]:
    """CMake's unity builds compile several sources as one, whose lines include them; any other file is one source."""
    if file.parent.name != "Unity" or not file.name.startswith("unity_"):
        return [file.resolve()]
    return [Path(source).resolve() for source in re.findall(r'^#include "(.*)"', file.read_text(), re.MULTILINE)]


class Groups:
    """The sources, together where folder and options are the same, and the database that clang-tidy reads."""

    def __init__(self, build: Path, sources: list[Path]) -> None:
        self.folder = build / "tidy"
        self.options: dict[Path, tuple[str, ...]] = {}
        for entry in json.loads((build / "compile_commands.json").read_text()):
            for source in sources_of(Path(entry["file"])):
                self.options.setdefault(source, compiler_options(entry))
        unknown = [str(source) for source in sources if source not in self.options]
        if unknown:
            raise SystemExit(f"not in {build}/compile_commands.json, so not built there: {' '.join(unknown)}")
        together = defaultdict(list)
        for source in sources:
            program = source if IS_A_PROGRAM.search(source.read_text()) else None
            together[source.parent, self.options[source], program].append(source)
        self.all = sorted(together.values(), key=len, reverse=True)

    def write(self, group: list[Path], name: str) -> Path:
        """The source that stands for a group, in a folder of its own with its compile database."""
        folder = self.folder / name
        folder.mkdir(parents=True, exist_ok=True)
        generated = folder / "together.cpp"
        includes = [
            f'#include "{source}"  // NOLINT(bugprone-suspicious-include): what this file is for\n' for source in group
        ]
        generated.write_text("".join(includes))
        self.describe(folder, generated, self.options[group[0]], OF_A_GROUP)
        return generated

    def alone(self, source: Path) -> Path:
        """The folder of the compile database of one source."""
        folder = self.folder / "alone" / source.relative_to(source.anchor)
        folder.mkdir(parents=True, exist_ok=True)
        self.describe(folder, source, self.options[source])
        return folder

    @staticmethod
    def describe(folder: Path, source: Path, options: tuple[str, ...], more: tuple[str, ...] = ()) -> None:
        directory, *words = options
        arguments = [*words, *more, "-c", str(source)]
        database = [{"directory": directory, "file": str(source), "arguments": arguments}]
        (folder / "compile_commands.json").write_text(json.dumps(database))


def clang_tidy(database: Path, source: Path, *options: str) -> Result:
    command = ["clang-tidy", "-p", database, "--quiet", f"--config-file={ROOT / '.clang-tidy'}", *options, source]
    return subprocess.run(command, capture_output=True, text=True)


def parts(group: list[Path], errors: list[str]) -> tuple[list[Path], list[Path]]:
    """A group that does not compile, without the sources that the errors are in, and these; or its halves."""
    places = {Path(line.split(":", 1)[0]) for line in errors}
    guilty = [source for source in group if source in places]
    if not guilty or len(guilty) == len(group):
        guilty = group[len(group) // 2 :]
    return [source for source in group if source not in guilty], guilty


class Run:
    def __init__(self, build: Path, sources: list[Path], jobs: int) -> None:
        self.groups = Groups(build, sources)
        scripts = Path(__file__).resolve()
        rules = [ROOT / ".clang-tidy", scripts, scripts.with_name("tidy_memory.py")]
        self.clean = CleanAnswers(self.groups.folder / "clean", rules)
        self.pool = ThreadPoolExecutor(jobs)
        self.seen: Counter[Path] = Counter()
        self.failed = False
        self.running: set[Future[None]] = set()

    def start(self, what, *arguments) -> None:
        self.running.add(self.pool.submit(what, *arguments))

    def see(self, group: list[Path], name: str) -> None:
        if len(group) > 1:
            generated = self.groups.write(group, name)
            result = self.look_at(generated.parent, generated, (*self.groups.options[group[0]], *OF_A_GROUP))
            errors = [line for line in result.stdout.splitlines() if DOES_NOT_COMPILE in line]
            if errors:
                print(f"not one with the rest of its folder, so linted slower: {errors[0]}", flush=True)
                for number, part in enumerate(parts(group, errors)):
                    self.start(self.see, part, f"{name}-{number}")
                return
            self.report(result)
            for source in group:
                if NAMES_SOMETHING_ANEW.search(source.read_text()):
                    self.start(self.see_main_file, source)
        else:
            self.report(self.look_at(self.groups.alone(group[0]), group[0], self.groups.options[group[0]]))
        self.seen.update(group)

    def see_main_file(self, source: Path) -> None:
        options = f"--checks={OF_THE_MAIN_FILE}"
        self.report(self.look_at(self.groups.alone(source), source, self.groups.options[source], options))

    def look_at(self, database: Path, source: Path, compiler: tuple[str, ...], *options: str) -> Result:
        """What clang-tidy says, or that it said nothing of the very same files."""
        key = self.clean.key(compiler, source, *options)
        if self.clean.knows(key):
            return subprocess.CompletedProcess([], 0, "", "")
        result = clang_tidy(database, source, *options)
        if result.returncode == 0 and not result.stdout:
            self.clean.remember(key)
        return result

    def report(self, result: subprocess.CompletedProcess[str]) -> None:
        if result.returncode != 0:
            self.failed = True
            print(result.stdout or result.stderr, end="", flush=True)

    def finish(self) -> None:
        while self.running:
            done, _ = wait(self.running, return_when="FIRST_COMPLETED")
            self.running -= done
            for each in done:
                each.result()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=Path)
    parser.add_argument("sources", type=Path, nargs="+")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    given = parser.parse_args()
    sources = sorted({source.resolve() for source in given.sources})
    run = Run(given.build.resolve(), sources, given.jobs)
    for number, group in enumerate(run.groups.all):
        run.start(run.see, group, f"{number}-{group[0].parent.name}")
    run.finish()
    if run.seen != Counter(sources):  # a mistake in this file: no source may be left out
        raise SystemExit(f"seen not once each: {run.seen.items() ^ Counter(sources).items()}")
    return 1 if run.failed else 0


if __name__ == "__main__":
    sys.exit(main())

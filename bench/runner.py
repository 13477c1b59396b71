"""What scripts/bench does: lists the benchmarks, makes the environments that they need, and runs them.

A benchmark is a folder of bench/ with a __main__.py, whose docstring begins with what is measured and says behind
"Takes:" how long that takes. Its Python packages are those of .venv, unless bench/requirements/NAME.txt pins others:
then it has an environment of its own. Only the standard library is needed here, so that one can ask before anything is
installed.
"""

from __future__ import annotations

import argparse
import ast
import os
import shlex
import shutil
import signal
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PYTHON = ROOT / ".venv" / "bin" / "python"
BENCH, ENVIRONMENTS = ROOT / "bench", ROOT / "build" / "bench-env"

DESCRIPTION = """\
Runs benchmarks, each beside its baselines on the same input in the same run. Without names: lists them.
"""
EPILOG = """\
examples
  scripts/bench                                 what there is, and how long it takes
  scripts/bench fuzzy                           installs, builds and runs one
  scripts/bench fuzzy vision -- --quick         two, with an argument for both
  scripts/bench vision -- --help                the options of one of them
  scripts/bench --no-build soak -- --hours 0.2  without looking whether anything must be installed or built
  scripts/bench all                             everything: hours, on a computer that does nothing else

Tables go to the terminal, figures and charts to out/ (what and where: bench/README.md). Ends with 1 if a
benchmark did not end with 0.
"""


@dataclass(frozen=True)
class Benchmark:
    name: str
    what: str
    takes: str

    @property
    def lock(self) -> Path | None:
        """What it needs instead of what is in .venv."""
        file = BENCH / "requirements" / f"{self.name}.txt"
        return file if file.exists() else None


def benchmarks() -> dict[str, Benchmark]:
    found = {}
    for file in sorted(BENCH.glob("*/__main__.py")):
        what, *lines = (ast.get_docstring(ast.parse(file.read_text())) or "").splitlines() or [""]
        takes = [line.removeprefix("Takes: ") for line in lines if line.startswith("Takes: ")]
        name = file.parent.name
        found[name] = Benchmark(name, what.rstrip("."), "".join(takes[:1]).rstrip("."))
    return found


def listing(known: dict[str, Benchmark]) -> str:
    name, takes = (max(len(getattr(each, column)) for each in known.values()) for column in ("name", "takes"))
    return "\n".join(f"{each.name:<{name}}  {each.takes:<{takes}}  {each.what}" for each in known.values())


def say(words: str) -> None:
    print(f"\033[1m[bench]\033[0m {words}", flush=True)


def up_to_date(lock: Path, folder: Path) -> bool:
    """As scripts/setup finds it of .venv: the last thing installed there was this lock file."""
    stamp = folder / "requirements.installed"
    return (folder / "bin" / "python").exists() and stamp.exists() and stamp.read_bytes() == lock.read_bytes()


def make_environment(lock: Path, folder: Path, base_python: Path) -> None:
    python, shown = folder / "bin" / "python", os.path.relpath(folder, ROOT)
    if up_to_date(lock, folder):
        say(f"the Python packages in {shown} are up to date")
        return
    if not python.exists():
        say(f"making {shown}")
        subprocess.run([base_python, "-m", "venv", "--clear", folder], check=True)
    say(f"installing {os.path.relpath(lock, ROOT)} into {shown}")
    subprocess.run([python, "-m", "pip", "install", "-qq", "--disable-pip-version-check", "-r", lock], check=True)
    shutil.copyfile(lock, folder / "requirements.installed")


def run(benchmark: Benchmark, arguments: list[str]) -> int:
    """Its exit code. Whoever ends this ends the benchmark: Ctrl-C reaches both, and SIGTERM is passed on."""
    python, environment = PYTHON, dict(os.environ)
    if benchmark.lock is not None:
        folder = ENVIRONMENTS / benchmark.name
        try:
            make_environment(benchmark.lock, folder, python)
        except subprocess.CalledProcessError as error:
            say(f"{benchmark.name}: no environment, because this failed: {shlex.join(map(str, error.cmd))}")
            return error.returncode
        python = folder / "bin" / "python"
        environment["PYTHONPATH"] = str(ROOT / "build" / "release" / "python")  # Pilotfish itself, as it was built
    say(f"{benchmark.name}: {benchmark.what} (as a whole: {benchmark.takes})")
    child = subprocess.Popen([python, BENCH / benchmark.name, *arguments], cwd=ROOT, env=environment)
    ended: list[int] = []

    def pass_on(number: int, _: object) -> None:
        ended.append(number)
        if number == signal.SIGTERM:
            child.terminate()

    before = {number: signal.signal(number, pass_on) for number in (signal.SIGINT, signal.SIGTERM)}
    code = child.wait()
    for number, handler in before.items():
        signal.signal(number, handler)
    if ended:
        sys.exit(128 + ended[0])
    return code


def main(words: list[str]) -> int:
    own, arguments = (words[: words.index("--")], words[words.index("--") + 1 :]) if "--" in words else (words, [])
    parser = argparse.ArgumentParser(
        prog="scripts/bench",
        usage="scripts/bench [-h] [--no-build] [NAME ... | all] [-- ARGUMENT ...]",
        description=DESCRIPTION,
        epilog=EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="what to run, in this order; or all")
    parser.add_argument("--no-build", action="store_true", help="take what scripts/setup and scripts/build left")
    options, known = parser.parse_args(own), benchmarks()
    if wrong := [name for name in options.names if name not in known and name != "all"]:
        parser.error(f"{', '.join(wrong)}: there is {', '.join(known)}, all")
    if not options.names:
        print(listing(known), "", "Run them: scripts/bench NAME; how: scripts/bench --help", sep="\n")
        return 0
    chosen = list(known) if "all" in options.names else options.names
    if options.no_build and not PYTHON.exists():
        parser.error("nothing was built yet: not with --no-build")
    only_asked = PYTHON.exists() and not {"-h", "--help"}.isdisjoint(arguments)  # answered by what is there
    if not (options.no_build or only_asked):
        for script in ("setup", "build"):
            if code := subprocess.run([ROOT / "scripts" / script], check=False).returncode:
                return code
    codes = {name: run(known[name], arguments) for name in chosen}
    for name, code in codes.items():
        say(f"{name}: " + ("done" if code == 0 else f"ended with {code}"))
    return int(any(codes.values()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

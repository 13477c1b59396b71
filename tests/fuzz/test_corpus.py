"""Every input that a fuzzer has found worth keeping goes through its target under AddressSanitizer and UBSan.

tests/fuzz/<target>.cpp is built with the compiler at hand and a main that replays files, in a build folder of its own:
some minutes of one core the first time, nothing after that. To make up new inputs (clang, libclang-rt-14-dev):

    cmake --preset fuzz && cmake --build --preset fuzz
    mkdir found && build/fuzz/tests/fuzz/fuzz_transport found tests/fuzz/corpus/transport -max_len=1024
    build/fuzz/tests/fuzz/fuzz_transport -merge=1 tests/fuzz/corpus/transport found   # keep what reaches new code
"""

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
BUILD, CORPUS = ROOT / "build" / "asan-fuzz", ROOT / "tests" / "fuzz" / "corpus"
SANITIZERS = [
    "-DCMAKE_BUILD_TYPE=Debug",
    "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1",
    "-DPILOTFISH_SANITIZE=ON",
    "-DPILOTFISH_PYTHON=OFF",
    "-DPILOTFISH_WERROR=ON",
    "-DPILOTFISH_TESTS=ON",
]
LONGEST_MS = 1000  # a hang, not a measurement: normally below 5 ms


def targets():
    """As tests/fuzz/CMakeLists.txt has them."""
    return re.findall(r"^pilotfish_fuzz\((\w+) ", (ROOT / "tests/fuzz/CMakeLists.txt").read_text(), re.MULTILINE)


def run(*command):
    done = subprocess.run(list(map(str, command)), check=False, capture_output=True, text=True)
    assert done.returncode == 0, f"{command} failed:\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}"
    return done.stdout


def test_no_input_of_the_corpus_breaks_its_target_or_keeps_it_long():
    if not (BUILD / "build.ninja").exists():
        run("cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", *SANITIZERS)
    run("cmake", "--build", BUILD, "--target", *(f"fuzz_{target}" for target in targets()))
    for target in targets():
        files = list((CORPUS / target).iterdir())
        assert len(files) >= 5, f"no corpus for {target}"
        output = run(BUILD / "tests" / "fuzz" / f"fuzz_{target}", CORPUS / target)
        answers = dict(line.split() for line in output.splitlines())
        assert int(answers["inputs"]) == len(files)
        assert float(answers["longest_ms"]) < LONGEST_MS, target


def test_the_corpus_is_small_enough_to_live_in_the_repository():
    sizes = [file.stat().st_size for file in CORPUS.rglob("*") if file.is_file()]
    assert sum(sizes) < 300_000

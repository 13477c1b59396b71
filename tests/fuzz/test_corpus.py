"""Every input that a fuzzer has found worth keeping goes through its target: it must end, and soon.

tests/fuzz/<target>.cpp is built with the compiler at hand and a main that replays files; with AddressSanitizer and
UBSan by ``scripts/test --sanitize tests/fuzz``, which takes minutes to build.

To make up new inputs (clang, libclang-rt-14-dev):

    cmake --preset fuzz && cmake --build --preset fuzz
    mkdir found && build/fuzz/tests/fuzz/fuzz_transport found tests/fuzz/corpus/transport -max_len=1024
    build/fuzz/tests/fuzz/fuzz_transport -merge=1 tests/fuzz/corpus/transport found   # keep what reaches new code
"""

import re

from build_tree import ROOT, built, run

CORPUS = ROOT / "tests" / "fuzz" / "corpus"
LONGEST_MS = 1000  # a hang, not a measurement: normally below 5 ms


def targets():
    """As tests/fuzz/CMakeLists.txt has them."""
    return re.findall(r"^pilotfish_fuzz\((\w+) ", (ROOT / "tests/fuzz/CMakeLists.txt").read_text(), re.MULTILINE)


def test_no_input_of_the_corpus_breaks_its_target_or_keeps_it_long():
    for target in targets():
        files = list((CORPUS / target).iterdir())
        assert len(files) >= 5, f"no corpus for {target}"
        output = run(built(f"fuzz_{target}", "fuzz"), CORPUS / target)
        answers = dict(line.split() for line in output.splitlines())
        assert int(answers["inputs"]) == len(files)
        assert float(answers["longest_ms"]) < LONGEST_MS, target


def test_the_corpus_is_small_enough_to_live_in_the_repository():
    sizes = [file.stat().st_size for file in CORPUS.rglob("*") if file.is_file()]
    assert sum(sizes) < 300_000

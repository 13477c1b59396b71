"""What the fuzzers found worth keeping, run through once more; scripts and clang are needed only to find more.

The programs are built with the release (PILOTFISH_TESTS); under sanitizers, by the preset fuzz, they look for more.
"""

import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.not_sanitized("runs programs of build/release; test_corpus.py has them with sanitizers")
ROOT = Path(__file__).parents[2]
CORPUS = ROOT / "tests" / "fuzz" / "corpus"


@pytest.mark.parametrize("target", ["config", "calibration", "fll", "jpeg"])
def test_every_input_of_the_corpus_is_loaded_or_refused(target):
    count = sum(1 for _ in (CORPUS / target).iterdir())
    assert count
    program = ROOT / "build" / "release" / "tests" / "fuzz" / f"fuzz_{target}"
    done = subprocess.run([program, CORPUS / target], capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr[-3000:]
    assert f"inputs {count}\n" in done.stdout

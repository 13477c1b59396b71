"""Inference never asks the heap for anything: a program that counts says so, and asserts noexcept as it compiles."""

import subprocess
from pathlib import Path

import pytest
from compiled import ROOT, compile_program


@pytest.fixture(scope="module")
def counter(tmp_path_factory):
    module = sorted(
        (ROOT / "src" / "fuzzy").glob("*.cpp")
    )  # the module knows nothing else, so it compiles as it stands
    source = Path(__file__).with_name("allocation_counter.cpp")
    return compile_program(tmp_path_factory.mktemp("allocations"), [source, *module], "-O1", f"-I{ROOT / 'include'}")


@pytest.mark.not_sanitized("counts what the sanitizer's own allocator does")
@pytest.mark.parametrize("sets", ["ordered", "Gaussians"])
def test_200_000_evaluations_allocate_nothing(counter, sets):
    answer = subprocess.run([counter, sets], check=True, capture_output=True, text=True, timeout=120).stdout.split()
    evaluations, allocations, _, while_loading = answer
    assert int(evaluations) == 200_000
    assert int(while_loading) > 100  # it does count: loading allocates
    assert int(allocations) == 0

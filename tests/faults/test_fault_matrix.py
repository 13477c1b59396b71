"""The fault matrix cannot drift: every row has a test, every mark a row, and the document is what both say."""

from pathlib import Path

from faults.matrix import as_markdown, load_faults, tests_by_fault

ROWS = {name for chapter in load_faults().values() for name in chapter}


def test_every_fault_has_a_test_that_carries_its_name():
    assert sorted(ROWS - set(tests_by_fault())) == []


def test_every_mark_names_a_row():
    assert sorted(set(tests_by_fault()) - ROWS) == []


def test_the_document_is_made_of_the_table_and_the_marks():
    document = Path(__file__).parents[2] / "docs" / "faults.md"
    assert document.read_text() == as_markdown(), "python tests/faults/matrix.py > docs/faults.md"

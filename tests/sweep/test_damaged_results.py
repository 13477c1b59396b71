"""A part of the results that was altered, copied or comes from elsewhere is found out, and never counted."""

import re
import shutil

import numpy as np
import pytest
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.errors import CampaignError
from pilotfish.sweep.parts import DamagedPartError, part_name, read_part
from pilotfish.sweep.run import run_campaign
from pilotfish.sweep.store import DAMAGED, parts, read_identity, read_rows, schema_of, write_part
from sweep.campaigns import loaded, rows


def run(*words):
    result = CliRunner().invoke(app, ["sweep", *map(str, words)])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, re.sub(r"\x1b\[[0-9;]*m|\s+", " ", result.output)


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A campaign of 8 runs in two parts of 4, all done: (its file, its results)."""
    folder = tmp_path_factory.mktemp("finished")
    campaign, calls = loaded(folder), iter([False] * 4 + [True])
    run_campaign(campaign, folder / "once", stopping=lambda: next(calls, True))
    run_campaign(campaign, folder / "once")
    whole, schema = rows(folder / "once"), schema_of(campaign)
    out = folder / "out"
    run_campaign(campaign, out, stopping=lambda: True)  # makes the folder
    for half in (whole[:4], whole[4:]):
        write_part(out, half, schema)
    return folder / "campaign.yaml", out


@pytest.fixture
def copied(finished, tmp_path):
    """(the campaign's file, a copy of its results to do harm to)."""
    file, out = finished
    return file, shutil.copytree(out, tmp_path / "out")


def without_checksum(part):
    """The same part as an earlier version named it."""
    return part.rename(part.with_name(part.name[: len("part-000001")] + ".parquet"))


def altered(part, at, count=1):
    content = bytearray(part.read_bytes())
    for k in range(at, at + count):
        content[k] ^= 0x10
    part.write_bytes(content)


def test_no_flipped_bit_is_taken_for_a_result(finished, tmp_path):
    """Every 29th byte, one bit each: without a checksum a fifth of them gave other values."""
    _, out = finished
    part, identity = parts(out)[1], read_identity(out)
    content = part.read_bytes()
    harmed = tmp_path / part.name
    places = range(0, len(content), 29)
    assert len(places) > 100
    for k, at in enumerate(places):
        harmed.write_bytes(content)
        altered(harmed, at)
        with pytest.raises(DamagedPartError, match="does not match the checksum in its name"):
            read_part(harmed, identity)
        harmed.write_bytes(content[:at])
        if k % 10 == 0:
            with pytest.raises(DamagedPartError, match="checksum"):
                read_part(harmed, identity)


@pytest.mark.parametrize(
    "named", [lambda part: part, without_checksum], ids=["with a checksum", "of an earlier version"]
)
def test_runs_of_a_damaged_part_are_simulated_again_and_that_is_said(finished, copied, named):
    whole = rows(finished[1])
    file, out = copied
    part = named(parts(out)[1])
    altered(part, part.stat().st_size - 300, 60)
    code, said = run("report", out)
    assert code == 74 and f"{part}: damaged".replace(" ", "") in said.replace(" ", "")
    code, said = run(file, "--out", out, "--workers", 0)
    assert code == 0 and "8 of 8 runs done, 4 now (4 ok)" in said
    assert f"{part.name}: damaged" in said and "are simulated again" in said
    assert (out / DAMAGED / part.name).is_file()
    assert rows(out) == whole
    assert "8 of 8 runs are done" in run(file, "--out", out, "--workers", 0)[1]


def test_results_of_an_earlier_version_are_read_and_gone_on_with(finished, copied):
    whole = rows(finished[1])
    file, out = copied
    first, second = map(without_checksum, parts(out))
    assert rows(out) == whole
    second.unlink()
    assert "8 of 8 runs done, 4 now" in run(file, "--out", out, "--workers", 0)[1]
    assert parts(out)[0] == first and parts(out)[1].name.startswith("part-000002-")
    assert rows(out) == whole


def test_a_part_that_was_copied_counts_once_with_a_warning(finished, copied):
    whole = rows(finished[1])
    file, out = copied
    part = parts(out)[1]
    copy = part.with_name(part.name.replace("000002", "000009"))
    shutil.copy(part, copy)
    warnings = []
    assert read_rows(out, warnings.append).to_pylist() == whole
    assert warnings == [f"{copy}: 4 of its 4 runs are also in {part}, with the same rows: counted once"]
    code, said = run("report", out)
    assert code == 0 and "8 runs: 8 ok" in said and "counted once" in said
    code, said = run(file, "--out", out, "--workers", 0)
    assert code == 0 and "8 of 8 runs are done" in said and "counted once" in said


@pytest.mark.parametrize("value", [0.25, float("nan"), -0.0], ids=str)
def test_two_parts_that_say_different_things_of_a_run_are_both_named(finished, copied, value):
    file, out = copied
    row = rows(out)[6]
    one = row | {"min_distance_m": 0.0 if value == 0.0 else row["min_distance_m"]}
    campaign = loaded(file.parent)
    parts(out)[1].unlink()
    first = write_part(out, [one], schema_of(campaign))
    second = write_part(out, [row | {"min_distance_m": value}], schema_of(campaign))
    with pytest.raises(CampaignError, match=rf"run 6 is in two parts .*: {first} and {second}\. Delete"):
        read_rows(out)
    for words in (["report", out], [file, "--out", out, "--workers", 0]):
        code, said = run(*words)
        assert code == 74 and "run 6 is in two parts" in said


def test_a_part_of_another_campaign_is_not_counted(finished, copied, tmp_path):
    file, out = copied
    other = loaded(tmp_path, seed=7)
    run_campaign(other, tmp_path / "other")
    foreign = shutil.copy(parts(tmp_path / "other")[-1], out / "runs" / parts(tmp_path / "other")[-1].name)
    assert len(parts(out)) == 3
    with pytest.raises(CampaignError, match=rf"{foreign}: damaged, or of another campaign"):
        read_rows(out)
    code, said = run(file, "--out", out, "--workers", 0)
    assert code == 0 and "8 of 8 runs are done" in said and "of another campaign" in said


def test_a_row_that_no_run_of_the_campaign_has_is_damage(copied):
    file, out = copied
    write_part(out, [rows(out)[0] | {"run": 8}], schema_of(loaded(file.parent)))
    code, said = run(file, "--out", out, "--workers", 0)
    assert code == 0 and "runs beyond 7" in said and "8 of 8 runs are done" in said


def test_a_file_with_a_name_of_somebody_else_is_named(copied):
    _, out = copied
    part = parts(out)[1]
    copy = part.with_name(f"{part.stem} (copy).parquet")
    shutil.copy(part, copy)
    code, said = run("report", out)
    assert code == 74 and "not a name that `pilotfish sweep` gives" in said


def test_a_part_without_a_checksum_is_checked_as_far_as_it_can_be(finished, tmp_path):
    """Flipped bits of it are damage or give a table; never an exception of somebody else, and never two rows of a
    run."""
    _, out = finished
    identity = read_identity(out)
    content = parts(out)[1].read_bytes()
    harmed = tmp_path / "part-000001.parquet"
    found = 0
    for at in range(0, len(content), 41):
        harmed.write_bytes(content)
        altered(harmed, at)
        try:
            runs = read_part(harmed, identity)["run"].to_numpy()
            assert len(np.unique(runs)) == len(runs)
        except DamagedPartError:
            found += 1
    assert found > 20


def test_what_a_killed_process_has_left_is_removed(copied):
    file, out = copied
    left = out / "runs" / f".{part_name(7, read_identity(out), b'')}.1234.part"
    left.write_bytes(b"half")
    assert run(file, "--out", out, "--workers", 0)[0] == 0
    assert not left.exists()

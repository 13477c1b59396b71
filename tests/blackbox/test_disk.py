"""The disk may be full, slow, gone or shared, and the program killed: the robot does not notice, and what was
written is read."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from recorded_runs import RecordedRun, drive_at_random, wait_until

import pilotfish
from pilotfish.black_box import events_in, replay
from pilotfish.black_box.log import files_in

HERE = Path(__file__).parent
ENVIRONMENT = {
    **os.environ,
    "PYTHONPATH": os.pathsep.join([str(Path(pilotfish.__file__).absolute().parents[1]), str(HERE), str(HERE.parent)]),
}


def program(name, *arguments, prefix=()):
    return [*prefix, sys.executable, str(HERE / name), *map(str, arguments)]


def outcome(name, *arguments, prefix=()):
    command = program(name, *arguments, prefix=prefix)
    ended = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=240, check=False)
    assert ended.returncode == 0, ended.stderr[-2000:]
    return json.loads(ended.stdout)


def test_the_ring_never_grows_beyond_its_limit_and_keeps_the_newest(tmp_path):
    run = RecordedRun(tmp_path, segment_mb=1, total_mb=4)
    for k in range(120):  # 12 MB
        run.message("ROBOT1_IMAGE", k.to_bytes(4, "big") + bytes(100_000))
        drive_at_random(run, 2, seed=k)
        run.flush()
        assert sum(file.stat().st_size for file in tmp_path.glob("*.lcmlog")) <= 4_000_000
    run.close()
    images = [event.data for event in events_in(tmp_path) if event.channel == "ROBOT1_IMAGE"]
    numbers = [int.from_bytes(image[:4], "big") for image in images]
    # Two to three full segments of ten images are left, in their order, up to the last.
    assert numbers == list(range(numbers[0], 120)) and 20 <= len(numbers) < 40
    assert replay(events_in(tmp_path)).first_difference is None


def test_the_files_of_earlier_runs_count_and_go_first(tmp_path):
    for name in ("robot1-5-0.lcmlog", "robot1-5-10.lcmlog", "robot1-7-0.lcmlog"):
        (tmp_path / name).write_bytes(bytes(1_500_000))
    (tmp_path / "robot2-5-0.lcmlog").write_bytes(bytes(1_500_000))
    (tmp_path / "notes.txt").write_text("not ours")
    run = RecordedRun(tmp_path, segment_mb=1, total_mb=4)
    wait_until(lambda: run.box.written >= 1)
    run.close()
    left = {file.name for file in tmp_path.iterdir()}
    assert "robot1-5-0.lcmlog" not in left
    assert {"robot1-5-10.lcmlog", "robot1-7-0.lcmlog", "robot2-5-0.lcmlog", "notes.txt"} <= left


def test_files_sort_by_age_although_the_clock_was_set_back(tmp_path):
    (tmp_path / "robot1-99999999999999999-3.lcmlog").touch()  # of the year 5138
    run = RecordedRun(tmp_path)
    run.close()
    assert [file.name for file in files_in(tmp_path)][-1] == "robot1-100000000000000000-0.lcmlog"


def test_what_the_disk_has_taken_survives_a_kill(tmp_path):
    command = program("killed_writer.py", tmp_path)
    with subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.PIPE, text=True) as recorder:
        written = next(int(line) for line in recorder.stdout if int(line) > 500)
        recorder.send_signal(signal.SIGKILL)
    report = replay(events_in(tmp_path))
    assert report.starts + report.calls + report.sent >= written
    assert (report.differences, report.gaps) == (0, 0) and report.frames > 100
    assert all(damage.at_end for damage in report.damage)


def can_mount():
    probe = ["unshare", "--map-root-user", "--mount", "true"]
    return subprocess.run(probe, capture_output=True, check=False).returncode == 0


@pytest.mark.skipif(not can_mount(), reason="no user namespaces here")
@pytest.mark.fault("disk_full")
def test_a_full_disk_costs_the_oldest_files_and_nobody_else(tmp_path):
    came = outcome("full_disk_writer.py", tmp_path, prefix=("unshare", "--map-root-user", "--mount"))
    # 12 MB were handed over and 3 MB fit: what is left is the newest, and every bit of it agrees.
    assert came["differences"] == 0 and came["damaged"] == 0 and came["dropped"] == 0
    assert 500_000 < came["bytes"] <= 3 << 20
    assert came["replayed"] > 0 and came["seconds_old"] < 30


def test_a_limit_on_the_size_of_files_costs_one_event_a_file_and_does_not_end_the_program(tmp_path):
    came = outcome("full_disk_writer.py", tmp_path, 300_000)
    assert came["lost"] > 0 and "large" in came["trouble"].lower()
    assert came["differences"] == 0 and came["damaged"] == 0
    assert came["gaps"] >= 1 and came["starts"] >= 2, "after a gap, a new start"
    assert came["replayed"] > 0


def test_a_disk_that_never_answers_blocks_nobody(tmp_path):
    came = outcome("blocked_disk_writer.py", tmp_path)
    # 100 MB were handed over in all; 32 MB wait, the rest was dropped, and the program ended nevertheless.
    assert came["written"] == 0 and came["frames"] == 1000
    assert came["dropped"] > 1000


def test_a_folder_that_cannot_be_written_is_said_at_the_start(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ValueError, match=r"black_box\.directory"):
        RecordedRun(tmp_path / "file")
    with pytest.raises(ValueError, match=r"black_box\.directory.*empty"):
        RecordedRun("")


def test_two_programs_do_not_record_one_robot_into_one_folder(tmp_path):
    run = RecordedRun(tmp_path)
    with pytest.raises(ValueError, match="another program records robot1"):
        RecordedRun(tmp_path)
    other = RecordedRun(tmp_path, robot="robot2")
    other.close()
    run.close()
    RecordedRun(tmp_path).close()

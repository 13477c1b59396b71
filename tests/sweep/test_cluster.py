"""A real Dask cluster, of whose two workers one is killed in the middle; and Ctrl-C, as a terminal sends it."""

import os
import re
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import distributed
import pytest

from pilotfish.errors import CampaignError
from pilotfish.harness.child import Child
from pilotfish.sweep import workers
from pilotfish.sweep.play import play_all
from pilotfish.sweep.run import run_campaign
from pilotfish.sweep.store import parts, read_rows
from pilotfish.sweep.workers import Where
from sweep.campaigns import loaded, written

WITHIN_S = 120.0  # of a busy machine
MANY = {"runs": 12}  # 48 runs of some 50 ms


def dask(program: str, *options: str) -> list[str]:
    """As `dask scheduler` and `dask worker` start them."""
    return [sys.executable, "-m", f"distributed.cli.dask_{program}", "--no-dashboard", *options]


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def test_a_worker_killed_half_way_loses_no_run_and_changes_no_bit(tmp_path):
    campaign = loaded(tmp_path, **MANY)
    run_campaign(campaign, tmp_path / "alone")
    address = f"tcp://127.0.0.1:{free_port()}"
    start = ["--host", "127.0.0.1", "--port", address.rpartition(":")[2]]
    work = dask("worker", address, "--no-nanny", "--nthreads", "1")
    with (
        Child(dask("scheduler", *start), tmp_path, "scheduler"),
        Child([*work, "--name", "first"], tmp_path, "first") as first,
        Child([*work, "--name", "second"], tmp_path, "second") as second,
        distributed.Client(address, timeout=WITHIN_S, set_as_default=False) as watcher,
    ):
        watcher.wait_for_workers(2, timeout=WITHIN_S)
        handed = []

        def kill_second(done: int, total: int) -> None:
            """While it has runs in its hands."""
            if handed:
                return
            names = {each["name"]: key for key, each in watcher.scheduler_info(n_workers=-1)["workers"].items()}
            handed.extend(watcher.processing()[names["second"]])
            assert done < total / 2
            os.kill(second.process.pid, signal.SIGKILL)
            second.process.wait(WITHIN_S)

        summary = run_campaign(campaign, tmp_path / "cluster", Where(scheduler=address), on_progress=kill_second)
        assert first.process.poll() is None
    assert handed, "the killed worker had nothing to do: nothing is tested"
    assert summary.outcomes == {"ok": 48}
    assert read_rows(tmp_path / "cluster").equals(read_rows(tmp_path / "alone"))


def test_without_a_scheduler_it_says_how_to_start_one(tmp_path):
    where = Where(scheduler=f"tcp://127.0.0.1:{free_port()}", wait_s=0.3)
    with pytest.raises(CampaignError, match=r"no scheduler at .*start one with `dask scheduler`"):
        run_campaign(loaded(tmp_path), tmp_path / "out", where)


def test_a_worker_of_another_version_refuses_its_work(tmp_path, monkeypatch):
    campaign = loaded(tmp_path)
    packed = workers.pack(campaign.job)
    specs = [campaign.run(0), campaign.run(5)]
    assert workers.play_packed(packed, specs).rows == play_all(campaign.job, specs).rows
    monkeypatch.setattr(workers, "__version__", "0.0.1")
    with pytest.raises(workers.OtherVersionsError, match=r"0\.0\.1"):
        workers.play_packed(packed, specs)


def test_ctrl_c_ends_it_with_130_and_keeps_what_is_done(tmp_path):
    """As a terminal does it: the signal goes to the command and to all of its processes."""
    campaign, file = loaded(tmp_path, runs=250), written(tmp_path, runs=250)  # 1000 runs, a minute at least
    out = tmp_path / "out"
    words = [sys.executable, "-m", "pilotfish", "sweep", str(file), "--out", str(out), "--workers", "1"]
    with (tmp_path / "log").open("w") as log:
        command = subprocess.Popen(words, stdout=log, stderr=log, start_new_session=True)
    try:
        deadline = time.monotonic() + WITHIN_S
        while not ((out / "runs").is_dir() and parts(out)):
            assert command.poll() is None and time.monotonic() < deadline
            time.sleep(0.02)
        os.killpg(command.pid, signal.SIGINT)
        assert command.wait(WITHIN_S) == 130
    finally:
        if command.poll() is None:
            os.killpg(command.pid, signal.SIGKILL)
    said = (tmp_path / "log").read_text()
    assert "Traceback" not in said
    done = int(re.search(r"(\d+) of 1000 runs done", said)[1])
    kept = read_rows(out)
    assert 0 < done < 1000 and len(kept) == done
    some = kept.to_pylist()[:: max(1, done // 3)]
    assert some == play_all(campaign.job, [campaign.run(row["run"]) for row in some]).rows
    assert not list(Path(out / "runs").glob(".*"))

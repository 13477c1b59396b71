"""The benchmark of the browser's page sends what a robot sends, and counts the processor time of one process."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import lcm

sys.path.append(str(Path(__file__).parents[2] / "bench" / "view"))  # where measure finds its neighbour

from bench.common.processes import process
from bench.common.wire import decode_image
from bench.view import measure
from bench.view.sender import send
from pilotfish.harness.ports import private_lcm_url
from pilotfish.view import messages

ROOT = Path(__file__).parents[2]


def test_what_is_sent_can_be_read_and_a_pictures_stamp_is_its_sending():
    url, received = private_lcm_url(), {}
    bus = lcm.LCM(url)
    bus.subscribe("ROBOT1_.*", lambda channel, data: received.setdefault(channel, (data, time.time())))
    with process(send, url, 20.0, "PREVIEW", 20.0):
        for _ in range(200):
            bus.handle_timeout(100)
            if len(received) == 4:
                break
    assert set(received) == {f"ROBOT1_{kind}" for kind in ("STATUS", "OBSERVATION", "COMMAND", "PREVIEW")}
    for kind in ("STATUS", "OBSERVATION", "COMMAND"):
        assert messages.decode(kind, received[f"ROBOT1_{kind}"][0])
    data, at_s = received["ROBOT1_PREVIEW"]
    picture = decode_image(data)
    assert picture.image.shape == (480, 640)
    assert 0 <= at_s - picture.utime * 1e-6 < 10


def test_a_process_that_works_is_counted_and_one_that_sleeps_is_not(monkeypatch):
    monkeypatch.setattr(measure, "WARM_UP_S", 0.0)
    code = {"busy": "while True: pass", "idle": "import time; time.sleep(60)"}
    loads = {}
    for name, program in code.items():
        with subprocess.Popen([sys.executable, "-c", f"print(flush=True)\n{program}"], stdout=subprocess.PIPE) as child:
            assert child.stdout.readline()  # its interpreter has started
            loads[name] = measure.load(SimpleNamespace(process=child), 0.5)
            child.kill()
    assert loads["busy"] > 10 * max(loads["idle"], 0.005)


def test_the_benchmark_describes_itself():
    command = [sys.executable, ROOT / "bench" / "view", "--help"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0
    assert "--quick" in done.stdout

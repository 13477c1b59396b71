"""The wheels of the example obey the first coordinator on the bus, and stand still when it falls silent."""

import select
import subprocess
import sys
import time

import pytest
from installed import examples

from build_tree import ROOT
from pilotfish import bus, core
from pilotfish.harness.ports import private_lcm_url

WITHIN_S = 20.0


def wheels(language, url):
    command = (
        [str(examples() / "wheel_driver")]
        if language == "c++"
        else [sys.executable, str(ROOT / "examples/python/wheel_driver.py")]
    )
    return subprocess.Popen([*command, "r1", url], stdout=subprocess.PIPE, text=True)


@pytest.mark.parametrize("language", ["c++", "python"])
def test_the_wheels_obey_one_coordinator_and_stand_still_after_its_last_word(language):
    url = private_lcm_url()
    process = wheels(language, url)
    try:
        link, deadline, counter = bus.Bus(url), time.monotonic() + WITHIN_S, 0
        # It says nothing when it is ready: commands are sent until one is heard. The second sender's never count.
        while not select.select([process.stdout], [], [], 0.02)[0]:
            assert time.monotonic() < deadline
            counter += 1
            for session, speed in ((7, 0.25), (8, 0.5)):
                report = bus.CommandReport(
                    utime=counter,
                    session=session,
                    counter=counter,
                    command=core.Twist(linear_mps=speed),
                    status=core.Status.tracking,
                )
                link.publish_command("r1", report)
        # From here on nobody speaks: what was on its way is driven, then comes one line of zeros.
        lines = []
        while not lines or "+0.000" not in lines[-1].split(",")[0]:
            lines.append(process.stdout.readline())
        assert {line.split(",")[0] for line in lines[:-1]} == {"v = +0.250 m/s"}
    finally:
        process.terminate()
        process.wait(WITHIN_S)

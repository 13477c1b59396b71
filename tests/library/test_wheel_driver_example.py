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

pytestmark = [
    pytest.mark.builds,
    pytest.mark.not_sanitized("a stranger's program is linked without the sanitizer's runtime"),
]
WITHIN_S = 20.0


def wheels(language, url):
    program = (
        [str(examples() / "wheel_driver")]
        if language == "c++"
        else [sys.executable, str(ROOT / "examples/python/wheel_driver.py")]
    )
    return subprocess.Popen([*program, "r1", url], stdout=subprocess.PIPE, bufsize=0)


def has_said(process, within_s):
    return bool(select.select([process.stdout], [], [], within_s)[0])


def command(session, counter, linear_mps, valid_ms=100):
    return bus.CommandReport(
        utime=counter,
        session=session,
        counter=counter,
        valid_until_us=core.monotonic_now_us() + valid_ms * 1000,
        command=core.Twist(linear_mps=linear_mps),
        status=core.Status.tracking,
    )


@pytest.mark.parametrize("language", ["c++", "python"])
def test_the_wheels_obey_one_coordinator_and_stand_still_after_its_last_word(language):
    url = private_lcm_url()
    with wheels(language, url) as process:
        try:
            link, counter, deadline = bus.Bus(url), 0, time.monotonic() + WITHIN_S
            # It says nothing when it is ready: commands are sent until one has been received.
            while not has_said(process, 0.02):
                assert time.monotonic() < deadline
                counter += 1
                for session, speed in ((7, 0.25), (8, 0.5)):
                    link.publish_command("r1", command(session, counter, speed))
            # From here on no commands are sent: what was on its way is driven, then comes one line of zeros.
            lines = []
            while not lines or not lines[-1].startswith(b"v = +0.000"):
                assert has_said(process, WITHIN_S)
                lines.append(process.stdout.readline())
            assert len({line.split(b",")[0] for line in lines[:-1]}) == 1  # one of the two senders, never both
        finally:
            process.terminate()

"""Foreign datagrams against the real programs: they survive them and go on answering."""

import random
import time
from contextlib import nullcontext

import pytest
from datagrams import TWO_DATAGRAMS, Sender, fragment, short, two_datagrams

from pilotfish import bus
from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.executables import COORDINATOR, SIM, find_executable
from scripted_coordinator import ScriptedCoordinator

WITHIN_S = 30.0


def hostile_datagrams():
    rng = random.Random(5)
    pair = {"message_bytes": 2**20, "offset": 0, "number": 0, "fragments": 2}
    return [
        *TWO_DATAGRAMS * 20,
        *two_datagrams(b"ROBOT1_IMAGE") * 20,
        *two_datagrams(b"ROBOT1_COMMAND") * 20,
        *(rng.randbytes(rng.randrange(300)) for _ in range(100)),
        *(magic + rng.randbytes(rng.randrange(300)) for magic in (b"LC02", b"LC03") for _ in range(100)),
        *(short(b"ROBOT1_IMAGE", rng.randbytes(200)) for _ in range(100)),
        *(short(b"SOMEBODY_ELSE", bytes(1000)) for _ in range(1000)),
        # Begun and never finished, each of another message
        *(fragment(b"ROBOT1_IMAGE\0" + bytes(900), sequence=k, **pair) for k in range(300)),
    ]


class Listener:
    """Counts what a program sends, with a Bus of ours: it gets the hostile datagrams as well."""

    def __init__(self, url):
        self.bus = bus.Bus(url)
        self.received = 0
        self.bus.on_command("robot1", self.count)
        self.bus.on_encoded_image("ROBOT1_IMAGE", self.count)

    def count(self, _):
        self.received += 1

    def wait_for(self, more, child):
        enough, give_up = self.received + more, time.monotonic() + WITHIN_S
        while self.received < enough:
            assert child.process.poll() is None, child.error(f"ended with {child.process.returncode}")
            assert time.monotonic() < give_up, child.error(f"{self.received} of {enough} messages")
            self.bus.handle(20)


@pytest.mark.fault("fragment_overflow")
@pytest.mark.parametrize(
    "command",
    [
        (COORDINATOR, "--config", shipped.path("config/line.yaml")),
        (SIM, "--scenario", shipped.path("scenarios/line.yaml"), "--duration-s", "600"),
    ],
    ids=["coordinator", "sim"],
)
def test_a_program_survives_foreign_datagrams_and_goes_on_sending(tmp_path, url, command):
    program, *options = command
    listener, sender = Listener(url), Sender(url)
    # The simulator sends pictures only to a coordinator that obeys; this one looks at none of them.
    obeying = ScriptedCoordinator(url, answers_pictures=True) if program == SIM else nullcontext()
    with obeying, Child([find_executable(program), *options, "--lcm-url", url], tmp_path, program) as child:
        listener.wait_for(5, child)
        sender.send(*hostile_datagrams())
        listener.wait_for(20, child)
        assert child.process.poll() is None
    sender.close()
    assert listener.bus.rejected["fragment_out_of_bounds"] > 0  # they came

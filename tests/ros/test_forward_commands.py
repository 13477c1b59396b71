"""The loop between the bus and a publisher of /cmd_vel, on a bus within this process."""

from __future__ import annotations

import threading
import time

import pytest

from pilotfish import bus, core
from pilotfish.errors import ConfigError, SilentRobotError
from pilotfish.operating import new_key
from pilotfish.ros import forward_commands, open_link

ROBOT = "robot1"
GIVE_UP_S = 20.0


class Drive:
    """A publisher that sends one good command and one state of the base when it is first called, and ends the loop
    when ``enough`` holds for what was published."""

    def __init__(self, enough, *, valid_ms=60, link=None, sender=None):
        self.link = link or bus.Bus("memq://")
        self.sender = sender or self.link
        self.stop, self.enough, self.valid_ms = threading.Event(), enough, valid_ms
        self.published, self.at_us, self.reasons = [], [], []

    def __call__(self, command):
        self.at_us.append(core.monotonic_now_us())
        self.published.append(command.twist.linear_mps)
        if len(self.published) == 1:
            self.send()
        if self.enough(self.published):
            self.stop.set()

    def send(self):
        now_us, twist = core.monotonic_now_us(), core.Twist(linear_mps=0.3)
        self.until_us = now_us + self.valid_ms * 1000
        command = bus.CommandReport(utime=0, session=5, counter=1, valid_until_us=self.until_us, command=twist)
        driving = bus.BaseReport.State.driving
        base = bus.BaseReport(
            utime=time.time_ns() // 1000,
            session=6,
            counter=1,
            monotonic_us=now_us,
            accepted_session=5,
            command=twist,
            state=driving,
        )
        self.sender.publish_command(ROBOT, command)
        self.sender.publish_base(ROBOT, base)

    def run(self, **options):
        give_up = threading.Timer(GIVE_UP_S, self.stop.set)
        give_up.start()
        forward_commands(self.link, ROBOT, self, stop=self.stop, on_reason=self.reasons.append, **options)
        give_up.cancel()
        return self


def test_a_command_that_expires_is_followed_by_a_zero_at_that_moment_and_not_in_the_next_period():
    # One message in 10 s: what is published meanwhile is published because it changed.
    drive = Drive(lambda published: published[-2:] == [0.3, 0.0]).run(rate_hz=0.1)
    assert drive.published[:3] == [0.0, 0.3, 0.0]
    assert drive.at_us[2] >= drive.until_us
    assert drive.reasons[0].startswith("no message of pilotfish-base yet")
    assert drive.reasons[1] == ""
    assert "too old" in drive.reasons[2]


def test_without_any_change_messages_go_on():
    drive = Drive(lambda published: len(published) >= 30).run(rate_hz=200.0)
    assert set(drive.published[10:]) <= {0.0, 0.3}
    # 29 periods of 5 ms; the change to 0.3 and back again may have come between them
    assert drive.at_us[29] - drive.at_us[0] >= 27 * 5000


def test_the_loop_ends_with_zeros_while_it_drives():
    drive = Drive(lambda published: published[-1] == 0.3, valid_ms=90).run()
    assert drive.published[-4:] == [0.3, 0.0, 0.0, 0.0]


def test_an_exception_ends_the_loop_with_zeros_too():
    drive = Drive(lambda published: False, valid_ms=90)

    def fail(reason):
        if not reason:
            raise OSError("the log is full")

    with pytest.raises(OSError, match="the log is full"):
        forward_commands(drive.link, ROBOT, drive, stop=drive.stop, on_reason=fail)
    assert drive.published[-4:] == [0.3, 0.0, 0.0, 0.0]


@pytest.mark.parametrize("knows_the_key", [True, False])
def test_with_a_key_only_messages_made_with_it_move_anything(tmp_path, url, knows_the_key):
    key = tmp_path / "robot1.key"
    new_key(key)
    sender = bus.Bus(url)
    if knows_the_key:
        sender.set_key(bus.load_key(str(key)))
    link = open_link(ROBOT, url, key)
    drive = Drive(lambda published: 0.3 in published or len(published) >= 20, valid_ms=90, link=link, sender=sender)
    assert (0.3 in drive.run().published) == knows_the_key
    assert ("base_mac_wrong" in link.rejected) != knows_the_key


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        (("no name",), ConfigError, "no name"),
        (("robot1", "nonsense"), SilentRobotError, "nonsense"),
        (("robot1", "memq://", "/there/is/none"), ConfigError, "/there/is/none"),
    ],
)
def test_a_bus_that_cannot_be_opened_is_named(arguments, error, says):
    with pytest.raises(error, match=says):
        open_link(*arguments)

"""What holds between two frames: a command that dies by itself, and what is said about it meanwhile."""

import pytest

from pilotfish import coordinator, core
from pilotfish.core import Reason, Status

COMMAND, STILL = core.Twist(linear_mps=0.3), core.Twist()
FROM_US, UNTIL_US = 1_000, 101_000
# Of the picture, its time, or the company: not that the leader cannot be seen.
INVALID = {
    Reason.frame_size_not_calibrated,
    Reason.frame_too_small,
    Reason.frame_too_large,
    Reason.frame_truncated,
    Reason.frame_stride_invalid,
    Reason.frame_time_not_advancing,
    Reason.frame_time_implausible,
    Reason.frame_stale,
    Reason.camera_frozen,
    Reason.ranges_not_fresh,
    Reason.another_coordinator,
    Reason.internal_error,
    Reason.ranges_not_fresh,
}
REASONS = list(Reason.__members__.values())


def held(*, holding=True, run=True, ever_measured=True, turning=False):
    return coordinator.HeldCommand(
        utime=7,
        command=COMMAND,
        from_us=FROM_US,
        until_us=UNTIL_US,
        holding=holding,
        run=run,
        ever_measured=ever_measured,
        turning=turning,
    )


def test_a_turn_in_search_of_the_leader_says_so_while_it_lives():
    search = held(turning=True)
    assert search.at(UNTIL_US, Reason.no_frame) == (Status.lost, Reason.turning_to_search, COMMAND)
    assert search.at(UNTIL_US + 1, Reason.no_frame) == (Status.lost, Reason.no_frame, STILL)


@pytest.mark.parametrize("reason", REASONS, ids=lambda reason: reason.name)
def test_each_reason_says_what_is_wrong_while_the_command_lives_and_after_it(reason):
    invalid = reason in INVALID
    alive = Status.invalid_input if invalid else Status.coasting
    dead = Status.invalid_input if invalid else Status.lost
    assert held().at(UNTIL_US, reason) == (alive, reason, COMMAND)
    assert held().at(UNTIL_US + 1, reason) == (dead, reason, STILL)
    assert held(run=False).at(UNTIL_US, reason) == (Status.stopped, Reason.stop_requested, STILL)


@pytest.mark.parametrize("now_us", [FROM_US - 1, UNTIL_US + 1, -(2**63), 2**63 - 1])
def test_outside_its_life_it_moves_nothing(now_us):
    assert held().at(now_us, Reason.no_frame) == (Status.lost, Reason.no_frame, STILL)
    assert held(ever_measured=False).at(now_us, Reason.no_frame)[0] == Status.searching


@pytest.mark.parametrize("now_us", [FROM_US, UNTIL_US])
def test_its_first_and_its_last_instant_belong_to_its_life_unless_the_wheels_rest(now_us):
    assert held().at(now_us, Reason.no_frame)[2] == COMMAND
    assert held(holding=False).at(now_us, Reason.no_frame) == (Status.lost, Reason.no_frame, STILL)

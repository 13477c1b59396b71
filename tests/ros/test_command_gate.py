"""What may leave for wheels that are not pilotfish-base's own. No ROS, no bus, no clock."""

from __future__ import annotations

import pytest

from pilotfish import bus, core
from pilotfish.ros.command_gate import HOLD_US, TAKEOVER_US, WALL_TOLERANCE_US, CommandGate

T0 = 10_000_000
WALL = 1_700_000_000_000_000
COORDINATOR, BASE = 11, 77
TWIST = core.Twist(linear_mps=0.3, angular_radps=-0.2)


def command(counter=1, *, session=COORDINATOR, valid_until_us=T0 + 100_000, twist=TWIST, simulated=False):
    return bus.CommandReport(
        utime=0,
        session=session,
        counter=counter,
        base_session=BASE,
        valid_until_us=valid_until_us,
        command=twist,
        simulated=simulated,
    )


def base(counter=1, *, at_us=T0, session=BASE, accepted=COORDINATOR, twist=TWIST, stopped=False, wall_us=WALL):
    return bus.BaseReport(
        utime=wall_us,
        session=session,
        counter=counter,
        monotonic_us=at_us,
        accepted_session=accepted,
        command=twist,
        stopped=stopped,
        state=bus.BaseReport.State.stopped if stopped else bus.BaseReport.State.driving,
    )


@pytest.fixture
def gate():
    """It has received a good command and the base's state at T0."""
    gate = CommandGate()
    gate.on_command(command(), T0)
    gate.on_base(base(), T0, WALL)
    return gate


def drives(gate, at_us=T0):
    return gate.at(at_us).twist != core.Twist()


def test_the_commands_of_the_base_pass_and_say_until_when(gate):
    passed = gate.at(T0)
    assert (passed.twist, passed.until_us, passed.utime, passed.reason) == (TWIST, T0 + HOLD_US, WALL, "")


def test_nothing_passes_before_a_base_and_a_coordinator_were_heard():
    gate = CommandGate()
    assert "no message of pilotfish-base yet" in gate.at(T0).reason
    gate.on_base(base(), T0, WALL)
    assert not drives(gate)
    gate.on_command(command(), T0)
    assert drives(gate)


def test_a_silent_base_is_obeyed_for_95_ms_and_not_a_microsecond_longer(gate):
    gate.on_command(command(2, valid_until_us=T0 + 200_000), T0 + 90_000)
    assert drives(gate, T0 + HOLD_US - 1)
    assert not drives(gate, T0 + HOLD_US)


def test_a_silent_coordinator_is_obeyed_for_95_ms_whatever_the_base_says(gate):
    gate.on_base(base(2, at_us=T0 + 90_000), T0 + 90_000, WALL)
    assert drives(gate, T0 + HOLD_US - 1)
    assert not drives(gate, T0 + HOLD_US)


def test_a_measurement_that_expires_stops_the_wheels_at_that_moment(gate):
    gate.on_command(command(2, valid_until_us=T0 + 40_000), T0)
    assert gate.at(T0).until_us == T0 + 40_000
    assert drives(gate, T0 + 39_999)
    assert not drives(gate, T0 + 40_000)


def test_a_zero_of_the_coordinator_need_not_wait_for_the_base(gate):
    gate.on_command(command(2, twist=core.Twist()), T0 + 1)
    assert not drives(gate, T0 + 1)


def latched():
    """A stop that is latched, with whatever state."""
    report = base(2)
    report.stopped = True
    return report


@pytest.mark.parametrize("stop", [base(2, stopped=True), latched(), base(2, twist=core.Twist()), base(2, accepted=0)])
def test_whatever_stops_the_base_stops_these_wheels(gate, stop):
    gate.on_base(stop, T0, WALL)
    assert not drives(gate)


def test_commands_of_a_session_that_the_base_does_not_accept_extend_nothing(gate):
    gate.on_command(command(9, session=12, valid_until_us=T0 + 1_000_000), T0 + 90_000)
    gate.on_base(base(2, at_us=T0 + 90_000), T0 + 90_000, WALL)
    assert not drives(gate, T0 + HOLD_US)


def test_commands_that_come_twice_extend_nothing(gate):
    gate.on_command(command(1, valid_until_us=T0 + 1_000_000), T0 + 90_000)
    gate.on_base(base(2, at_us=T0 + 90_000), T0 + 90_000, WALL)
    assert not drives(gate, T0 + HOLD_US)


def test_a_simulators_commands_move_no_real_wheels_although_the_dry_run_executes_them(gate):
    gate.on_command(command(2, simulated=True), T0)
    assert not drives(gate)
    assert "simulator" in gate.at(T0).reason


def test_states_of_the_base_that_come_twice_or_of_a_second_one_extend_nothing(gate):
    gate.on_command(command(2, valid_until_us=T0 + 500_000), T0 + 90_000)
    gate.on_base(base(1, at_us=T0 + 90_000), T0 + 90_000, WALL)
    gate.on_base(base(5, session=78, at_us=T0 + 90_000), T0 + 90_000, WALL)
    assert not drives(gate, T0 + HOLD_US)


def test_another_base_is_obeyed_once_the_first_has_ended(gate):
    later_us = T0 + TAKEOVER_US + 1
    gate.on_command(command(2, valid_until_us=later_us + 100_000), later_us)
    gate.on_base(base(1, session=78, at_us=later_us), later_us, WALL)
    assert drives(gate, later_us)


@pytest.mark.parametrize("age_us", [-6_000, HOLD_US + 1, -3_600_000_000, 3_600_000_000])
def test_states_that_do_not_fit_this_computers_clock_are_refused(age_us):
    gate = CommandGate()
    gate.on_command(command(), T0)
    gate.on_base(base(at_us=T0 - age_us), T0, WALL)
    assert not drives(gate)
    assert "clock" in gate.at(T0).reason


@pytest.mark.parametrize("off_us", [-WALL_TOLERANCE_US - 1, WALL_TOLERANCE_US + 1])
def test_a_recording_whose_monotonic_clock_fits_by_chance_is_refused_by_its_date(off_us):
    gate = CommandGate()
    gate.on_command(command(), T0)
    gate.on_base(base(wall_us=WALL + off_us), T0, WALL)
    assert not drives(gate)


def test_a_state_that_waited_in_a_queue_is_as_old_as_it_says(gate):
    gate.on_command(command(2, valid_until_us=T0 + 500_000), T0 + 80_000)
    gate.on_base(base(2, at_us=T0 + 10_000), T0 + 80_000, WALL)
    assert drives(gate, T0 + 10_000 + HOLD_US - 1)
    assert not drives(gate, T0 + 10_000 + HOLD_US)


def test_a_flood_of_sessions_displaces_the_silent_and_not_the_one_that_sends(gate):
    for k in range(1000):
        gate.on_command(command(1, session=100 + k), T0)
        assert drives(gate)
        gate.on_command(command(2 + k), T0)
    assert len(gate._senders) <= 8


def test_session_0_is_no_session(gate):
    gate.on_command(command(1, session=0), T0)
    gate.on_base(base(2, accepted=0), T0, WALL)
    assert not drives(gate)

"""Whom the wheels obey. Times are microseconds on a clock that the test holds."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from twists import Twist

from pilotfish import base
from pilotfish.base import BaseState, CommandVerdict, LatchVerdict

OWN = 77
MS = 1000
LIFE_US = 95 * MS
START_US = 10_000_000
DRIVE = Twist(0.3, 0.5)


class Wheels:
    """A Base asked every 10 ms, with its clock."""

    def __init__(self, *, simulated_allowed=False, config=None):
        self.base = base.Base(config or base.BaseConfig(), session=OWN, simulated_allowed=simulated_allowed)
        self.now_us = START_US
        self.base.step(now_us=self.now_us)

    def pass_ms(self, ms):
        """The output at the end."""
        end_us = self.now_us + ms * MS
        while self.now_us < end_us:
            self.now_us = min(self.now_us + 10 * MS, end_us)
            out = self.base.step(now_us=self.now_us)
        return out

    def command(
        self, session, counter, twist=DRIVE, *, base_session=OWN, simulated=False, arrived_us=None, valid_ms=100
    ):
        return self.base.command(
            session=session,
            counter=counter,
            base_session=base_session,
            valid_until_us=self.now_us + valid_ms * MS,
            twist=twist,
            simulated=simulated,
            now_us=self.now_us,
            arrived_us=arrived_us,
        )

    def setpoint(self, session=0, counter=0, *, run):
        return self.base.setpoint(session=session, counter=counter, run=run, now_us=self.now_us)

    def moves(self):
        return self.base.step(now_us=self.now_us).command != Twist()


@pytest.fixture
def wheels():
    return Wheels()


def driven(wheels, session=1, commands=10):
    """Commands every 20 ms; the wheels move at the end."""
    for k in range(1, commands + 1):
        assert wheels.command(session, k) == CommandVerdict.accepted
        wheels.pass_ms(20)
    assert wheels.moves()
    return commands


def test_a_sender_that_has_heard_us_is_obeyed(wheels):
    driven(wheels)
    assert wheels.pass_ms(0 + 10).accepted_session == 1
    assert wheels.base.rejected == {}


def test_zeros_come_by_themselves_exactly_a_life_after_the_last_good_command(wheels):
    driven(wheels)
    wheels.command(1, 100)
    arrived_us = wheels.now_us
    assert wheels.base.deadline_us == arrived_us + LIFE_US
    for us in (arrived_us + 40 * MS, arrived_us + 80 * MS, arrived_us + LIFE_US - 1):
        assert wheels.base.step(now_us=us).command != Twist()
    out = wheels.base.step(now_us=arrived_us + LIFE_US)
    assert (out.command, out.state) == (Twist(), BaseState.waiting)
    assert wheels.base.deadline_us is None


def test_the_life_counts_from_the_arrival_and_not_from_when_it_was_read(wheels):
    driven(wheels)
    wheels.command(1, 100, arrived_us=wheels.now_us - 60 * MS)
    assert wheels.base.deadline_us == wheels.now_us + LIFE_US - 60 * MS
    assert wheels.command(1, 101, arrived_us=wheels.now_us - LIFE_US) == CommandVerdict.stale


def test_an_arrival_in_the_future_does_not_lengthen_the_life(wheels):
    driven(wheels)
    wheels.command(1, 100, arrived_us=wheels.now_us + 10_000_000)
    assert wheels.base.deadline_us == wheels.now_us + LIFE_US


@pytest.mark.parametrize("valid_ms", [0, -1, -172, -100_000_000])
def test_a_command_that_was_held_up_until_its_measurement_was_too_old_is_refused_and_counted(wheels, valid_ms):
    driven(wheels)
    wheels.pass_ms(100)  # as long as its sender stood still
    assert wheels.command(1, 100, valid_ms=valid_ms) == CommandVerdict.expired
    assert not wheels.moves()
    assert wheels.command(1, 101, Twist(), valid_ms=valid_ms) == CommandVerdict.accepted  # zeros are always valid
    assert wheels.base.rejected == {"command_expired": 1}


def test_a_command_ends_with_its_measurement(wheels):
    driven(wheels)
    wheels.command(1, 100, valid_ms=40)
    assert wheels.base.deadline_us == wheels.now_us + 40 * MS
    wheels.pass_ms(39)
    assert wheels.moves()
    wheels.pass_ms(1)
    assert not wheels.moves()


@pytest.mark.parametrize("named", [0, OWN + 1, -OWN])
def test_a_recording_of_an_earlier_run_and_a_sender_that_has_not_heard_us_are_refused(wheels, named):
    assert wheels.command(1, 1, base_session=named) == CommandVerdict.base_session_wrong
    assert not wheels.moves()
    assert wheels.base.rejected == {"base_session_wrong": 1}


@pytest.mark.parametrize("counter", [10, 9, 1, 0, -5, -(2**63)])
def test_a_counter_that_does_not_rise_is_a_replay(wheels, counter):
    last = driven(wheels)
    assert last == 10
    deadline_us = wheels.base.deadline_us
    assert wheels.command(1, counter) == CommandVerdict.replayed
    assert wheels.base.deadline_us == deadline_us, "a replay must not lengthen the life"


def test_a_second_sender_never_drives_and_does_not_disturb_the_first(wheels):
    for k in range(1, 200):
        assert wheels.command(1, k) == CommandVerdict.accepted
        assert wheels.command(2, k, Twist(-0.5, 0.0)) == CommandVerdict.foreign
        out = wheels.pass_ms(20)
        assert out.command.linear_mps > 0 and out.accepted_session == 1
    assert wheels.base.rejected == {"command_foreign": 199}


@pytest.mark.parametrize(("first", "second"), [(1, 2), (2, 1)])  # sessions are random: none is later than another
def test_a_silent_sender_may_go_on_until_another_has_driven_and_is_never_obeyed_after_that(wheels, first, second):
    driven(wheels, session=first)
    wheels.pass_ms(480)
    assert wheels.command(second, 1) == CommandVerdict.foreign  # 500 ms since the last command, not more
    out = wheels.pass_ms(30)
    assert out.accepted_session == 0
    assert wheels.command(second, 2) == CommandVerdict.accepted
    assert wheels.command(first, 1000) == CommandVerdict.session_ended
    wheels.pass_ms(600)
    assert wheels.command(first, 1001) == CommandVerdict.session_ended
    assert wheels.command(second, 2) == CommandVerdict.replayed
    assert wheels.command(second, 3) == CommandVerdict.accepted  # silent for 600 ms, and no other drove in between


def test_what_was_refused_as_foreign_cannot_be_played_once_its_time_has_come(wheels):
    driven(wheels)
    for k in range(1, 6):
        assert wheels.command(2, k) == CommandVerdict.foreign
    wheels.pass_ms(600)
    assert wheels.command(2, 5) == CommandVerdict.replayed
    assert wheels.command(2, 6) == CommandVerdict.accepted


def test_simulated_commands_move_simulated_wheels_only():
    assert Wheels().command(1, 1, simulated=True) == CommandVerdict.simulated
    assert Wheels(simulated_allowed=True).command(1, 1, simulated=True) == CommandVerdict.accepted


def test_a_pause_of_this_process_makes_all_that_has_queued_up_unplausible(wheels):
    """SIGSTOP for two seconds: the sender lives, its commands lie in the queue, of unknown age."""
    driven(wheels)
    wheels.now_us += 2_000_000
    for k in range(11, 41):
        assert wheels.command(1, k) == CommandVerdict.after_gap
        assert not wheels.moves()
    wheels.pass_ms(90)
    assert wheels.command(1, 41) == CommandVerdict.after_gap
    wheels.pass_ms(10)
    assert wheels.command(1, 42) == CommandVerdict.accepted, "the sender was not silent: we were"


def test_more_senders_than_can_be_remembered_are_not_obeyed(wheels):
    for session in range(1, base.SESSIONS + 1):
        wheels.command(session, 1)
    wheels.pass_ms(600)
    assert wheels.command(base.SESSIONS + 1, 1) == CommandVerdict.sessions_full
    assert wheels.command(base.SESSIONS, 2) == CommandVerdict.accepted  # its messages were received and never obeyed


@pytest.mark.parametrize("twist", [(float("nan"), 0.0), (0.0, float("inf")), (float("-inf"), float("nan"))])
def test_numbers_that_are_not_finite_are_no_command(wheels, twist):
    assert wheels.command(1, 1, Twist(*twist)) == CommandVerdict.malformed
    assert wheels.command(0, 1) == CommandVerdict.malformed


def test_a_stop_from_anyone_is_immediate_and_lasts_until_the_obeyed_session_is_resumed(wheels):
    driven(wheels)
    assert wheels.setpoint(run=False) == LatchVerdict.stopped
    assert wheels.command(1, 11) == CommandVerdict.accepted
    assert wheels.pass_ms(10).state == BaseState.stopped
    assert not wheels.moves()
    assert wheels.setpoint(session=2, counter=1, run=True) == LatchVerdict.other_session
    assert wheels.setpoint(session=0, counter=1, run=True) == LatchVerdict.other_session
    assert not wheels.moves()
    assert wheels.setpoint(session=1, counter=1, run=True) == LatchVerdict.resumed
    wheels.pass_ms(10)
    assert wheels.moves()
    assert wheels.base.rejected == {"resume_other_session": 2}


def test_a_resume_can_be_used_once(wheels):
    driven(wheels)
    assert wheels.setpoint(session=1, counter=5, run=True) == LatchVerdict.already_running  # while running
    wheels.setpoint(run=False)
    for counter in (5, 4, -1):
        assert wheels.setpoint(session=1, counter=counter, run=True) == LatchVerdict.replayed
    assert wheels.base.rejected == {"resume_replayed": 3}
    assert wheels.setpoint(session=1, counter=6, run=True) == LatchVerdict.resumed


def test_a_run_that_got_lost_cannot_be_played_after_the_stop_that_followed_it(wheels):
    driven(wheels)
    # Counter 5 ran, somewhere else; we only hear the genuine stop with counter 6.
    wheels.setpoint(session=1, counter=6, run=False)
    assert wheels.setpoint(session=1, counter=5, run=True) == LatchVerdict.replayed
    assert wheels.setpoint(session=1, counter=6, run=True) == LatchVerdict.replayed
    assert wheels.setpoint(session=1, counter=7, run=True) == LatchVerdict.resumed


def test_nobody_resumes_while_nobody_is_obeyed(wheels):
    wheels.setpoint(run=False)
    assert wheels.setpoint(session=0, counter=1, run=True) == LatchVerdict.other_session
    assert wheels.pass_ms(10).state == BaseState.stopped


@pytest.mark.parametrize(("first", "second"), [(1, 2), (2, 1)])
def test_a_stop_survives_a_change_of_the_sender_and_the_next_one_counts_from_1_again(wheels, first, second):
    driven(wheels, session=first)
    wheels.setpoint(session=first, counter=8, run=False)
    wheels.pass_ms(600)
    assert wheels.command(second, 1) == CommandVerdict.accepted
    assert not wheels.moves()
    assert wheels.setpoint(session=first, counter=9, run=True) == LatchVerdict.other_session
    assert wheels.setpoint(session=second, counter=1, run=True) == LatchVerdict.resumed


def test_a_driver_that_cannot_be_reached_is_told_zeros(wheels):
    last = driven(wheels)
    wheels.base.driver_works(False)
    assert wheels.command(1, last + 1) == CommandVerdict.accepted
    out = wheels.pass_ms(10)
    assert (out.state, out.command) == (BaseState.fault, Twist())


def test_it_can_begin_stopped():
    wheels = Wheels(config=base.BaseConfig(start_stopped=True))
    wheels.command(1, 1)
    assert wheels.pass_ms(10).state == BaseState.stopped


EVENTS = st.lists(
    st.tuples(
        st.sampled_from(["command", "command", "command", "stop", "run", "pass", "driver"]),
        st.integers(1, 3),  # a session
        st.integers(-2, 60),  # a counter, or milliseconds
        st.sampled_from([OWN, OWN, OWN, OWN + 1]),
        st.booleans(),
    ),
    max_size=120,
)


@settings(max_examples=300, deadline=None)
@given(EVENTS)
def test_whatever_happens_the_wheels_move_only_by_a_fresh_command_that_was_obeyed(events):
    """An oracle that knows nothing of sessions: time since the last obeyed command, stops, the driver."""
    wheels = Wheels()
    obeyed_us, stopped, works = None, False, True
    seen = set()
    for what, session, number, base_session, flag in events:
        if what == "command":
            verdict = wheels.command(session, number, base_session=base_session, simulated=flag and number % 7 == 0)
            if verdict == CommandVerdict.accepted:
                assert (session, number) not in seen, "obeyed twice"
                assert base_session == OWN
                obeyed_us = wheels.now_us
            if base_session == OWN:
                seen.add((session, number))
        elif what == "stop":
            wheels.setpoint(session, number, run=False)
            stopped = True
        elif what == "run":
            if wheels.setpoint(session, number, run=True) == LatchVerdict.resumed:
                stopped = False
        elif what == "driver":
            works = flag
            wheels.base.driver_works(flag)
        else:
            wheels.now_us += max(number, 0) * MS
        out = wheels.base.step(now_us=wheels.now_us)
        fresh = obeyed_us is not None and wheels.now_us - obeyed_us < LIFE_US
        if out.command != Twist():
            assert fresh and works and not stopped
        assert (out.state == BaseState.driving) == (fresh and works and not stopped)

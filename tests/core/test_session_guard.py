"""Accepted senders: sequences within a session, and the gate in front of a coordinator's setpoint."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pilotfish.core import MAX_BEARING_RAD, SequenceGuard, SequenceVerdict, Setpoint, SetpointGate, SetpointVerdict

SESSION, OTHER = 0x1234_5678_9ABC_DEF0, 17
STOP_DISTANCE_M = 0.4
INT64 = st.integers(-(2**63), 2**63 - 1)


def gate():
    return SetpointGate(session=SESSION, stop_distance_m=STOP_DISTANCE_M)


def decide(gate, asked, *, session=SESSION, counter=1, kept=None):
    decision = gate.decide(session=session, counter=counter, asked=asked, kept=kept or Setpoint(distance_m=1.1))
    return decision.verdict, decision.setpoint


def values(setpoint):
    return setpoint.distance_m, setpoint.bearing_rad, setpoint.run


def test_within_a_session_counters_rise_and_may_skip():
    guard = SequenceGuard(SESSION)
    asked = [5, 5, 4, 6, 100, 99, 2**63 - 1, 101]
    accepted = [c for c in asked if guard.accept(SESSION, c) == SequenceVerdict.accepted]
    assert accepted == [5, 6, 100, 2**63 - 1]


def test_another_session_is_refused_and_pushes_nothing_up():
    guard = SequenceGuard(SESSION)
    assert guard.accept(OTHER, 1000) == SequenceVerdict.wrong_session
    assert guard.last_counter == 0
    assert guard.accept(SESSION, 1) == SequenceVerdict.accepted


@given(session=INT64, counter=INT64)
def test_who_obeys_nobody_accepts_nothing(session, counter):
    assert SequenceGuard().accept(session, counter) == SequenceVerdict.wrong_session
    assert SequenceGuard().accept(0, counter) == SequenceVerdict.wrong_session


@given(st.lists(st.tuples(st.sampled_from([SESSION, OTHER, 0]), st.integers(-3, 12)), max_size=60))
def test_whatever_comes_the_accepted_counters_rise_and_none_is_accepted_twice(messages):
    guard = SequenceGuard(SESSION)
    accepted = [c for s, c in messages if guard.accept(s, c) == SequenceVerdict.accepted]
    assert all(a < b for a, b in zip(accepted, accepted[1:], strict=False))
    assert all(c > 0 for c in accepted)
    assert guard.last_counter == max(accepted, default=0)


@pytest.mark.parametrize(
    ("message", "verdict", "counted_as"),
    [
        ({}, SetpointVerdict.accepted, "setpoint_accepted"),
        ({"session": OTHER}, SetpointVerdict.wrong_session, "setpoint_wrong_session"),
        ({"session": 0}, SetpointVerdict.wrong_session, "setpoint_wrong_session"),
        ({"counter": 0}, SetpointVerdict.replayed, "setpoint_replayed"),
        ({"distance_m": 0.399}, SetpointVerdict.too_near, "setpoint_too_near"),
        ({"distance_m": 0.049}, SetpointVerdict.out_of_bounds, "setpoint_out_of_bounds"),
        ({"distance_m": math.nan}, SetpointVerdict.out_of_bounds, "setpoint_out_of_bounds"),
        ({"distance_m": math.inf}, SetpointVerdict.out_of_bounds, "setpoint_out_of_bounds"),
        ({"bearing_rad": math.nan}, SetpointVerdict.out_of_bounds, "setpoint_out_of_bounds"),
        ({"bearing_rad": 1.23}, SetpointVerdict.out_of_bounds, "setpoint_out_of_bounds"),
    ],
)
def test_every_refusal_has_its_name_and_changes_nothing(message, verdict, counted_as):
    asked = Setpoint.unchecked(distance_m=message.pop("distance_m", 2.0), bearing_rad=message.pop("bearing_rad", 0.5))
    kept = Setpoint(distance_m=1.1, bearing_rad=-0.1, run=False)
    the_gate = gate()
    said, setpoint = decide(the_gate, asked, kept=kept, **message)
    assert (said, said.counted_as) == (verdict, counted_as)
    assert values(setpoint) == values(asked if verdict == SetpointVerdict.accepted else kept)
    assert the_gate.last_counter == (1 if verdict == SetpointVerdict.accepted else 0)


def test_the_stop_distance_itself_may_be_kept():
    assert decide(gate(), Setpoint(distance_m=STOP_DISTANCE_M))[0] == SetpointVerdict.accepted


@pytest.mark.parametrize(
    "change",
    [{"distance_m": 0.05}, {"distance_m": 20.0}, {"bearing_rad": -MAX_BEARING_RAD}, {"bearing_rad": MAX_BEARING_RAD}],
)
def test_the_bounds_themselves_may_be_asked_for(change):
    """Of Setpoint::parameters(): 0.05 to 20 m, -70 to 70 degrees. A gate whose stop distance is
    below them adds nothing."""
    the_gate = SetpointGate(session=SESSION, stop_distance_m=0.0)
    assert decide(the_gate, Setpoint(**change))[0] == SetpointVerdict.accepted


SETPOINTS = st.builds(
    Setpoint.unchecked,
    distance_m=st.floats(allow_nan=True) | st.floats(0.0, 3.0),
    bearing_rad=st.floats(allow_nan=True) | st.floats(-1.0, 1.0),
    run=st.booleans(),
)


@given(st.lists(st.tuples(INT64.filter(lambda s: s != SESSION), INT64, SETPOINTS), max_size=40))
def test_without_the_session_nothing_but_stops_is_accepted(messages):
    the_gate, kept, stopped = gate(), Setpoint(distance_m=1.1, bearing_rad=-0.1, run=True), False
    for session, counter, asked in messages:
        verdict, kept = decide(the_gate, asked, session=session, counter=counter, kept=kept)
        stopped = stopped or not asked.run
        assert verdict == (SetpointVerdict.wrong_session if asked.run else SetpointVerdict.stopped)
        assert values(kept) == (1.1, -0.1, not stopped)
    assert the_gate.last_counter == 0


@given(st.lists(st.tuples(st.sampled_from([SESSION, OTHER]), st.integers(0, 9), SETPOINTS), max_size=60))
def test_a_stop_always_stops_and_only_what_is_accepted_ends_it(messages):
    the_gate, kept, used = gate(), Setpoint(), set()
    for session, counter, asked in messages:
        before, last = kept, the_gate.last_counter
        verdict, kept = decide(the_gate, asked, session=session, counter=counter, kept=before)
        genuine = session == SESSION and counter > last
        if not asked.run:
            assert verdict == SetpointVerdict.stopped
            assert not kept.run
        elif verdict == SetpointVerdict.accepted:
            assert genuine
            assert counter not in used  # a replay is never accepted
            assert values(kept) == values(asked)
        else:
            assert values(kept) == values(before)
        if the_gate.last_counter != last:
            used.add(counter)
        moved = values(kept)[:2] != values(before)[:2]
        assert not moved or genuine
        assert the_gate.last_counter == (counter if the_gate.last_counter != last else last)
        # Whatever is sent, the target that is kept can be kept.
        assert STOP_DISTANCE_M <= kept.distance_m <= 20.0
        assert abs(kept.bearing_rad) <= MAX_BEARING_RAD


def test_a_recording_made_before_a_genuine_stop_cannot_be_played_after_it():
    """The operator's resume (counter 4) got lost on its way and was recorded; then came his stop (counter 5)."""
    the_gate = gate()
    assert decide(the_gate, Setpoint(run=False), counter=5)[0] == SetpointVerdict.stopped
    verdict, kept = decide(the_gate, Setpoint(), counter=4, kept=Setpoint(run=False))
    assert verdict == SetpointVerdict.replayed
    assert not kept.run


def test_a_forged_stop_does_not_use_up_the_operators_counters():
    the_gate = gate()
    decide(the_gate, Setpoint(run=False), session=0, counter=2**63 - 1)
    decide(the_gate, Setpoint.unchecked(run=False, distance_m=math.nan), counter=2**63 - 1)
    assert decide(the_gate, Setpoint(), counter=1)[0] == SetpointVerdict.accepted

"""Who owes the wheels a command, on a thread of its own. Real time, so each bound is one that a late thread keeps too:
what must never happen is asserted for every command, what happens in time for one of a few attempts."""

import functools

import pytest
from coordinator_parts import SESSION, only, play

from pilotfish.core import Reason, Status

SENDER = "sender 30 0.1 0 0"  # 30 Hz, 100 ms, real time, no record
LIFE_US = 100_000
LONG_US = 60_000_000  # nothing dies in a test
AHEAD_US = 6_000  # the zero at the deadline leaves so much before it
TRACKING, NO_FRAME = int(Status.tracking), int(Reason.no_frame)


def answer(utime, linear_mps, life_us=LONG_US, status=Status.tracking, reason=Reason.none, holding=True):
    return f"answer {utime} {linear_mps} {int(status)} {int(reason)} {life_us} {int(holding)}"


def setpoint_changed(holding, run, stops):
    return f"setpoint_changed {int(holding)} {int(run)} {stops}"


def undisturbed(test):
    """For a test that counts what leaves between two lines: a busy machine may hold the lines up for a beat of the
    sender, now and then. Of five attempts one must come through; what is wrong fails them all."""

    @functools.wraps(test)
    def attempts(*arguments, **keywords):
        for _ in range(4):
            try:
                return test(*arguments, **keywords)
            except AssertionError:
                pass
        return test(*arguments, **keywords)

    return attempts


def said(sent):
    return sent.linear_mps, sent.status, sent.reason


def sent_by(*lines):
    return only(play(*lines), "sent")


def after_answer(*lines):
    """What left from the (only) answer on."""
    sent = sent_by(*lines)
    first = next(k for k, one in enumerate(sent) if one.utime != 0)
    return sent[first:]


def test_before_the_first_frame_zeros_go_out_with_session_and_rising_counters():
    sent = sent_by(SENDER, "wait 3")
    assert [one.counter for one in sent] == list(range(1, len(sent) + 1))
    assert {said(one) for one in sent} == {(0.0, Status.searching, Reason.no_frame)}
    assert {(one.session, one.simulated, one.base_session) for one in sent} == {(SESSION, False, 0)}


def test_a_frame_is_answered_at_once_and_the_answer_held_until_the_next():
    happened = play(SENDER, answer(55, 0.5), "wait 3", "base 9 0", "wait 1")
    first, *held = [one for one in only(happened, "sent") if one.utime == 55]
    assert said(first) == (0.5, Status.tracking, Reason.none)
    assert {said(one) for one in held} == {(0.5, Status.coasting, Reason.no_frame)}
    assert only(happened, "answer") == [["0.5", str(TRACKING), "0"]]
    assert (first.base_session, held[-1].base_session) == (0, 9)


def test_the_wheels_are_told_how_long_a_moving_command_is_valid():
    """As long as its measurement, to the microsecond; on this computer's clock as long as there is no base."""
    sent = after_answer(SENDER, answer(55, 0.5, 62_000), "wait 2")
    assert {one.valid_after_answer_us for one in sent} == {62_000, 0}
    for one in sent:
        assert (one.valid_after_answer_us == 0) == (one.linear_mps == 0.0)


@pytest.mark.parametrize("ahead_us", [-3_000_000, 0, 5_000_000])
def test_the_validity_is_on_the_clock_of_the_wheels_process_and_never_longer_than_the_measurement(ahead_us):
    """The clock is taken to lose 1 ms a second since it was announced: a little less than 62 ms later, 0 to 62 us."""
    first, *_ = after_answer(SENDER, f"base 9 {ahead_us}", answer(55, 0.5, 62_000))
    assert first.base_session == 9
    assert -5_000 < first.valid_after_answer_us - (62_000 + ahead_us) <= 0


def test_the_clock_of_a_wheels_process_that_is_gone_does_not_count_for_the_next():
    """The first one's clock is an hour ahead; the second, a driver of someone's own, states none."""
    first, *_ = after_answer(SENDER, "base 9 3600000000", "base 8 none", answer(55, 0.5, 62_000))
    assert (first.base_session, first.valid_after_answer_us) == (8, 62_000)


@undisturbed
def test_of_its_own_it_waits_one_and_a_half_periods_for_a_frame_and_then_one():
    """50 ms at 30 Hz, then 33.3 ms; late, perhaps, but never early."""
    first, second, third, *_ = after_answer(SENDER, answer(55, 0.5), "wait 2")
    assert first.since_answer_us < second.since_answer_us - 49_900
    assert third.since_answer_us - second.since_answer_us >= 33_000


@pytest.mark.parametrize("rate_hz", [1, 5, 15])
def test_however_slow_the_camera_the_wheels_hear_something_every_50_ms(rate_hz):
    for _ in range(10):
        sent = after_answer(f"sender {rate_hz} 0.1 0 0", answer(55, 0.5), "wait 3")
        gaps_us = [b.since_answer_us - a.since_answer_us for a, b in zip(sent, sent[1:], strict=False)]
        assert min(gaps_us) >= 49_000
        if max(gaps_us) < 60_000:
            return
    raise AssertionError("ten times later than 60 ms")


@pytest.mark.parametrize("life_us", [30_000, 62_000, LIFE_US])
def test_the_zero_leaves_6_ms_before_the_measurement_dies_and_not_before(life_us):
    """Between two beats, too: those are 50 and 83 ms after the answer."""
    in_time = False
    for _ in range(10):
        sent = after_answer(SENDER, answer(55, 0.5, life_us), "wait 4")
        for one in sent:
            assert (one.linear_mps == 0.5) == (one.since_answer_us <= life_us - AHEAD_US)
        zeros = [one for one in sent if one.linear_mps == 0.0]
        assert {said(one) for one in zeros} == {(0.0, Status.lost, Reason.no_frame)}
        in_time = in_time or zeros[0].since_answer_us <= life_us
        # One zero at the deadline; the next comes a period later.
        assert zeros[1].since_answer_us - zeros[0].since_answer_us >= 33_000
        if in_time:
            return
    assert in_time


def test_a_deadline_that_was_kept_is_not_counted_as_missed():
    for _ in range(10):
        *_, (counts,) = [only(play(SENDER, answer(55, 0.5, 30_000), "wait 3", "counts"), "counts")]
        if counts[1] == "0":
            return
    raise AssertionError("missed ten times")


def test_what_the_coordinator_put_to_rest_before_it_died_has_no_deadline_to_miss():
    """Its life ends 30 ms after the answer; the next zero leaves after 50 ms, and nothing was held in between."""
    (counts,) = only(
        play(SENDER, answer(55, 0.5, 30_000), setpoint_changed(False, True, 0), "wait 1", "counts"), "counts"
    )
    assert counts[1] == "0"


def test_an_answer_that_took_longer_than_the_measurement_lives_is_a_zero():
    happened = play(SENDER, answer(55, 0.5, -1), "counts")
    (left,) = [one for one in only(happened, "sent") if one.utime == 55][:1]
    assert said(left) == (0.0, Status.invalid_input, Reason.frame_stale)
    assert only(happened, "answer") == [["0", str(int(Status.invalid_input)), str(int(Reason.frame_stale))]]


@pytest.mark.parametrize(
    ("status", "reason", "said_why"),
    [
        (Status.tracking, Reason.none, Reason.frame_stale),  # looking took nearly all of its life
        (Status.invalid_input, Reason.frame_time_not_advancing, Reason.frame_time_not_advancing),
        (Status.coasting, Reason.no_tag_found, Reason.no_tag_found),
    ],
)
def test_what_dies_before_it_is_heard_is_not_sent_again_by_a_frame_in_its_last_6_ms(status, reason, said_why):
    """The zero at the deadline has left already, 6 ms before it; what follows it must not move the robot once more."""
    first, *others = after_answer(SENDER, answer(55, 0.5, AHEAD_US - 1000, status, reason), "wait 2")
    assert (first.linear_mps, first.reason) == (0.0, said_why)
    assert {one.linear_mps for one in others} == {0.0}


def test_an_answer_that_measured_nothing_says_why_and_a_zero_is_no_stale_command():
    first, *_ = after_answer(SENDER, answer(55, 0.0, -1, status=Status.lost, reason=Reason.no_tag_found, holding=False))
    assert said(first) == (0.0, Status.lost, Reason.no_tag_found)


@undisturbed
def test_a_stop_is_a_zero_at_once_and_until_the_coordinator_has_been_told_of_it_and_of_a_run():
    happened = play(
        SENDER,
        answer(55, 0.5),
        "stop",
        "wait 1",
        answer(56, 0.6),  # a frame that the coordinator looked at before the change
        setpoint_changed(True, True, 0),  # a setpoint from before the stop
        answer(57, 0.7),
        setpoint_changed(True, False, 1),
        "wait 1",
        setpoint_changed(False, True, 1),
        answer(58, 0.8),
        "counts",
    )
    sent = only(happened, "sent")
    stopped_at = next(k for k, one in enumerate(sent) if one.status == Status.stopped)
    resumed_at = next(k for k, one in enumerate(sent) if one.utime == 58)
    assert all(one.linear_mps == 0.0 for one in sent[stopped_at:resumed_at])
    assert {one.status for one in sent[stopped_at : resumed_at - 1]} == {Status.stopped}
    assert said(sent[stopped_at]) == (0.0, Status.stopped, Reason.stop_requested)
    assert said(sent[resumed_at]) == (0.8, Status.tracking, Reason.none)
    assert only(happened, "stop") == [["1"]]
    assert only(happened, "counts")[0][4] == "1"


def test_two_stops_are_over_only_when_the_coordinator_knows_of_both():
    lines = [SENDER, answer(55, 0.5), "stop", "stop", setpoint_changed(False, True, 1), answer(56, 0.6)]
    assert said(next(one for one in sent_by(*lines) if one.utime == 56)) == (0.0, Status.stopped, Reason.stop_requested)
    lines += [setpoint_changed(False, True, 2), setpoint_changed(False, True, 1), answer(57, 0.7)]
    assert said(next(one for one in sent_by(*lines) if one.utime == 57)) == (0.7, Status.tracking, Reason.none)


@undisturbed
@pytest.mark.parametrize(("holding", "run"), [(False, True), (True, False)])
def test_when_the_coordinator_rests_or_stops_nothing_is_held_any_more(holding, run):
    sent = after_answer(
        SENDER, answer(55, 0.5), setpoint_changed(holding, run, 0), "wait 2", setpoint_changed(True, True, 0), "wait 1"
    )
    assert sent[0].linear_mps == 0.5
    assert all(one.linear_mps == 0.0 for one in sent[1:])
    assert sent[1].status == (Status.lost if run else Status.stopped)


@undisturbed
def test_what_the_coordinator_still_holds_goes_on():
    sent = after_answer(SENDER, answer(55, 0.5), setpoint_changed(True, True, 0), "wait 2")
    assert all(one.linear_mps == 0.5 for one in sent)


@undisturbed
def test_a_rival_is_answered_with_zeros_at_once_and_for_a_second():
    happened = play(SENDER, answer(55, 0.5), "rival 0", answer(56, 0.6), "wait 1", "counts")
    rivalled = [one for one in only(happened, "sent") if one.utime != 0][1:]
    assert len(rivalled) == 3  # at once, the answer, a beat
    assert {said(one) for one in rivalled} == {(0.0, Status.invalid_input, Reason.another_coordinator)}
    assert only(happened, "counts")[0][2] == "1"
    # Its last command is 1.1 s old: over. What was held before it is over, too.
    forgotten = after_answer(SENDER, answer(55, 0.5), "rival 1100000", "wait 1", answer(56, 0.6))
    assert said(forgotten[-1]) == (0.6, Status.tracking, Reason.none)
    assert all(one.linear_mps == 0.0 for one in forgotten[1:-1])
    almost = after_answer(SENDER, answer(55, 0.5), "rival 700000", answer(56, 0.6))
    assert almost[-1].reason == Reason.another_coordinator


@undisturbed
def test_a_rival_of_a_robot_that_rests_is_no_reason_for_a_command_of_its_own():
    assert [one.utime for one in sent_by(SENDER, answer(55, 0.0), "rival 0")].count(55) == 1


@undisturbed
def test_the_same_frame_asked_about_again_gets_the_same_answer_while_it_holds():
    first, again = after_answer(SENDER, answer(55, 0.5), "again 55")[:2]
    assert said(again) == said(first) == (0.5, Status.tracking, Reason.none)
    assert again.counter == first.counter + 1
    lost = after_answer(SENDER, answer(55, 0.5, 30_000), "wait 3", "again 55")[-1]
    assert said(lost) == (0.0, Status.lost, Reason.none)
    stopped = after_answer(SENDER, answer(55, 0.5), "stop", "again 55")[-1]
    assert said(stopped) == (0.0, Status.stopped, Reason.stop_requested)
    resting = after_answer(SENDER, answer(55, 0.0, status=Status.searching, reason=Reason.no_tag_found), "again 55")
    assert said(resting[-1]) == (0.0, Status.searching, Reason.no_tag_found)


@undisturbed
def test_the_end_is_three_zeros_and_nothing_after_them():
    for reason, status in [(Reason.stop_requested, Status.stopped), (Reason.internal_error, Status.invalid_input)]:
        happened = play(
            SENDER,
            answer(55, 0.5),
            f"finish {int(reason)}",
            answer(56, 0.6),
            "again 56",
            "stop",
            "rival 0",
            f"finish {int(reason)}",
        )
        sent = only(happened, "sent")
        assert [said(one) for one in sent[-3:]] == [(0.0, status, reason)] * 3
        assert sent[-4].linear_mps == 0.5
        assert only(happened, "answer")[-1][0] == "0"


@undisturbed
def test_simulated_time_stands_still_while_a_frame_is_looked_at():
    """The life begins when the answer leaves, in full, whatever the simulated clock says; a zero has none."""
    simulated = "sender 30 0.1 1 0"
    sent = after_answer(simulated, answer(55, 0.5, -1), "wait 4")
    assert all(one.simulated for one in sent)
    assert said(sent[0]) == (0.5, Status.tracking, Reason.none)
    for one in sent:
        assert one.linear_mps == 0.0 or one.since_answer_us <= LIFE_US
    assert sent[1].linear_mps == 0.5 or sent[1].since_answer_us > LIFE_US - AHEAD_US
    still = after_answer(simulated, answer(55, 0.0), "wait 1")
    assert said(still[1]) == (0.0, Status.lost, Reason.no_frame)


@undisturbed
def test_what_left_and_why_is_recorded_with_what_the_core_held():
    happened = play("sender 30 0.1 0 1", answer(55, 0.5), "stop", setpoint_changed(False, False, 1), "wait 1")
    sent, recorded = only(happened, "sent"), only(happened, "recorded")
    assert [(r.counter, r.status, r.reason) for r in recorded] == [(s.counter, s.status, s.reason) for s in sent]
    at = next(k for k, one in enumerate(sent) if one.utime == 55)
    answered, stopped, beat = recorded[at : at + 3]
    assert (answered.holding, answered.missing) == (True, Reason.none)
    assert 0 < answered.asked_later_us <= AHEAD_US  # what will hold when the wheels hear it
    assert (stopped.holding, stopped.run, stopped.missing) == (True, True, Reason.stop_requested)  # not received yet
    assert (beat.holding, beat.run, beat.missing) == (False, False, Reason.no_frame)
    assert 0 < beat.asked_later_us <= AHEAD_US
    assert any(r.asked_later_us > 0 for r in recorded)
    assert only(play("sender 30 0.1 1 1", "wait 1"), "recorded") == []  # simulated: there is nothing to be replayed


def test_what_it_sends_by_itself_is_what_it_counts_as_on_time_or_late():
    happened = play(SENDER, "wait 2", answer(55, 0.5), "wait 2", "counts")
    sent, missed, rivals, by_itself, stops, alive = only(happened, "counts")[0]
    before = [what for what, _ in happened[: [what for what, _ in happened].index("counts")]]
    assert int(sent) == before.count("sent")
    assert int(by_itself) == int(sent) - 1
    assert (missed, rivals, stops, alive) == ("0", "0", "0", "1")

"""Time for frames that were not taken now: it passes as the stamps say, where they can be accepted."""

from coordinator_parts import only, play

HOUR_US = 3_600_000_000


def shown(*frames):
    """What the clock shows for frames of (utime, arrival); between two frames it stands still."""
    answers = only(play(*(f"clock {utime} {real_us}" for utime, real_us in frames)), "clock")
    assert all(stands_still == "1" for _, stands_still in answers)
    times = [int(now_us) for now_us, _ in answers]
    return [time - times[0] for time in times]


def test_it_passes_as_the_stamps_say_and_not_as_time_does():
    assert shown((1000, 0), (1500, 7), (1500, 90), (501_500, 91)) == [0, 500, 500, 500_500]


def test_a_stamp_that_goes_back_or_leaps_by_more_than_an_hour_lets_it_pass_as_here():
    assert shown((1000, 0), (999, 40)) == [0, 40]
    assert shown((1000, 0), (1000 + HOUR_US, 40)) == [0, HOUR_US]
    assert shown((1000, 0), (1001 + HOUR_US, 40)) == [0, 40]
    assert shown((-(2**62), 0), (2**62, 40), (-(2**62), 50)) == [0, 40, 50]


def test_it_never_goes_back_even_if_the_arrivals_do():
    assert shown((1000, 500), (900, 400), (950, 401)) == [0, 0, 50]

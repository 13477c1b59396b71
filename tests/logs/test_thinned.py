"""Curves with few points that look like those with many."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from pilotfish.plots.thinned import alone, thinned

VALUES = st.lists(st.one_of(st.floats(-1e6, 1e6), st.just(float("nan"))), min_size=1, max_size=400)


@given(VALUES, st.integers(1, 50))
def test_the_extremes_and_the_order_of_time_survive(values, buckets):
    values = np.array(values)
    time_s, kept = thinned(np.arange(len(values)) * 0.03, values, buckets)
    known = kept[np.isfinite(kept)]
    assert len(known) <= max(2 * buckets, 0)
    if np.isfinite(values).any():
        assert known.max() == np.nanmax(values)
        assert known.min() == np.nanmin(values)
    assert (np.diff(time_s[np.isfinite(time_s)]) > 0).all()


@given(VALUES)
def test_a_short_curve_is_itself(values):
    values = np.array(values)
    _, kept = thinned(np.arange(len(values)) * 0.03, values, 1000)
    assert np.array_equal(kept[np.isfinite(kept)], values[np.isfinite(values)])


@given(VALUES)
def test_a_curve_is_broken_where_something_is_unknown_and_only_there(values):
    values = np.array(values)
    _, kept = thinned(np.arange(len(values)) * 0.03, values, 1000)
    known = np.isfinite(values)
    inside = known[np.argmax(known) : len(known) - np.argmax(known[::-1])] if known.any() else known[:0]
    breaks = int((np.diff(inside.astype(int)) == -1).sum())
    assert np.isnan(kept).sum() == breaks


def test_silence_breaks_a_curve_and_slow_frames_do_not():
    time_s = np.array([0.0, 0.4, 0.8, 2.0, 2.4])
    assert np.isnan(thinned(time_s, np.ones(5))[1]).tolist() == [False, False, False, True, False, False]


def test_a_sample_between_two_breaks_is_alone_and_drawn_as_a_dot():
    nan = np.nan
    values = np.array([1.0, nan, 2.0, 3.0, nan, 4.0])
    time_s, kept = thinned(np.arange(6) * 0.03, values)
    assert alone(time_s, kept)[1].tolist() == [1.0, 4.0]
    assert alone(*thinned(np.arange(3) * 0.03, np.ones(3)))[1].tolist() == []

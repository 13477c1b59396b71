"""Where robots stand in a named shape."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish.formation.shapes import ABREAST_BEARING_RAD, Branch, Shape, places
from pilotfish.formation.watching import watch_of

no_deadline = settings(derandomize=True, deadline=None, max_examples=50)
spacings_m = st.floats(0.5, 3.0)
angles_rad = st.floats(math.radians(1.0), math.radians(60.0))
counts = st.integers(2, 12)


@pytest.mark.parametrize("name", ["column", "chain"])
@no_deadline
@given(count=counts, spacing_m=spacings_m)
def test_in_a_column_each_robot_is_straight_behind_the_one_before(name, count, spacing_m):
    at = places(Shape(name, spacing_m), count)
    for before, robot in zip(list(at), list(at)[1:], strict=False):
        watch = watch_of(at, robot, before)
        assert (watch.distance_m, watch.bearing_rad) == pytest.approx((spacing_m, 0.0))


@no_deadline
@given(count=counts, spacing_m=spacings_m, angle_rad=st.floats(-1.0, 1.0))
def test_in_an_echelon_each_sees_the_one_before_at_the_angle(count, spacing_m, angle_rad):
    at = places(Shape("echelon", spacing_m, angle_rad), count)
    for before, robot in zip(list(at), list(at)[1:], strict=False):
        watch = watch_of(at, robot, before)
        assert (watch.distance_m, watch.bearing_rad) == pytest.approx((spacing_m, angle_rad))


@no_deadline
@given(pairs=st.integers(1, 5), spacing_m=spacings_m, angle_rad=angles_rad)
def test_the_arms_of_a_wedge_mirror_each_other_and_open_by_twice_the_angle(pairs, spacing_m, angle_rad):
    at = places(Shape("wedge", spacing_m, angle_rad), 1 + 2 * pairs)
    for rank in range(1, pairs + 1):
        left, right = at[f"robot{2 * rank - 1}"], at[f"robot{2 * rank}"]
        assert left == pytest.approx((right[0], -right[1]))
        assert left[1] > 0.0, "the odd robots are on the left"
        # All of an arm lie on one ray from the leader, at the angle from straight behind it.
        assert math.atan2(left[1], -left[0]) == pytest.approx(angle_rad)
        assert math.hypot(*left) == pytest.approx(rank * spacing_m)


@no_deadline
@given(side=st.integers(2, 4), spacing_m=spacings_m, angle_rad=angles_rad)
def test_a_diamond_is_as_wide_in_its_middle_as_its_angle_says_and_has_one_robot_at_each_end(side, spacing_m, angle_rad):
    at = list(places(Shape("diamond", spacing_m, angle_rad), side * side).values())
    # Its corners: left (m-1, 0) and right (0, m-1) of the lattice, so 2 (m-1) s sin(a) apart; the rear one is
    # 2 (m-1) s cos(a) behind.
    across, behind = [y for _, y in at], [x for x, _ in at]
    assert max(across) - min(across) == pytest.approx(2 * (side - 1) * spacing_m * math.sin(angle_rad))
    assert min(behind) == pytest.approx(-2 * (side - 1) * spacing_m * math.cos(angle_rad))
    assert at[-1] == pytest.approx((min(behind), 0.0), abs=1e-9)
    assert at[1][1] > 0.0 > at[2][1], "from left to right"


@no_deadline
@given(count=counts, spacing_m=spacings_m, angle_rad=st.floats(0.05, 0.2))
def test_in_a_star_all_are_at_the_spacing_and_neighbours_at_the_angle_around_the_leader(count, spacing_m, angle_rad):
    at = list(places(Shape("star", spacing_m, angle_rad), count).values())[1:]
    around = [math.atan2(y, -x) for x, y in at]
    assert [math.hypot(*place) for place in at] == pytest.approx([spacing_m] * (count - 1))
    assert [a - b for a, b in zip(around, around[1:], strict=False)] == pytest.approx([angle_rad] * (count - 2))
    assert sum(around) == pytest.approx(0.0, abs=1e-9), "as many on the left as on the right"


@no_deadline
@given(count=st.integers(3, 8), spacing_m=spacings_m)
def test_a_line_abreast_is_so_far_behind_that_the_outermost_robots_see_the_leader_at_the_default_bearing(
    count, spacing_m
):
    at = places(Shape("line_abreast", spacing_m), count)
    rows = list(at.values())[1:]
    assert len({round(x, 9) for x, _ in rows}) == 1
    outermost = watch_of(at, "robot1", "leader")
    if -rows[0][0] > spacing_m + 1e-9:  # else the spacing is more than that
        assert outermost.bearing_rad == pytest.approx(-ABREAST_BEARING_RAD)
    assert abs(outermost.bearing_rad) <= ABREAST_BEARING_RAD + 1e-9 or count == 3


branches = st.tuples(st.floats(0.5, 3.0), st.floats(-1.0, 1.0), st.integers(0, 100))


@no_deadline
@given(st.lists(branches, min_size=1, max_size=8))
def test_in_a_tree_every_robot_sees_its_leader_where_its_branch_says(drawn):
    names = ["leader", *(f"robot{k}" for k in range(1, len(drawn) + 1))]
    tree = tuple(Branch(names[which % (k + 1)], d, b) for k, (d, b, which) in enumerate(drawn))
    at = places(Shape("tree", 1.0, tree=tree), len(tree) + 1)
    for name, branch in zip(names[1:], tree, strict=True):
        watch = watch_of(at, name, branch.leader)
        assert (watch.distance_m, watch.bearing_rad) == pytest.approx((branch.distance_m, branch.bearing_rad))

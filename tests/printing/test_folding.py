"""Which tags adjoin: two panels that were folded about a line are found to be folded about it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from pilotfish.printing.folding import SIDES, find_joint, make_nets

ANGLES_DEG = st.one_of(st.floats(-150, -1), st.floats(1, 150), st.just(0.0))


def pose(rotation, translation):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, translation
    return matrix


def folded_panel(side, reach_a, reach_b, shift, quarter, angle_rad):
    """aMb: a second tag that lies flat beyond a line at ``reach_a`` on one side of the first, shifted along the line
    and turned by quarters, and is then folded about the line, away from the reader (z of a tag goes into the wall)."""
    out = np.array([*SIDES[side], 0.0])
    along = np.array([-out[1], out[0], 0.0])
    flat = pose(
        Rotation.from_euler("z", 90 * quarter, degrees=True).as_matrix(), out * (reach_a + reach_b) + along * shift
    )
    # About the axis z x out turned so that out goes towards z: -(z x out) = out x z.
    fold = Rotation.from_rotvec(np.cross(out, [0, 0, 1]) * angle_rad).as_matrix()
    return pose(np.eye(3), out * reach_a) @ pose(fold, [0, 0, 0]) @ pose(np.eye(3), -out * reach_a) @ flat


@settings(max_examples=300, deadline=None)
@given(
    side=st.integers(0, 3),
    quarter=st.integers(0, 3),
    angle_deg=ANGLES_DEG,
    halves=st.tuples(st.floats(0.02, 0.1), st.floats(0.02, 0.1)),
    gaps=st.tuples(st.floats(0, 0.25), st.floats(0, 0.25)),
    shift=st.floats(-0.8, 0.8),
    where=st.tuples(*[st.floats(-180, 180)] * 3),
)
def test_a_fold_is_found_again(side, quarter, angle_deg, halves, gaps, shift, where):
    """At any place in space, whichever way the two are turned, the first of them given first or last."""
    reach_a, reach_b = (half * (1 + gap) for half, gap in zip(halves, gaps, strict=True))
    if angle_deg == 0.0:  # the line is half way between the borders, wherever the paper was thought to end
        gap = reach_a + reach_b - sum(halves)
        reach_a, reach_b = halves[0] + gap / 2, halves[1] + gap / 2
        if gap > 0.6 * min(halves) - 1e-6:
            return
    aMb = folded_panel(side, reach_a, reach_b, shift * sum(halves), quarter, math.radians(angle_deg))
    oMa = pose(Rotation.from_euler("zyx", where, degrees=True).as_matrix(), [0.3, -0.2, 0.1])
    joint = find_joint(oMa, oMa @ aMb, *halves)
    assert joint is not None
    assert joint.side_a == side
    assert (joint.reach_a_m, joint.reach_b_m) == pytest.approx((reach_a, reach_b), abs=1e-6)
    assert math.degrees(joint.angle_rad) == pytest.approx(angle_deg, abs=1e-4)
    flat = folded_panel(side, reach_a, reach_b, shift * sum(halves), quarter, 0.0)
    np.testing.assert_allclose(joint.aTb, np.column_stack([flat[:2, :2], flat[:2, 3]]), atol=1e-6)
    back = find_joint(oMa @ aMb, oMa, halves[1], halves[0])
    assert back is not None
    assert (back.side_a, back.side_b) == (joint.side_b, joint.side_a)
    assert back.angle_rad == pytest.approx(joint.angle_rad, abs=1e-6)


@pytest.mark.parametrize(
    "aMb",
    [
        folded_panel(0, 0.05, 0.05, 0.0, 0, math.radians(40))
        @ pose(Rotation.from_euler("z", 5, degrees=True).as_matrix(), [0] * 3),
        folded_panel(0, 0.05, 0.05, 0.095, 0, math.radians(40)),
        folded_panel(0, 0.07, 0.07, 0.0, 0, math.radians(40)),
        folded_panel(0, 0.045, 0.045, 0.0, 0, math.radians(40)),
        folded_panel(0, 0.05, 0.05, 0.0, 0, math.pi),
        pose(np.eye(3), [0.1, 0.0, 0.01]),
        pose(np.diag([-1.0, 1.0, -1.0]), [0.0, 0.0, 0.1]),
    ],
    ids=[
        "askew",
        "beside each other",
        "too far apart",
        "too near",
        "back to back",
        "one behind the other",
        "facing each other",
    ],
)
def test_what_is_no_fold_is_none(aMb):
    """For two tags whose sheets are 100 mm wide."""
    assert find_joint(np.eye(4), aMb, 0.05, 0.05) is None


def test_nets_are_joined_while_they_fit_and_every_tag_is_on_one():
    """Five panels of 100 mm in a row, folded by 20 degrees, on paper of 350 mm: nets of three and of two."""
    poses = [np.eye(4)]
    for _ in range(4):
        poses.append(poses[-1] @ folded_panel(0, 0.05, 0.05, 0.0, 0, math.radians(20)))

    def fits(net):
        corners = np.concatenate([panel.corners_m() for panel in net.panels])
        return bool((np.ptp(corners, axis=0) <= 0.35).all())

    nets = make_nets(poses, [0.05] * 5, fits)
    assert sorted(panel.tag for net in nets for panel in net.panels) == list(range(5))
    assert sorted(len(net.panels) for net in nets) == [2, 3]
    # The one joint that is cut is an edge of both.
    assert [len(net.edges) for net in nets] == [1, 1]
    assert nets[0].edges[0] is nets[1].edges[0]
    assert len(make_nets(poses, [0.05] * 5, lambda net: True)) == 1
    assert len(make_nets(poses, [0.05] * 5, lambda net: True, join=False)) == 5


def test_a_net_does_not_lie_on_itself():
    """A cube's six faces around one: four beside it, the last beyond one of them. Joined in any order, none
    overlaps."""
    half = 0.05
    first = np.eye(4)
    poses = [first, *(first @ folded_panel(side, half, half, 0, 0, math.pi / 2) for side in range(4))]
    poses.append(poses[1] @ folded_panel(0, half, half, 0, 0, math.pi / 2))
    (net,) = make_nets(poses, [half] * 6, lambda net: True)
    assert len(net.folds) == 5
    assert len(net.edges) == 12 - 5  # a cube has twelve edges
    centres = np.array([panel.centre_m for panel in net.panels])
    distances = np.linalg.norm(centres[:, None] - centres, axis=-1)[~np.eye(6, dtype=bool)]
    assert distances.min() == pytest.approx(0.1)

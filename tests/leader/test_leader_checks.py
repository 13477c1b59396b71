"""What is said about a leader's file before a robot drives by it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pilotfish import coordinator, core, sim
from pilotfish import data as shipped
from pilotfish.leader import Level, Viewer, check_leader, look_all_round, sheet_of, tag_reach
from pilotfish.leader.sheets import overlap
from pilotfish.vision import TagDetector, TagDetectorConfig, TagFamily, TagMeasurement, TagTracker

CAMERA = coordinator.load_calibration(str(shipped.path("calibrations/sim_640x480.yaml")))
HIGHEST_ANGLE_DEG = math.degrees(math.acos(0.2))  # the largest viewing angle at which a tag is followed: 78.46 degrees


def tag(tag_id, size_m=0.16, position_m=(-0.2, 0.0, 0.25), facing_deg=180.0, tilt_deg=0.0, roll_deg=0.0):
    angles = {"facing_rad": facing_deg, "tilt_rad": tilt_deg, "roll_rad": roll_deg}
    radians = {key: math.radians(value) for key, value in angles.items()}
    return core.BodyTag(id=tag_id, size_m=size_m, position_m=list(position_m), **radians)


def findings(*tags, viewer=None, **options):
    body = core.LeaderBody(list(tags))
    return check_leader(body, look_all_round(body, **options), viewer)


def said(found, level):
    return [finding.text for finding in found if finding.level is level]


def bad(found):
    return [finding for finding in found if finding.level is not Level.note]


@pytest.mark.parametrize("name", ["single_tag", "three_faces", "three_faces_second"])
def test_the_shipped_leaders_have_neither_errors_nor_warnings(name):
    body = coordinator.load_leader_body(str(shipped.path(f"leaders/{name}.yaml")))
    assert not bad(
        check_leader(body, look_all_round(body), Viewer(CAMERA, core.CameraMounting(position_m=[0, 0, 0.25])))
    )


@pytest.mark.parametrize(
    ("apart_m", "level", "words"),
    [
        # Black squares of 160 mm with white borders of 20 mm: beside each other they need 200 mm.
        (0.150, Level.error, "tags 0 and 1 overlap: their black squares"),
        (0.170, Level.warning, "tags 0 and 1: one lies in the white border"),
        (0.190, Level.warning, "tags 0 and 1: their white borders"),
        (0.200, None, ""),
    ],
)
@pytest.mark.parametrize("turned_deg", [0.0, 90.0])
def test_tags_in_one_plane_need_room_for_their_white_borders(apart_m, level, words, turned_deg):
    c, s = math.cos(math.radians(turned_deg)), math.sin(math.radians(turned_deg))
    found = findings(tag(0, roll_deg=turned_deg), tag(1, position_m=(-0.2, apart_m * c, 0.25 + apart_m * s)))
    if level is None:
        assert not bad(found)
    else:
        assert any(text.startswith(words) for text in said(found, level))
        assert len(bad(found)) == 1


def test_tags_that_cross_each_other_overlap():
    found = findings(tag(0), tag(1, facing_deg=100.0))
    assert any("tags 0 and 1 overlap" in text for text in said(found, Level.error))


def test_a_folded_edge_is_no_overlap():
    """Two 160 mm tags with their borders, folded by 45 degrees at the common edge 100 mm from either centre."""
    c, s = 0.1 * math.cos(math.radians(45)), 0.1 * math.sin(math.radians(45))
    assert not bad(findings(tag(0), tag(1, position_m=(-0.2 + s, 0.1 + c, 0.25), facing_deg=135.0)))


def three_faces(size_m):
    """data/leaders/three_faces.yaml with other sizes: folded by 50 degrees, 5 mm a fold, sheets of 10/8 of the size."""
    places = [((-0.2, 0.0, 0.25), 180.0), ((-0.1196, 0.1675, 0.25), 130.0), ((-0.1196, -0.1675, 0.25), -130.0)]
    return [tag(k, size_m, place, facing_deg) for k, (place, facing_deg) in enumerate(places)]


def test_sizes_that_are_too_large_for_the_places_of_folded_faces_contradict_them():
    """176 mm where 160 are right. The planes meet 0.100 m and 0.105 m from the two centres, and the sheets need 0.11 m
    each: they meet with 0.205 / 0.22 of 176 mm, which is 164 mm (160 mm, and folds of 5 mm)."""
    found = said(findings(*three_faces(0.176)), Level.warning)
    assert len(found) == 2  # of the rear face and either side
    assert all("contradict" in text and "0.164 m instead of 0.176 m" in text and "ruler" in text for text in found)


def test_sizes_that_are_too_small_for_the_places_of_folded_faces_are_noted():
    """144 mm: sheets of 0.18 m, so 0.205 - 0.18 = 25 mm lie between two of them."""
    found = [text for text in said(findings(*three_faces(0.144)), Level.note) if "contradict" in text]
    assert len(found) == 2
    assert all("25 mm between the sheets" in text and "0.164 m instead of 0.144 m" in text for text in found)


@pytest.mark.parametrize("size_m", [0.156, 0.16, 0.163])
def test_folds_of_some_millimetres_are_no_contradiction(size_m):
    assert not any("contradict" in finding.text for finding in findings(*three_faces(size_m)))


def test_faces_that_are_meant_to_be_apart_are_no_contradiction():
    """A rear tag and one on the side of a box, 0.3 m from the edge; and two at different heights."""
    assert not any("contradict" in finding.text for finding in findings(tag(0), tag(1, 0.1, (0.1, 0.2, 0.25), 90.0)))
    assert not any("contradict" in finding.text for finding in findings(tag(0), tag(1, 0.16, (-0.1, 0.1, 0.9), 90.0)))


def test_overlap_of_random_sheets_is_that_of_their_points():
    """Oracle: a grid of points on one sheet, pulled to both sides of the other's plane, is somewhere inside of it."""
    random = np.random.default_rng(1)
    share = np.linspace(-1, 1, 81)
    agreed = 0
    for _ in range(400):
        place = random.uniform(-0.08, 0.08, (2, 3))
        turn = random.uniform(-180, 180, (2, 3)) / [1, 2, 1]
        a, b = (sheet_of(tag(0, 0.1, place[k], *turn[k]), "tag36h11") for k in (0, 1))
        grid = a.centre_m + a.half_m * (share[:, None, None] * a.axes[:, 0] + share[None, :, None] * a.axes[:, 1])
        local = (grid - b.centre_m) @ b.axes
        inside = (np.abs(local[..., :2]) < b.half_m).all(axis=-1)
        crosses = ((local[1:, :, 2] * local[:-1, :, 2] < 0) & inside[1:] & inside[:-1]).any()
        crosses |= ((local[:, 1:, 2] * local[:, :-1, 2] < 0) & inside[:, 1:] & inside[:, :-1]).any()
        if crosses:  # the grid misses what is smaller than its mesh; the other way there is no doubt
            assert overlap(a, b)
        agreed += overlap(a, b) == bool(crosses)
    assert agreed >= 390


def test_a_tag_that_faces_into_the_body_is_named_with_where_it_should_look():
    """On the left side of the robot, looking right."""
    found = findings(tag(0), tag(1, position_m=(0.0, 0.2, 0.25), facing_deg=-90.0))
    (text,) = [text for text in said(found, Level.warning) if "faces into the body" in text]
    assert text.startswith("tag 1 ")
    assert "outward would be facing_deg 90, not -90" in text
    for outward_deg in (90.0, 180.0):  # to the left, or beside the body to the rear
        assert not bad(findings(tag(0), tag(1, position_m=(0.0, 0.2, 0.25), facing_deg=outward_deg)))


def test_one_flat_tag_leaves_the_heading_ambiguous_and_so_do_two_in_one_plane():
    assert any(text.startswith("one flat tag: ") for text in said(findings(tag(0)), Level.note))
    two = findings(tag(0), tag(1, position_m=(-0.2, 0.25, 0.25)))
    assert any(text.startswith("all 2 tags are in one plane: ") for text in said(two, Level.note))
    folded = findings(tag(0), tag(1, position_m=(-0.1, 0.25, 0.25), facing_deg=130.0))
    assert not any("heading" in text for text in said(folded, Level.note))


def test_a_tag_below_the_ground_or_towards_the_sky_is_named():
    found = findings(tag(0, position_m=(-0.2, 0.0, 0.05)), tag(1, 0.05, (0, 0, 0.4), 180.0, 90.0))
    assert any(text.startswith("tag 0 reaches 30 mm below the ground") for text in said(found, Level.warning))
    assert any(text.startswith("tag 1 looks up") for text in said(found, Level.warning))
    assert any(
        text.startswith("tag 1 looks down")
        for text in said(findings(tag(0), tag(1, 0.05, (0, 0, 0.4), 180, -90)), Level.warning)
    )


def test_a_leader_that_is_not_seen_from_behind_is_warned_of():
    found = findings(tag(0, position_m=(0.2, 0.0, 0.25), facing_deg=0.0))
    assert any(text.startswith("from straight behind") for text in said(found, Level.warning))


def test_the_blind_sector_is_where_the_viewing_angle_is_too_large():
    """A tag in the turning centre, seen from its own height: the viewing angle is the azimuth's distance from 180
    degrees."""
    body = core.LeaderBody([tag(0, position_m=(0.0, 0.0, 0.25))])
    around = look_all_round(body, height_m=0.25)
    (sector,) = around.sectors(around.seen[:, 0])
    assert sector.from_deg == math.ceil(180 - HIGHEST_ANGLE_DEG)
    assert sector.to_deg == math.floor(180 + HIGHEST_ANGLE_DEG)
    (blind,) = around.blind()
    assert (blind.from_deg, blind.to_deg % 360) == (sector.to_deg + 1, sector.from_deg - 1)
    assert any("no tag is seen from 259° to 101°" in text for text in said(findings(*body.tags), Level.note))


def test_tags_all_round_leave_no_blind_sector():
    ring = [
        tag(k, 0.1, (0.2 * math.cos(a), 0.2 * math.sin(a), 0.25), math.degrees(a))
        for k, a in enumerate(np.radians([0, 90, 180, 270]))
    ]
    around = look_all_round(core.LeaderBody(ring))
    assert around.blind() == []
    assert not bad(findings(*ring))


def test_a_tag_behind_another_is_hidden():
    """A small tag 20 mm behind a large one, and one beside it that peeps out."""
    found = findings(tag(0), tag(1, 0.05, (-0.18, 0.0, 0.25)))
    assert any(text.startswith("tag 1 is seen from no direction") for text in said(found, Level.error))
    assert not said(findings(tag(0), tag(1, 0.05, (-0.18, 0.2, 0.25))), Level.error)


def test_visibility_is_that_of_a_rendered_ring_of_tags():
    """Oracle: libapriltag on renders from every 15 degrees. Where it finds a tag, the tag is said to be seen."""
    body = coordinator.load_leader_body(str(shipped.path("leaders/three_faces.yaml")))
    around = look_all_round(body, distance_m=1.1, height_m=0.25)
    detector = TagDetector("tag36h11", config=TagDetectorConfig(decimation=1))
    seen_at_all = 0
    for azimuth_deg in range(0, 360, 15):
        a = math.radians(azimuth_deg)
        # The camera at (1.1 m, azimuth), 0.25 m high, looks at the leader's centre: x to its right, y down, z ahead.
        oMc = np.eye(4)
        oMc[:3, 0], oMc[:3, 1], oMc[:3, 2] = [-math.sin(a), math.cos(a), 0], [0, 0, -1], [-math.cos(a), -math.sin(a), 0]
        oMc[:3, 3] = [1.1 * math.cos(a), 1.1 * math.sin(a), 0.25]
        clean = sim.Imperfections(clutter=0.0, noise_sigma=1.0)
        image = sim.render_view(CAMERA, body, np.linalg.inv(oMc), imperfections=clean, seed=azimuth_deg)
        found = {tag.id for tag in detector.detect(image).tags}
        # A detector reads tags to a few degrees beyond the viewing angle up to which they are followed.
        seen = around.at(azimuth_deg - 4) | around.at(azimuth_deg) | around.at(azimuth_deg + 4)
        assert found <= {tag.id for tag, is_seen in zip(body.tags, seen, strict=True) if is_seen}
        seen_at_all += len(found)
    assert seen_at_all >= 20


@pytest.mark.parametrize("family", ["tag36h11", "tag16h5"])
@pytest.mark.parametrize("size_m", [0.06, 0.16])
def test_a_tag_is_followed_up_to_where_its_cells_are_too_small(family, size_m):
    """On renders: at 0.95 of that depth it is followed, at 1.1 of it no longer; at 0.9 of the other a detector finds
    it."""
    body = core.LeaderBody([tag(0, size_m, (0, 0, 0.25))], family=family)
    config = coordinator.load_coordinator(str(shipped.path("config/coordinator.yaml"))).coordinator.vision
    config.acquisition_range_m = 100.0
    (reach,) = tag_reach(body, Viewer(CAMERA, core.CameraMounting(position_m=[0, 0, 0.25]), config))
    tracker = TagTracker(camera=CAMERA, body=body)
    detector = TagDetector(family, config=TagDetectorConfig(decimation=1))

    def look(depth_m, seed):
        cMo = np.eye(4)
        cMo[:3, :3] = body.tags[0].oMt[:3, :3].T
        cMo[:3, 3] = np.array([0, 0, depth_m]) - cMo[:3, :3] @ [0, 0, 0.25]
        clean = sim.Imperfections(clutter=0.0, noise_sigma=1.0)
        image = sim.render_view(CAMERA, body, cMo, imperfections=clean, seed=seed)
        return isinstance(tracker.track(image, tracker.predict(0, cMo=cMo)), TagMeasurement), detector.detect(
            image
        ).tags

    for seed in range(3):
        assert look(0.95 * reach.followed_to_m, seed)[0]
        assert not look(1.1 * reach.followed_to_m, seed)[0]
        assert look(0.9 * reach.found_to_m, seed)[1]


def test_distances_are_between_the_turning_centres():
    """The camera sits 0.05 m ahead of its robot's centre and the tag 0.2 m behind the leader's: both add to the
    depth."""
    body = core.LeaderBody([tag(0)])
    near, far = (
        tag_reach(core.LeaderBody([each]), Viewer(CAMERA, core.CameraMounting(position_m=[x, 0, 0.25])))[0]
        for each, x in ((tag(0, position_m=(0, 0, 0.25)), 0.0), (body.tags[0], 0.05))
    )
    assert far.followed_to_m - near.followed_to_m == pytest.approx(0.25)
    assert far.found_to_m - near.found_to_m == pytest.approx(0.25)
    assert far.nearest_m - near.nearest_m == pytest.approx(0.25, abs=0.0051)  # it is known to 5 mm
    depth_m = min(CAMERA.fx, CAMERA.fy) * 0.16 / TagFamily("tag36h11").cells_at_border
    assert near.followed_to_m == pytest.approx(depth_m)
    assert near.found_to_m == pytest.approx(5.0)  # not beyond acquisition_range_m


def test_a_camera_that_looks_at_the_ceiling_sees_no_leader():
    mounting = core.CameraMounting(position_m=[0, 0, 0.25], tilt_rad=math.radians(80))
    found = findings(tag(0), viewer=Viewer(CAMERA, mounting))
    assert any("no tag fits into the picture within 5 m" in text for text in said(found, Level.error))

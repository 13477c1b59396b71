"""What a robot sees of another one; the rendered camera and the tag detector are the oracle."""

import math

import numpy as np
import pytest
from formation_files import formation, tree

from pilotfish import sim, vision
from pilotfish.formation import formations, load_formation
from pilotfish.formation.expand import load_expanded, tag_offsets
from pilotfish.formation.sight import bearing_range_rad, pose_at, sees, whole_tags


def ids_seen(shape, folder):
    """By robot: ids that the detector finds in its first rendered picture."""
    world = sim.World(sim.load_scenario(load_expanded(shape, folder).file))
    pictures = {robot: world.capture(robot).image for robot in shape.leaders}
    return {robot: {tag.id for tag in vision.TagDetector().detect(image).tags} for robot, image in pictures.items()}


@pytest.mark.parametrize("name", sorted(formations()))
def test_in_every_shipped_formation_the_rendered_camera_of_every_robot_shows_its_leader(name, tmp_path):
    shape = load_formation(formations()[name])
    offsets, seen = tag_offsets(shape), ids_seen(shape, tmp_path)
    for robot, watch in shape.stages[0].watches.items():
        expected = {tag.id + offsets[watch.leader] for tag in shape.outlook.body.tags}
        assert seen[robot] & expected, f"{robot} does not see {watch.leader}"


def test_in_a_column_the_robot_in_between_hides_the_leader_in_the_picture_too(tmp_path):
    shape = formation("column")
    assert ids_seen(shape, tmp_path)["robot2"] == {10, 11, 12}  # robot1's, and none of the leader's 0, 1, 2
    assert sees(shape.outlook, pose_at(2.0, 0.0))
    assert not sees(shape.outlook, pose_at(2.0, 0.0), [pose_at(1.0, 0.0)])


@pytest.mark.parametrize("side", [1, -1])
def test_beyond_the_edge_of_the_range_the_detector_finds_no_tag_and_within_it_it_does(side, tmp_path):
    """A tag is whole in the picture or not to 0.1 degrees; the detector needs the black square alone, whose edge lies
    one cell (20 mm at 1 m: 1.2 degrees) within the paper's."""
    outlook = formation("column").outlook
    right_rad, left_rad = bearing_range_rad(outlook, 1.0)
    edge_deg = math.degrees(left_rad if side > 0 else right_rad)
    inside = formation("tree", tree=tree(("leader", 1.0, edge_deg - 0.3 * side)))
    assert ids_seen(inside, tmp_path)["robot1"]
    # Refused as a formation, so the scenario is turned: the same robot looks past the leader.
    spec = sim.load_scenario(load_expanded(inside, tmp_path).file)
    robots = spec.robots
    start = robots[1].start
    turned = math.radians(-2.6 * side)
    robots[1].start = sim.Pose2(x_m=start.x_m, y_m=start.y_m, heading_rad=turned)
    spec.robots = robots
    picture = sim.World(spec).capture("robot1").image
    assert not vision.TagDetector().detect(picture).tags


def test_a_leader_seen_from_the_front_shows_no_tag():
    assert not sees(formation("column").outlook, pose_at(1.5, 0.0, math.pi))


def test_a_robot_beside_the_line_of_sight_hides_nothing_and_one_on_it_does():
    """The footprint is 0.46 m wide. Half way to a tag of 0.2 m (with its paper) the lines to its corners lie up to
    0.05 m beside the middle: a robot must be 0.28 m beside it, or more."""
    outlook = formation("column").outlook
    middle = {k for k in whole_tags(outlook, pose_at(2.0, 0.0)) if outlook.body.tags[k].id == 0}
    hidden = [not middle & set(whole_tags(outlook, pose_at(2.0, 0.0), [(0.95, y, 0.0)])) for y in (0.0, 0.25, 0.31)]
    assert hidden == [True, True, False]
    behind = [(3.0, 0.0, 0.0), (-1.0, 0.0, 0.0)]
    assert middle <= set(whole_tags(outlook, pose_at(2.0, 0.0), behind)), "behind the leader, or behind who looks"


def test_the_range_of_bearings_narrows_near_the_leader_and_never_exceeds_the_picture():
    """Half the picture is atan(320 / 600) = 28.1 degrees for the ideal lens; the simulated one is distorted a little.
    At 0.5 m, 0.25 m in front of the tag, the paper of 0.2 m is 43.6 degrees wide."""
    outlook = formation("column").outlook
    widths = [np.diff(bearing_range_rad(outlook, d))[0] for d in (0.5, 0.7, 1.0, 2.0, 4.0)]
    assert widths == sorted(widths)
    assert math.degrees(widths[-1]) == pytest.approx(2 * 28.1, abs=1.0)
    assert math.degrees(widths[0]) < 56.2 - 20.0

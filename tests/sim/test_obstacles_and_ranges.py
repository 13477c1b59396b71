"""Obstacles in a scenario: where they stand, what they hide, and what range sensors read of them."""

import math

import numpy as np
import pytest

from pilotfish import core, sim
from pilotfish import data as shipped
from pilotfish.errors import ConfigError

CONFIG = shipped.path("config/obstacles.yaml")


def scenario(**changes):
    spec = sim.load_scenario(shipped.path("scenarios/obstacles.yaml"))
    spec.obstacle_field = None
    for key, value in changes.items():
        setattr(spec, key, value)
    return spec


def with_robot(spec, **changes):
    leader, robot = spec.robots
    for key, value in changes.items():
        setattr(robot, key, value)
    spec.robots = [leader, robot]
    return spec


def cylinder(x_m, y_m, radius_m=0.2, height_m=1.0):
    return sim.Obstacle(x_m=x_m, y_m=y_m, radius_m=radius_m, height_m=height_m)


def exact(**changes):
    return sim.RangeSensors(noise_sigma_m=0.0, dropout=0.0, **changes)


def scan_at_origin(sensors, *obstacles):
    """What a robot reads that stands at the origin, alone but for the obstacles, and looks along x."""
    robot = sim.RobotSpec()
    robot.name, robot.range_sensors = "robot1", sensors
    spec = sim.Scenario(name="alone")
    spec.robots, spec.obstacles = [robot], list(obstacles)
    return sim.World(spec).ranges("robot1")


def test_a_ray_reads_the_distance_to_the_nearest_surface():
    # A cylinder at (2, 0) of 0.2 m is 1.8 m ahead; at (0, 1.5) 1.3 m to the left; behind there is nothing within 3 m.
    sensors = exact(count=4, first_rad=0.0, last_rad=1.5 * math.pi, cone_rad=0.0)
    scan = scan_at_origin(sensors, cylinder(2.0, 0.0), cylinder(0.0, 1.5))
    assert scan.ranges_m == pytest.approx([1.8, 1.3, 3.0, 3.0], abs=1e-6)


def test_a_cone_reads_the_nearest_point_within_it():
    # An oracle: of 2001 rays across the cone the shortest.
    random = np.random.default_rng(1)
    half_rad = math.radians(15.0)
    for _ in range(50):
        x_m, y_m = random.uniform(0.5, 2.0), random.uniform(-1.0, 1.0)
        radius_m, direction_rad = random.uniform(0.05, 0.4), random.uniform(-0.6, 0.6)
        sensors = exact(count=1, first_rad=direction_rad, last_rad=direction_rad, cone_rad=2 * half_rad)
        rays = direction_rad + np.linspace(-half_rad, half_rad, 2001)
        along = x_m * np.cos(rays) + y_m * np.sin(rays)
        across = np.abs(y_m * np.cos(rays) - x_m * np.sin(rays))
        met = (across < radius_m) & (along > 0.0)
        expected_m = np.min(along[met] - np.sqrt(radius_m**2 - across[met] ** 2), initial=3.0)
        # Two rays are 0.26 mrad apart. Where a ray only grazes the surface, depth changes with the root of the angle:
        # sqrt(2 R rho dphi) = sqrt(2 * 0.4 * 2.2 * 0.26e-3) = 0.02 m at most.
        scan = scan_at_origin(sensors, cylinder(x_m, y_m, radius_m))
        assert scan.ranges_m[0] == pytest.approx(expected_m, abs=0.03)


def test_readings_depend_on_seed_robot_and_time_alone():
    def run(seed):
        world = sim.World(scenario(seed=seed, obstacles=[cylinder(0.5, 0.5)]))
        seen = []
        for k in range(6):
            world.advance_to(k / 30)
            seen.append(world.ranges("robot1"))
        return seen

    assert run(3) == run(3)
    assert run(3) != run(4)
    # 20 rounds a second, at 30 exposures: two of three.
    assert [scan is not None for scan in run(3)] == [True, False, True, True, False, True]


def test_a_sensor_that_gives_no_reading_says_so():
    spec = with_robot(scenario(), range_sensors=sim.RangeSensors(dropout=1.0))
    scan = sim.World(spec).ranges("robot1")
    assert set(scan.ranges_m) == {-1.0}
    assert scan.usable


def test_clearance_is_from_outline_to_outline():
    # Robot and leader, of 0.25 m each, are 1.1 m apart: 0.6 m. An obstacle of 0.2 m at 0.65 m: 0.2 m.
    assert sim.World(scenario()).clearance_m("robot1") == pytest.approx(0.6, abs=1e-4)
    start = scenario().robot("robot1").start
    near = scenario(obstacles=[cylinder(start.x_m - 0.65, start.y_m)])
    assert sim.World(near).clearance_m("robot1") == pytest.approx(0.2)
    inside = scenario(obstacles=[cylinder(start.x_m - 0.40, start.y_m)])
    assert sim.World(inside).clearance_m("robot1") == pytest.approx(-0.05)


def test_an_obstacle_hides_the_leader_only_if_it_is_high_enough():
    # Camera and tags are 0.25 m above the ground: so is the line of sight.
    robot, leader = scenario().robot("robot1").start, scenario().robot("leader").start
    middle = ((robot.x_m + leader.x_m) / 2, (robot.y_m + leader.y_m) / 2)
    assert sim.World(scenario()).leader_in_sight("robot1")
    assert not sim.World(scenario(obstacles=[cylinder(*middle, 0.2, 0.26)])).leader_in_sight("robot1")
    assert sim.World(scenario(obstacles=[cylinder(*middle, 0.2, 0.24)])).leader_in_sight("robot1")
    assert sim.World(scenario(obstacles=[cylinder(middle[0], middle[1] + 0.8)])).leader_in_sight("robot1")


def test_what_is_drawn_hides_what_the_geometry_says():
    # The picture with and without the obstacle differ exactly where it hides the leader's tag: with it in the line of
    # sight the tracker finds no tag, beside it the same one.
    from pilotfish import coordinator

    robot, leader = scenario().robot("robot1").start, scenario().robot("leader").start
    middle = ((robot.x_m + leader.x_m) / 2, (robot.y_m + leader.y_m) / 2)
    for obstacle in (cylinder(*middle, 0.15, 0.5), cylinder(*middle, 0.15, 0.1), cylinder(middle[0], middle[1] - 0.6)):
        world = sim.World(scenario(obstacles=[obstacle]))
        driver = coordinator.Coordinator(
            coordinator.load_coordinator(shipped.path("config/obstacles.yaml")).coordinator
        )
        frame = world.capture("robot1")
        seen = driver.step(frame, frame.utime).observation is not None
        assert seen == world.leader_in_sight("robot1")


def test_a_field_is_the_same_for_the_same_seed_and_keeps_starts_and_paths_clear():
    field = sim.ObstacleField(count=30, x_min_m=-2, x_max_m=6, y_min_m=-2, y_max_m=2, clear_m=0.4, gap_m=0.1)
    first, again, other = (scenario(obstacle_field=field, seed=seed).all_obstacles() for seed in (1, 1, 2))
    assert first == again
    assert first != other
    assert len(first) == 30
    start = scenario().robot("robot1").start
    for each in first:
        # The leader drives 0.25 m/s for 40 s, along x from 0 to 10 m; its points are 12.5 mm apart.
        path_m = math.hypot(max(0.0, -each.x_m), each.y_m)
        assert path_m - each.radius_m > 0.4 - 1e-4
        assert math.hypot(each.x_m - start.x_m, each.y_m - start.y_m) - each.radius_m > 0.4
    gaps = [math.dist((a.x_m, a.y_m), (b.x_m, b.y_m)) - a.radius_m - b.radius_m for a in first for b in first if a != b]
    assert min(gaps) >= 0.1


def test_a_field_that_is_too_full_says_how_many_fit():
    field = sim.ObstacleField(count=500, x_min_m=1, x_max_m=2, y_min_m=1, y_max_m=2, gap_m=0.3)
    with pytest.raises(ConfigError, match=r"obstacle_field.count: 500 do not fit, but \d+;"):
        sim.World(scenario(obstacle_field=field))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("obstacles: [{x_m: 1.0}]", r"obstacles\[0\].y_m: is missing"),
        ("obstacles: [{x_m: 1.0, y_m: 2.0, radius_m: 0.0}]", r"obstacles\[0\].radius_m: 0 is outside \[0.01, 10\]"),
        ("obstacles: [{x_m: 1.0, y_m: 2.0, size_m: 1.0}]", r"obstacles\[0\].size_m: .*radius_m"),
        ("obstacle_field: {count: 3, x_min_m: 2, x_max_m: 1}", r"obstacle_field.x_max_m: 1.0* is below x_min_m"),
    ],
)
def test_a_mistake_in_a_file_is_named(tmp_path, text, message):
    file = tmp_path / "mine.yaml"
    file.write_text(f"like: {shipped.path('scenarios/obstacles.yaml')}\nname: mine\n{text}\n")
    with pytest.raises(ConfigError, match=message):
        sim.load_scenario(file)


def test_without_obstacles_nothing_changes():
    # A robot without sensors has no readings to give, and says so.
    world = sim.World(sim.load_scenario(shipped.path("scenarios/line.yaml")))
    assert world.obstacles == []
    with pytest.raises(IndexError, match="'robot1' has no range sensors"):
        world.ranges("robot1")


def test_a_scan_with_too_many_or_impossible_readings_is_not_usable():
    def scan(ranges_m, first_rad=0.0, step_rad=0.01):
        return core.RangeScan(utime=1, first_rad=first_rad, step_rad=step_rad, ranges_m=ranges_m)

    assert scan([1.0, -1.0, 100.0]).usable
    assert not scan([]).usable
    assert not scan([math.nan]).usable
    assert not scan([math.inf]).usable
    assert not scan([100.1]).usable
    assert not scan([1.0] * 700).usable  # 7 rad: more than once around
    assert not scan([1.0], first_rad=math.nan).usable
    with pytest.raises(ValueError, match="at most 1440 readings, got 1441"):
        scan([1.0] * 1441, step_rad=0.0)

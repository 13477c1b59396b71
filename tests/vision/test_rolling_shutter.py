"""A camera whose rows are exposed one after another, and a robot that turns: the tags' corners are taken back to one
instant if the calibration says how long the readout takes."""

import math

import numpy as np
import pytest

from pilotfish import coordinator, core, sim, vision
from pilotfish import data as shipped

READOUT_S = 0.03
RATE_HZ = 30


def scenario(readout_s):
    scenario = sim.load_scenario(shipped.path("scenarios/circle.yaml"))
    robots = scenario.robots
    camera = robots[1].camera
    imperfections = camera.imperfections
    imperfections.readout_s = readout_s
    camera.imperfections = imperfections
    robots[1].camera = camera
    scenario.robots = robots
    return scenario


def told(model, readout_s):
    names = ("width", "height", "fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
    return core.CameraModel(**{name: getattr(model, name) for name in names}, readout_s=readout_s)


def errors_of(readout_told_s, frames=60, first=0):
    """(N, 3): distance [m], bearing and heading [rad], measured less true, and (N, 3) the claimed standard deviations,
    of a robot that turns to and fro at 0.8 Hz,
    from frame `first` on."""
    world = sim.World(scenario(READOUT_S))
    leader, robot = world.scenario.robots
    camera = told(robot.camera.model, readout_told_s)
    observer = vision.LeaderObserver(camera=camera, mounting=robot.camera.mounting, body=leader.body.leader)
    off, claimed = [], []
    for k in range(frames):
        world.advance_to(k / RATE_HZ)
        turn = math.cos(2 * math.pi * 0.8 * k / RATE_HZ)
        world.command("robot1", core.Twist(linear_mps=0.2, angular_radps=turn), k / RATE_HZ)
        if k < first:
            continue
        seen = observer.observe(world.capture("robot1")).observation
        assert seen is not None
        distance_m, bearing_rad, heading_rad = world.true_relative_pose("robot1")
        measured = seen.measured
        angles = np.exp(1j * (np.array([measured.bearing_rad, measured.heading_rad]) - [bearing_rad, heading_rad]))
        off.append([measured.distance_m - distance_m, *np.angle(angles)])
        claimed.append(np.sqrt(np.diag(measured.covariance)))
    return np.array(off), np.array(claimed)


def test_the_pose_is_right_if_the_calibration_says_how_long_the_readout_takes():
    # A tag of 100 px is exposed within 100 / 480 of 30 ms, 6 ms, in which a turn of 1 rad/s moves it by 4 px: it is
    # skewed, and taken for another distance and heading.
    without, _ = errors_of(0.0)
    with_it, claimed = errors_of(READOUT_S)
    rms, untold = (np.sqrt(np.mean(off[2:] ** 2, axis=0)) for off in (with_it, without))
    assert rms[0] < untold[0] / 5
    assert rms[2] < untold[2] / 2
    # The claimed errors of distance and heading hold: 5 standard deviations in none of 58 frames.
    assert np.all(np.abs(with_it[2:, [0, 2]]) < 5 * claimed[2:, [0, 2]])


def test_the_first_picture_of_a_leader_claims_no_more_than_it_knows():
    # Nothing is known of its motion yet, so the skew stays; the covariance allows for it.
    for first in (1, 10, 20, 30):
        off, claimed = errors_of(READOUT_S, first + 1, first)
        assert np.all(np.abs(off) < 5 * claimed)
        off, claimed = errors_of(0.0, first + 1, first)
        assert first == 1 or np.any(np.abs(off) > 10 * claimed)  # at 1 it hardly turns yet


def test_each_row_shows_the_world_of_its_own_time():
    # The oracle: whole pictures of a camera that exposes all rows at once, at the time of a band of eight rows. Bands
    # are exposed readout (middle row / height - 1/2) after the frame's time, on which noise and frame number depend.
    rolling = sim.World(scenario(READOUT_S))
    rolling.command("robot1", core.Twist(linear_mps=0.0, angular_radps=1.0), 0.0)
    rolling.advance_to(0.5)
    picture = rolling.capture("robot1").image.astype(int)
    height = picture.shape[0]
    for first in (120, 240, 328):
        middle_s = READOUT_S * ((first + 4) / height - 0.5)
        at_once = sim.World(scenario(0.0))
        at_once.command("robot1", core.Twist(linear_mps=0.0, angular_radps=1.0), 0.0)
        at_once.advance_to(0.5 + middle_s)
        rows = at_once.capture("robot1").image.astype(int)[first + 2 : first + 6]
        same = np.abs(rows - picture[first + 2 : first + 6])
        other = np.abs(rows - np.roll(picture, 3, axis=1)[first + 2 : first + 6])  # what a skew of 3 px would be
        assert same.mean() < 0.5 * other.mean()
        assert same.mean() < 5.0  # two pictures' noise of 3 gray levels: sqrt(2) 3 sqrt(2 / pi) = 3.4


@pytest.mark.parametrize("readout", [-0.001, 0.11, math.nan])
def test_a_readout_that_no_camera_has_is_refused(readout):
    with pytest.raises(ValueError, match="readout_s"):
        told(sim.load_scenario(shipped.path("scenarios/circle.yaml")).robots[1].camera.model, readout)


def test_a_calibration_file_may_say_it(tmp_path):
    text = shipped.path("calibrations/sim_640x480.yaml").read_text()
    (tmp_path / "camera.yaml").write_text(text + "\nreadout_s: 0.021\n")
    assert coordinator.load_calibration(str(tmp_path / "camera.yaml")).readout_s == 0.021
    (tmp_path / "camera.yaml").write_text(text + "\nreadout_s: 0.5\n")
    with pytest.raises(ValueError, match=r"readout_s.*0.*0\.1"):
        coordinator.load_calibration(str(tmp_path / "camera.yaml"))

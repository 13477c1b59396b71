"""A bearing that stays, a leader that hangs or floats, a distance that swings: on messages made here, without a bus."""

import dataclasses
import math

import numpy as np
import pytest

from pilotfish import core, data
from pilotfish.cli.following_report import figures
from pilotfish.doctor import following
from pilotfish.doctor.following.base_here import BaseHere, driver_of, find_base
from pilotfish.doctor.following.setup import Process, load_setup
from pilotfish.doctor.following.swing import Swing, swing, turning_points
from pilotfish.doctor.following.watch import Watched
from pilotfish.lcmtypes.pilotfish import base_t, command_t, counter_t, observation_t, status_t
from pilotfish.robot_folder import create
from pilotfish.watching import Kind, Message

SECONDS, RATE_HZ = 10.0, 10
WANTED_M, WANTED_DEG = 1.1, -10.0
SETUP = load_setup(data.path("config/line.yaml"))


def rolled(roll_deg, tilt_deg=0.0, pan_deg=0.0):
    """The setup with a camera that is said to sit otherwise."""
    mounting = core.CameraMounting()
    mounting.position_m = SETUP.mounting.position_m
    mounting.roll_rad, mounting.tilt_rad, mounting.pan_rad = map(math.radians, (roll_deg, tilt_deg, pan_deg))
    return dataclasses.replace(SETUP, mounting=mounting)


def watch(
    error_m=lambda t: 0.0,
    bearing_deg=lambda t: WANTED_DEG,
    true=SETUP,
    turn_radps=0.0,
    outside=0,
    status=core.Status.tracking,
    **more,
):
    """A robot that has one status, of SECONDS; ``true``: how its camera really sits."""
    number, running = int(status), status is not core.Status.stopped
    watched = Watched("robot1", SECONDS, start_s=0.0)
    camera_from_base = np.linalg.inv(np.array(true.mounting.bMc))
    for k in range(int(SECONDS * RATE_HZ)):
        time_s = k / RATE_HZ
        status = status_t()
        status.status, status.session, status.setpoint_run = number, 7, running
        status.setpoint_distance_m, status.setpoint_bearing_rad = WANTED_M, math.radians(WANTED_DEG)
        status.error_m, status.utime = error_m(time_s), k + 1
        counter = counter_t()
        counter.name, counter.count = "tag_outside_frame", outside * k
        status.rejected = [counter]
        command = command_t()
        command.session, command.status = 7, number
        command.linear_mps, command.angular_radps = -error_m(time_s), turn_radps
        seen = observation_t()
        bearing_rad = math.radians(bearing_deg(time_s))
        seen.detected, seen.bearing_rad, seen.distance_m = True, bearing_rad, WANTED_M - error_m(time_s)
        bMo = np.eye(4)  # upright, on the floor, heading as the robot does
        bMo[:2, 3] = seen.distance_m * math.cos(bearing_rad), seen.distance_m * math.sin(bearing_rad)
        seen.camera_from_leader = (camera_from_base @ bMo)[:3].tolist()
        for kind, message in ((Kind.status, status), (Kind.command, command), (Kind.observation, seen)):
            watched.add(Message(time_s, "", "robot1", kind, message))
        if "base" in more:
            watched.add(Message(time_s, "", more["base"].robot, Kind.base, more["base"].value))
    return watched


def judged(watched, setup=SETUP, **more):
    return following.judge(watched, "memq://", setup, **more)


def names(diagnosis):
    assert all(cause.what and cause.do for cause in (*diagnosis.causes, *diagnosis.notes))
    return [cause.name for cause in diagnosis.causes]


# --- bearing ----------------------------------------------------------------------------------------------------------
def test_a_bearing_that_is_kept_is_following():
    assert judged(watch()).follows


def test_a_bearing_on_its_way_is_following():
    """From 60 degrees off to 30 within the watch: not there yet, and nearer."""
    assert judged(watch(bearing_deg=lambda t: WANTED_DEG + 60.0 * (1.0 - 0.5 * t / SECONDS))).follows


def test_the_papers_steady_bearing_error_is_following():
    """6.1 degrees on a circle (README)."""
    assert judged(watch(bearing_deg=lambda t: WANTED_DEG + 6.1)).follows


def test_a_camera_that_is_said_to_look_elsewhere_is_named_with_both_bearings():
    """61.5 degrees where -10 are wanted, distance error 0: what a pan of 90 degrees leads to. The picture is 640 px
    wide at f = 600 px: atan(320 / 600) = 28 degrees to either side of 90."""
    diagnosis = judged(watch(bearing_deg=lambda t: 61.5), rolled(0.0, pan_deg=90.0))
    assert names(diagnosis) == ["mounting"]
    what = diagnosis.causes[0].what
    assert "at a bearing of 62 degrees where -10 are wanted" in what or "at a bearing of 61 degrees" in what
    assert "the camera's mounting (pan_deg) does not agree" in what
    assert "covers bearings from 62 to 119 degrees" in what or "covers bearings from 61 to 118 degrees" in what


def test_without_a_configuration_tags_at_the_edge_of_the_picture_say_that_it_turns_no_further():
    diagnosis = judged(watch(bearing_deg=lambda t: 61.5, outside=3), None)
    assert names(diagnosis) == ["mounting"]
    assert "297 times" in diagnosis.causes[0].what  # 3 in each of the 99 steps between 100 reports


def test_a_robot_that_commands_a_turn_and_does_not_turn_is_told_to_be_lifted():
    diagnosis = judged(watch(bearing_deg=lambda t: 10.0, turn_radps=0.5))
    assert names(diagnosis) == ["bearing_error"]
    assert "29 degrees/s" in diagnosis.causes[0].what and "which way" in diagnosis.causes[0].do
    assert names(judged(watch(bearing_deg=lambda t: 10.0))) == ["bearing_error"]


# --- how the leader stands --------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("true", "said"), [(180.0, 0.0), (0.0, 180.0)])
def test_a_camera_upside_down_is_told_whichever_of_the_two_is_turned(true, said):
    diagnosis = judged(watch(true=rolled(true)), rolled(said))
    assert names(diagnosis)[0] == "camera_upside_down"
    assert "180 degrees from upright" in diagnosis.causes[0].what


def test_a_camera_that_hangs_upside_down_and_is_said_to_is_no_fault():
    assert judged(watch(true=rolled(180.0)), rolled(180.0)).follows


def test_without_a_configuration_upside_down_is_a_note_where_it_follows_and_a_cause_where_it_does_not():
    """A camera that hangs upside down and is said to looks the same from here, and follows."""
    good = judged(watch(true=rolled(180.0)), None)
    (note,) = [note for note in good.notes if note.name == "camera_upside_down"]
    assert good.follows and "if it is mounted without roll" in note.what
    assert names(judged(watch(true=rolled(180.0), status=core.Status.stopped), None)) == [
        "stopped",
        "camera_upside_down",
    ]


def test_a_camera_upside_down_hides_no_other_cause():
    far = judged(watch(true=rolled(180.0), error_m=lambda t: -0.8), None)
    assert names(far) == ["camera_upside_down", "distance_error"]


def test_a_picture_on_its_side_leans_by_a_right_angle():
    diagnosis = judged(watch(true=rolled(90.0)))
    assert names(diagnosis) == ["mounting"]
    assert "leaning by 90 degrees" in diagnosis.causes[0].what


def test_a_wrong_tilt_puts_the_leader_off_the_floor():
    """Tilted up by 20 degrees and said to be level: at 1.1 m the leader seems 1.05 m * sin 20 deg = 0.36 m lower, and
    it leans by 20 degrees, which a far tag may, too. Level and said to be tilted: as much higher. Heights that are all
    wrong by the same do not keep it from following."""
    for true, told, where in ((20.0, 0.0, "below"), (0.0, 20.0, "above")):
        good = judged(watch(true=rolled(0.0, tilt_deg=true)), rolled(0.0, tilt_deg=told))
        (note,) = [note for note in good.notes if note.name == "mounting"]
        assert good.follows and f"{where} the floor" in note.what and "tilt_deg" in note.what
    far = judged(watch(true=rolled(0.0, tilt_deg=20.0), error_m=lambda t: -0.8))
    assert names(far) == ["distance_error", "mounting"]


def test_a_tilt_that_is_off_by_little_is_not_told():
    assert "mounting" not in [note.name for note in judged(watch(true=rolled(0.0, tilt_deg=5.0))).notes]


# --- swinging ---------------------------------------------------------------------------------------------------------
def test_turning_points_are_the_extremes_of_what_swings_by_enough():
    assert turning_points([0, 1, 3, 2, 3, -2, 0, 4], 2) == [0, 2, 5, 7]  # the 2 between two 3s is no turn
    assert turning_points([0, 1, 0, 1], 2) == [0]
    assert turning_points([], 1) == []


def test_a_distance_that_swings_about_the_wanted_one_does_not_follow():
    """-157 to +243 mm, a period of 5 s: what wheels with weak brakes did. v = -error here: -0.24 to +0.16 m/s."""
    diagnosis = judged(watch(error_m=lambda t: 0.043 + 0.2 * math.sin(2 * math.pi * t / 5.0)))
    assert names(diagnosis) == ["swings"]
    assert "from 157 mm too far to 243 mm too close" in diagnosis.causes[0].what
    assert "-0.24 to +0.16 m/s" in diagnosis.causes[0].what


def test_the_vibration_of_a_good_robot_is_no_swing():
    """17 mm RMS is 24 mm of amplitude: ViSP's servo on non-ideal wheels (README)."""
    assert judged(watch(error_m=lambda t: 0.024 * math.sin(2 * math.pi * t / 3.0))).follows


def test_a_leader_that_stops_and_goes_behind_the_papers_law_is_followed():
    """It is 0.167 m too far while the leader drives and 0 while it stands: never too close."""
    assert judged(watch(error_m=lambda t: -0.167 * (round(t / 2.5) % 2))).follows


def test_a_swing_that_ended_before_the_second_half_is_over():
    assert judged(watch(error_m=lambda t: 0.3 * math.sin(2 * math.pi * t / 2.0) if t < 4.0 else 0.0)).follows


def test_an_overshoot_by_more_than_a_swing_is_told():
    """From 0.8 m too far to 0.3 m too close in the second half, and back to 0."""
    diagnosis = judged(watch(error_m=lambda t: min(-0.8 + 0.16 * t, 0.3, max(0.0, 0.3 - 0.3 * (t - 8.0)))))
    assert names(diagnosis) == ["overshoots"]
    assert "0.30 m too close" in diagnosis.causes[0].what


def test_an_approach_from_afar_is_no_swing():
    assert swing([(t, -2.0 + 0.2 * t) for t in range(10)], 1.0, 5.0) == Swing(-1.0, pytest.approx(-0.2), 0, 0.0)


# --- the wheels' configuration ----------------------------------------------------------------------------------------
def test_limits_below_the_coordinators_explain_a_swing_and_are_a_note_where_it_follows(tmp_path):
    create("robot1", tmp_path / "robot1")
    file = tmp_path / "robot1" / "base.yaml"
    file.write_text(file.read_text().replace("brake_mps2: 3.0", "brake_mps2: 0.3"))
    setup = load_setup(tmp_path / "robot1" / "robot1.yaml")
    base_here = find_base("robot1", "memq://", [], setup)
    swinging = judged(watch(error_m=lambda t: 0.2 * math.sin(2 * math.pi * t / 5.0)), base_here=base_here)
    assert names(swinging) == ["base_limits", "swings"]
    assert "limits.brake_mps2 0.3 < control.limits.max_linear_acceleration_mps2 1" in swinging.causes[0].what
    good = judged(watch(), base_here=base_here)
    assert good.follows and "base_limits" in [note.name for note in good.notes]


def test_a_running_base_says_its_driver_by_its_command_line_and_else_by_its_file(tmp_path):
    url = "udpm://239.255.76.67:7701?ttl=0"
    words = ("pilotfish-base", "--config", str(data.path("config/base.yaml")), "--lcm-url", url)
    assert driver_of(data.path("config/base.yaml")) == "dry_run"
    assert find_base("robot1", url, [Process(1, words, tmp_path)], None).driver == "dry_run"
    simulated = Process(1, (*words, "--driver", "simulator"), tmp_path)
    assert find_base("robot1", url, [simulated], None).driver == "simulator"
    assert find_base("robot2", url, [simulated], None) is None


def test_wheels_that_say_that_they_drive_and_are_a_dry_run_are_told(tmp_path):
    """0.8 m too far for 10 s at 0.8 m/s: nothing moves."""
    diagnosis = judged(watch(error_m=lambda t: -0.8), base_here=BaseHere(tmp_path / "base.yaml", "dry_run"))
    assert names(diagnosis) == ["dry_run", "distance_error"]


def test_where_only_another_robots_wheels_are_on_the_bus_they_are_named():
    message = base_t()
    message.session, message.state = 3, 0
    other = Message(0.0, "ROBOT2_BASE", "robot2", Kind.base, message)
    diagnosis = judged(watch(error_m=lambda t: -0.8, base=other))
    assert "no pilotfish-base of robot1 is on the bus, but one of robot2 is there" in diagnosis.causes[0].what
    (note,) = [note for note in diagnosis.notes if note.name == "no_base"]
    assert "one of robot2 is there" in note.what and "name: robot1" in note.do


def test_the_figures_show_the_bearing_how_far_it_swings_and_which_driver_turns_the_wheels():
    message = base_t()
    message.session, message.state, message.text = 3, 1, "driving"
    own = Message(0.0, "ROBOT1_BASE", "robot1", Kind.base, message)
    seen = judged(watch(error_m=lambda t: 0.043 + 0.2 * math.sin(2 * math.pi * t / 5.0), base=own)).evidence
    rows = dict(figures(seen, "dry_run"))
    assert rows["bearing"] == "-10.0 deg at first, -10.0 deg at last (wanted -10.0 deg)"
    assert "between 157 mm too far and 243 mm too close (wanted 1.10 m)" in rows["distance error"]
    assert "from -0.24 to 0.16 m/s" in rows["commanded"]
    assert rows["wheels"] == "driving (driver dry_run: no wheels turn)"

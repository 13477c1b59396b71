"""A robot's messages, without a server: kept as bytes until somebody watches, then decoded in their order."""

from __future__ import annotations

import asyncio
import json
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from pilotfish import core, data
from pilotfish.lcmtypes.bot_core import image_metadata_t
from pilotfish.lcmtypes.pilotfish import command_t
from pilotfish.view import messages, pictures, robot_feed
from pilotfish.view.dead_reckoning import PlanarPose
from pilotfish.view.robot_feed import RobotFeed
from pilotfish.view.samples import COLUMNS, Samples
from pilotfish.view.setup import default_setup, load_setup
from robot_on_bus import base, command, gray_image, observation, picture, status, with_lists

SETUP = load_setup(data.path("config/line.yaml"))


def feed_with(*sent, watched=True):
    """A feed that has received (kind, message) one after the other, 50 ms apart."""
    feed, news = RobotFeed("robot1", SETUP), []
    if watched:
        feed.watch(news.append)
    for k, (kind, message) in enumerate(sent):
        feed.take(kind, message if isinstance(message, bytes) else message.encode(), 100.0 + 0.05 * k)
    return feed, news


def state_of(feed, now_s=101.0):
    state, _ = feed.state(0, now_s)
    json.dumps(state, allow_nan=False)  # as it is sent
    return state


def test_nothing_is_decoded_or_encoded_while_nobody_watches(monkeypatch):
    calls = []
    for name, real in (("decode", messages.decode), ("picture_of", pictures.picture_of)):
        monkeypatch.setattr(robot_feed, name, lambda *a, name=name, real=real: calls.append(name) or real(*a))
    sent = [("STATUS", status()), ("OBSERVATION", observation()), ("COMMAND", command())] * 30
    feed, _ = feed_with(*sent, ("PREVIEW", picture(gray_image())), watched=False)
    assert calls == []
    assert not feed.wants("PREVIEW")
    assert not feed.wants("IMAGE")
    feed.watch(lambda _: None)
    assert set(calls) == {"decode"}
    # 90 messages in 4.5 s; every command counts for the path, of the others ten a second are looked at: 30 + 2 x 30
    # would be all. One status comes every 150 ms, so none of them is left out.
    assert len(calls) == 90
    assert state_of(feed)["observation"]["distance_m"] == 1.35


def test_who_comes_later_gets_the_last_minute_and_no_more():
    feed = RobotFeed("robot1", SETUP)
    for k in range(1800):  # 90 s at 20 Hz
        feed.take("COMMAND", command(linear_mps=0.2, angular_radps=0.0).encode(), 100.0 + 0.05 * k)
    feed.watch(lambda _: None)
    _, rows = feed._samples.since(0)
    times = [row[0] for row in rows]
    assert 59.0 < times[-1] - times[0] <= 60.0
    # 0.2 m/s straight ahead: x grows by 0.02 m from each sample to the next, 0.1 s later.
    x = [row[COLUMNS.index("x_m")] for row in rows]
    assert x[-1] - x[0] == pytest.approx(0.2 * (times[-1] - times[0]), abs=1e-3)


def test_values_that_are_not_finite_become_none():
    odd = observation(heading_rad=math.nan, camera_from_leader=[[math.nan] * 4] * 3)
    odd.covariance = [[-1.0, 0, 0], [0, math.inf, 0], [0, 0, 4.0]]
    feed, _ = feed_with(
        ("OBSERVATION", odd), ("COMMAND", command(linear_mps=math.nan)), ("STATUS", status(error_m=-math.inf))
    )
    state = state_of(feed)
    assert state["observation"]["heading_rad"] is None
    assert state["observation"]["camera_from_leader"] is None
    assert state["observation"]["sigma"] == [None, None, 2.0]
    assert state["command"]["linear_mps"] is None
    assert state["status"]["error_m"] is None


@settings(max_examples=150, deadline=None)
@given(
    kind=st.sampled_from(["STATUS", "OBSERVATION", "COMMAND", "BASE", "PREVIEW", "IMAGE"]),
    cut=st.integers(0, 400),
    noise=st.binary(max_size=300),
)
def test_any_bytes_leave_a_feed_that_can_be_sent(kind, cut, noise):
    """Real messages, cut off and continued with noise; and noise alone."""
    whole = {
        "STATUS": with_lists(status(), counters={"pose": 1}),
        "OBSERVATION": observation(),
        "COMMAND": command(),
        "BASE": base(),
    }.get(kind, picture(gray_image(8, 8), jpeg=False))
    feed, _ = feed_with(
        (kind, noise), (kind, whole.encode()[:cut] + noise), ("COMMAND", command()), ("STATUS", status())
    )
    feed.picture()
    assert state_of(feed)["command"]["linear_mps"] == pytest.approx(0.321) or kind == "COMMAND"


def test_a_reason_is_said_with_the_numbers_that_the_coordinator_gives():
    said = "lost: no tag of the leader's body in the picture (saw id 20, 21, the leader has 0, 1, 2)"
    feed, _ = feed_with(("STATUS", status(status=3, reason=2, text=said)))
    words = state_of(feed)["words"]
    assert words["why"] == said.removeprefix("lost: ")
    assert "the body has ids 0 to 2" not in words["lines"]  # it is said once


def test_a_preview_that_is_smaller_than_the_cameras_picture_says_how_much():
    message = picture(gray_image(320, 240))
    extra = image_metadata_t()
    extra.key, extra.value, extra.n = "pilotfish_shrink", b"4", 1
    message.metadata, message.nmetadata = [extra], 1
    made = pictures.picture_of(message.encode())
    assert (made.width, made.height, made.source_width, made.source_height) == (320, 240, 1280, 960)
    for nonsense in (b"0", b"-2", b"1e3", b"", b"\xff", b"99999"):
        extra.value, extra.n = nonsense, len(nonsense)
        assert pictures.picture_of(message.encode()).source_width == 320


def test_zeros_for_want_of_a_picture_are_counted_for_a_minute():
    """Followed, 2 zeros, followed, 1 zero, and a stop: two gaps. The first is at 100.05 s."""
    lost = command(status=command_t.STATUS_LOST, reason=int(core.Reason.no_frame), linear_mps=0.0)
    stopped = command(status=command_t.STATUS_STOPPED, reason=int(core.Reason.stop_requested))
    sent = [command(), lost, lost, command(), lost, stopped, lost]
    feed, _ = feed_with(*(("COMMAND", one) for one in sent))
    assert state_of(feed)["zeros_without_picture"] == 2
    assert state_of(feed, 160.1)["zeros_without_picture"] == 1
    assert state_of(feed, 170.0)["zeros_without_picture"] == 0


def test_counters_that_take_turns_are_kept_until_the_session_ends():
    first = with_lists(status(), counters={"pose": 3, "tag_margin": 9})
    second = with_lists(status(), counters={"pose": 4, "frames_stale": 1})
    feed, _ = feed_with(("STATUS", first), ("STATUS", second))
    assert state_of(feed)["rejected"] == {"pose": 4, "tag_margin": 9, "frames_stale": 1}
    feed.take("STATUS", with_lists(status(session=5), counters={"pose": 1}).encode(), 101.0)
    assert state_of(feed)["rejected"] == {"pose": 1}


def test_a_counter_that_rises_is_said_in_words():
    lost = {"status": 3, "reason": 2}  # no_tag_of_the_leader
    seen_nothing = observation(tags=0, detected=False, reason=2)
    feed = RobotFeed("robot1", SETUP)
    feed.watch(lambda _: None)
    for k in range(21):  # 2 s; 3 more every 0.1 s
        feed.take("OBSERVATION", seen_nothing.encode(), 100 + 0.1 * k)
        feed.take("STATUS", with_lists(status(**lost), counters={"tag_foreign_id": 3 * k}).encode(), 100 + 0.1 * k)
    said = state_of(feed, 102.0)["words"]
    assert said["headline"] == "Lost: standing still"
    assert said["why"] == "no tag of the leader's body in the picture"
    assert "the body has ids 0 to 2" in said["lines"]
    assert "in the last second: 30 x tags the leader does not wear" in said["lines"]


def test_the_axes_are_where_the_calibration_projects_them():
    feed, _ = feed_with(("OBSERVATION", observation()), ("PREVIEW", picture(gray_image())))
    axes = feed.overlay(observation().utime)["axes_px"]
    camera = SETUP.camera
    # cMo of robot_on_bus: the leader's origin is at (0.29, 0.2, 1.3) in the camera's frame. Its x axis points along the
    # camera's z, y along -x, z along -y, each 0.15 m long.
    ends = [(0.29, 0.2, 1.3), (0.29, 0.2, 1.45), (0.14, 0.2, 1.3), (0.29, 0.05, 1.3)]
    assert axes == [pytest.approx(list(camera.project(point)), abs=0.01) for point in ends]


def test_a_frame_that_did_not_arrive_leaves_the_outlines_of_the_one_before():
    """Its observation repeats the utime of the last frame."""
    missing = observation(tags=0, detected=False, reason=int(core.Reason.no_frame))
    feed, _ = feed_with(("OBSERVATION", observation()), ("OBSERVATION", missing))
    assert feed.overlay(observation().utime)["tags"]
    assert not state_of(feed)["observation"]["detected"]


def test_without_a_calibration_there_are_tags_but_no_axes():
    feed = RobotFeed("robot1", default_setup())
    feed.watch(lambda _: None)
    feed.take("OBSERVATION", observation(tags=12).encode(), 1.0)
    overlay = feed.overlay(observation().utime)
    assert overlay["axes_px"] is None
    assert [tag["id"] for tag in overlay["tags"]] == list(range(12))


def test_the_cameras_own_pictures_are_taken_only_where_there_is_no_preview():
    feed, _ = feed_with(("COMMAND", command()))
    assert feed.wants("IMAGE")
    feed.take("PREVIEW", picture(gray_image()).encode(), 100.1)
    assert not feed.wants("IMAGE")
    feed.take("COMMAND", command().encode(), 101.5)
    assert feed.wants("IMAGE")


def test_a_raw_picture_becomes_a_jpeg_of_the_same_pixels_and_a_jpeg_stays_as_it_is():
    import io

    import numpy as np
    from PIL import Image

    image = gray_image(64, 48)
    made = pictures.picture_of(picture(image, jpeg=False).encode())
    assert (made.width, made.height, made.source_width) == (64, 48, 64)
    decoded = np.asarray(Image.open(io.BytesIO(made.jpeg)))
    assert np.abs(decoded.astype(int) - image).max() <= 3  # quality 80, a gradient
    jpeg = picture(image)
    assert pictures.picture_of(jpeg.encode()).jpeg == jpeg.data


@pytest.mark.parametrize(
    "change",
    [{"width": 0}, {"height": -1}, {"width": 9000}, {"row_stride": 3}, {"height": 49}, {"pixelformat": 42}],
)
def test_a_picture_that_lies_about_itself_is_refused(change):
    message = picture(gray_image(64, 48), jpeg=False)
    for name, value in change.items():
        setattr(message, name, value)
    with pytest.raises(messages.MalformedError):
        pictures.picture_of(message.encode())


def test_a_circle_closes():
    """v = omega r: after 2 pi / omega a robot is where it was, whatever the step."""
    pose, steps = PlanarPose(), 90
    omega = 0.5
    for _ in range(steps):
        pose = pose.moved(0.2, omega, 2 * math.pi / omega / steps)
    # 12.57 s / 90 = 0.14 s, below MAX_STEP_S; the arc formula is exact
    assert math.hypot(pose.x_m, pose.y_m) == pytest.approx(0.0, abs=1e-12)
    assert pose.heading_rad == pytest.approx(2 * math.pi)


def test_a_quarter_of_a_circle_to_the_left_ends_as_far_ahead_as_to_the_left():
    pose = PlanarPose()
    for _ in range(30):  # r = v / omega = 0.4 m; 90 degrees in pi s
        pose = pose.moved(0.2, 0.5, math.pi / 30)
    assert (pose.x_m, pose.y_m, pose.heading_rad) == pytest.approx((0.4, 0.4, math.pi / 2))
    assert pose.point_at(1.0, -math.pi / 2) == pytest.approx((1.4, 0.4))  # to its right is along x


def test_twists_that_no_robot_can_do_move_nothing():
    assert PlanarPose().moved(1e300, 0.0, 0.1) == PlanarPose()
    assert PlanarPose().moved(0.1, 1e300, 0.1) == PlanarPose()


def test_a_gap_in_time_is_a_row_without_values():
    samples = Samples()
    for time_s in (0.0, 0.1, 5.0):
        samples.add(time_s, [1.0] * (len(COLUMNS) - 1))
    _, rows = samples.since(0)
    assert [row[0] for row in rows] == pytest.approx([0.0, 0.1, 0.2, 5.0])
    assert rows[2][1:] == (None,) * (len(COLUMNS) - 1)


def test_a_page_gets_each_sample_once():
    samples, got, at = Samples(), [], 0
    for k in range(50):
        samples.add(0.1 * k, [float(k)] * (len(COLUMNS) - 1))
        if k % 7 == 0:
            at, rows = samples.since(at)
            got += rows
    at, rows = samples.since(at)
    assert [row[1] for row in got + rows] == list(range(50))
    assert samples.since(at)[1] == []


def test_a_robot_whose_coordinator_runs_here_has_its_own_configuration_and_others_the_default(tmp_path):
    """By command lines, as /proc has them; on another bus the same name is another robot."""
    from pilotfish import data
    from pilotfish.doctor.following.setup import Process, setups_here
    from pilotfish.view.hub import BusHub
    from pilotfish.view.setup import default_setup, load_setup

    url, config = "udpm://239.255.76.67:7711?ttl=0", str(data.path("config/line.yaml"))
    words = ("pilotfish-coordinator", "--config", config, "--lcm-url")
    here, elsewhere = Process(1, (*words, url), tmp_path), Process(2, (*words, url.replace("11?", "12?")), tmp_path)
    assert {name: str(setup.file) for name, setup in setups_here(url, [here]).items()} == {"robot1": config}
    assert setups_here(url, [elsewhere]) == {}
    loop = asyncio.new_event_loop()
    for robot, is_known in (("Robot1", True), ("robot2", False)):
        hub = BusHub(url, robot, default_setup(), {"robot1": load_setup(config)})
        hub.start(loop)
        assert (hub.feeds[robot].setup.camera is not None) == is_known
        hub.stop(loop)
    loop.close()

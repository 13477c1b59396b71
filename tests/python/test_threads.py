"""One object serves one thread. Who forgets it reads so; nothing is corrupted and the process lives."""

import threading

import numpy as np
import pytest

from pilotfish import capture, control, coordinator, core, data, fuzzy, sim, vision

SIZE = (240, 320)
CAMERA = core.CameraModel(width=SIZE[1], height=SIZE[0], fx=300, fy=300, cx=160, cy=120)
NOISE = np.random.default_rng(0).integers(0, 255, SIZE, dtype=np.uint8)
FRAME = core.Frame(NOISE, utime=1)


def detector():
    made = vision.TagDetector()
    return lambda: made.detect(NOISE)


def observer():
    made = vision.LeaderObserver(camera=CAMERA, body=core.LeaderBody(tags=[core.BodyTag(id=0)]))
    return lambda: made.observe(FRAME)


def coordinator_step():
    config = coordinator.load_coordinator(data.path("config/line.yaml")).coordinator
    made = coordinator.Coordinator(config)
    picture = core.Frame(np.resize(NOISE, (config.camera.height, config.camera.width)), utime=1)
    return lambda: made.step(picture, 1)


def world():
    made = sim.World(sim.load_scenario(data.path("scenarios/line.yaml")))
    return lambda: made.capture("robot1")


def in_three_threads(calls):
    """What the calls of each thread came to: None or the exception."""
    begin, ends = threading.Barrier(3), []

    def run(call):
        begin.wait()
        for _ in range(20):
            try:
                call()
                ends.append(None)
            except RuntimeError as error:
                ends.append(error)

    threads = [threading.Thread(target=run, args=(call,)) for call in calls]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return ends


@pytest.mark.parametrize("make", [detector, observer, coordinator_step, world])
def test_an_object_shared_by_threads_says_so_instead_of_crashing(make):
    ends = in_three_threads([make()] * 3)
    assert len(ends) == 60
    assert None in ends  # whoever came first was served
    for error in ends:
        assert error is None or "is in use by another call: one object serves one thread" in str(error)


@pytest.mark.parametrize("make", [detector, observer, coordinator_step, world])
def test_objects_of_their_own_serve_each_thread(make):
    assert in_three_threads([make() for _ in range(3)]) == [None] * 60


def law_that_calls(call):
    class Law:
        def __init__(self, parameters, limits):
            pass

        def follow(self, observation, setpoint, dt_s):
            call()
            return core.Twist(linear_mps=0.1)

    config = control.FollowerConfig(law=fuzzy.load_controller(data.path("fuzzy/coordination.yaml")))
    config.laws = [*config.laws, control.LawDescription(name="mine", text="", make=Law)]
    config.active_law = "mine"
    return config


def test_a_law_cannot_call_the_follower_that_calls_it():
    refused = []

    def call():
        with pytest.raises(RuntimeError, match="Follower is in use"):
            follower.restart(0)
        refused.append(True)

    follower = control.Follower(law_that_calls(call))
    assert follower.follow(core.Observation(utime=1, distance_m=2.0), core.Setpoint()).command != core.Twist()
    assert refused == [True]


def test_an_iterator_is_in_use_only_while_it_looks(tmp_path):
    from PIL import Image

    for number in range(2):
        Image.fromarray(NOISE).save(tmp_path / f"{number}.png")
    source = capture.open_images(str(tmp_path))
    assert next((frame.width, source.ended) for frame in source) == (SIZE[1], False)

"""Calls into C++ that work for longer than 30 microseconds, by name: each a function without arguments.

Shorter ones let go of the lock, too, but are over before another thread has woken up.
"""

from __future__ import annotations

import itertools
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
from PIL import Image

from pilotfish import base, blackbox, bus, capture, control, coordinator, core, data, fuzzy, sim, vision

SCENARIO = data.path("scenarios/figure_eight.yaml")
CONFIG = data.path("config/line.yaml")
LAW = data.path("fuzzy/coordination.yaml")
CAMERA = core.CameraModel(width=320, height=240, fx=300, fy=300, cx=159.5, cy=119.5)
TAG = core.BodyTag()
BODY = core.LeaderBody([TAG])
CMO = np.array([[0.0, -1, 0, 0], [0, 0, -1, 0], [1, 0, 0, 1], [0, 0, 0, 1]])  # its rear towards the camera, 1 m ahead


def of_sim() -> Iterator[tuple[str, Callable[[], object]]]:
    scenario = sim.load_scenario(SCENARIO)
    world, clock = sim.World(scenario), itertools.count(1)
    follower = next(robot for robot in scenario.robots if robot.follows)
    renderer, robot = sim.Renderer(CAMERA), sim.RobotBody(leader=BODY)
    wheels = sim.Unicycle(sim.DriveConfig())
    yield "load_scenario", lambda: sim.load_scenario(SCENARIO)
    yield "World", lambda: sim.World(scenario)
    yield "World.advance_to", lambda: world.advance_to(float(next(clock)))
    yield "World.capture", lambda: world.capture(follower.name)
    yield "Unicycle.advance", lambda: wheels.advance(core.Twist(linear_mps=0.1), 1.0)
    yield "Renderer", lambda: sim.Renderer(CAMERA)
    yield "Renderer.render", lambda: renderer.render([(robot, CMO)])
    yield "render_view", lambda: sim.render_view(CAMERA, BODY, CMO)


def of_vision() -> Iterator[tuple[str, Callable[[], object]]]:
    image = sim.render_view(CAMERA, BODY, CMO)
    detector = vision.TagDetector()
    (tag,) = detector.detect(image).tags
    observer = vision.LeaderObserver(camera=CAMERA, body=BODY)
    stamps = itertools.count(33_333, 33_333)
    tracker = vision.TagTracker(camera=CAMERA, body=BODY)
    prediction = tracker.predict_at(TAG.id, corners_px=tag.corners_px, search_px=2.0)
    yield "TagDetector", vision.TagDetector
    yield "TagDetector.detect", lambda: detector.detect(image)
    yield "LeaderObserver", lambda: vision.LeaderObserver(camera=CAMERA, body=BODY)
    yield "LeaderObserver.observe", lambda: observer.observe(core.Frame(image, utime=next(stamps)))
    yield "TagTracker", lambda: vision.TagTracker(camera=CAMERA, body=BODY)
    yield "TagTracker.align", lambda: tracker.align(image, TAG.id, nHt=prediction.nHt)
    yield "TagTracker.track", lambda: tracker.track(image, prediction)


def of_control() -> Iterator[tuple[str, Callable[[], object]]]:
    law = fuzzy.load_controller(LAW)
    many = np.linspace(-1.0, 1.0, 1000)
    config = control.FollowerConfig(law=law)
    yield "load_controller", lambda: fuzzy.load_controller(LAW)
    yield (
        "Controller",
        lambda: fuzzy.Controller(error=law.error, error_change=law.error_change, output=law.output, rules=law.rules),
    )
    yield "infer_batch", lambda: fuzzy.infer_batch(law, many, many)
    yield "infer_outputs", lambda: fuzzy.infer_outputs(law, many, many)
    yield "to_yaml", lambda: fuzzy.to_yaml(law)
    yield "Follower", lambda: control.Follower(config)


def of_coordinator() -> Iterator[tuple[str, Callable[[], object]]]:
    file = coordinator.load_coordinator(CONFIG)
    bundle = coordinator.bundle_config(CONFIG)
    core_of_it, stamps = coordinator.Coordinator(file.coordinator), itertools.count(33_333, 33_333)
    image = np.full((480, 640), 90, np.uint8)
    config = file.coordinator.control
    yield "load_coordinator", lambda: coordinator.load_coordinator(CONFIG)
    yield "bundle_config", lambda: coordinator.bundle_config(CONFIG)
    yield "load_bundle", lambda: coordinator.load_bundle(bundle)
    yield "load_calibration", lambda: coordinator.load_calibration(data.path("calibrations/sim_640x480.yaml"))
    yield "load_leader_body", lambda: coordinator.load_leader_body(data.path("leaders/three_faces.yaml"))
    yield "describe_config", coordinator.describe_config
    yield "apply_overrides", lambda: coordinator.apply_overrides(config, law="pid", tuning=data.path("tuned/pid.yaml"))
    yield "Coordinator", lambda: coordinator.Coordinator(file.coordinator)

    def step() -> None:
        utime = next(stamps)
        core_of_it.step(core.Frame(image, utime=utime), utime)

    yield "Coordinator.step", step


def of_files(folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    for k in range(100):
        Image.fromarray(np.full((480, 640), k, np.uint8)).save(folder / f"{k}.png")
    Image.fromarray(np.full((480, 640), 90, np.uint8)).save(folder / "gray.jpg")
    jpeg = (folder / "gray.jpg").read_bytes()
    source = capture.open_images(str(folder))
    large = folder / "large"
    large.write_bytes(bytes(1 << 20))
    pixels = np.full((4000, 4000), 90, np.uint8)
    yield "open_images", lambda: capture.open_images(str(folder))
    yield "FrameSource.next", source.next
    yield "decode_jpeg", lambda: blackbox.decode_jpeg(jpeg, width=640, height=480, utime=1)
    yield "load_base", lambda: base.load_base(data.path("config/base.yaml"))
    yield "read_file", lambda: core.read_file(large, 1 << 21)
    yield "Frame", lambda: core.Frame(pixels, utime=1)


def of_recording(folder: Path) -> Iterator[tuple[str, Callable[[], object]]]:
    file = coordinator.load_coordinator(CONFIG)
    bundle, driver = coordinator.bundle_config(CONFIG), coordinator.Coordinator(file.coordinator)
    numbers = itertools.count()

    def box() -> blackbox.BlackBox:
        place = folder / f"box{next(numbers)}"
        config = coordinator.BlackBoxConfig(directory=str(place), total_mb=10, segment_mb=1)
        return blackbox.BlackBox(config, robot="robot1", coordinator=driver, bundle=bundle)

    def make_and_end() -> None:
        box()
        shutil.rmtree(folder / f"box{next(numbers) - 1}", ignore_errors=True)

    link, frame = bus.Bus("memq://"), core.Frame(np.zeros((480, 640), np.uint8), utime=1)
    link.on_image("CAMERA", lambda _: None)

    def send_and_handle() -> None:
        link.publish_image("CAMERA", frame)
        link.handle(0)

    yield "BlackBox", make_and_end
    yield "Bus.publish_image, handle", send_and_handle

"""The API reference says something about every name: in the extension modules each public member is documented."""

import enum
import importlib
import inspect
import re
from pathlib import Path

import numpy as np
import pytest

from pilotfish import base, bus, control, coordinator, core, data, fuzzy, sim, vision

ROOT = Path(__file__).parents[2]
MODULES = ["core", "fuzzy", "vision", "control", "coordinator", "capture", "bus", "sim", "base", "blackbox"]


def is_enum(cls):
    return hasattr(cls, "__members__") or issubclass(cls, enum.Enum)


def said(member, name):
    """A docstring without the signatures that pybind11 writes into it."""
    lines = (getattr(member, "__doc__", None) or "").splitlines()
    signature = re.compile(rf"\s*(\d+\. )?{re.escape(name)}\(")
    return " ".join(line for line in lines if line.strip() != "Overloaded function." and not signature.match(line))


def members_of(cls, prefix):
    """(dotted name, member, its own name) of a class, and of those inside it. What an exception or an enumerator
    holds by itself is not ours."""
    yield prefix, cls, cls.__name__
    if issubclass(cls, BaseException):
        return
    for name, member in vars(cls).items():
        if is_enum(cls) and (name in cls.__members__ or name in {"name", "value", "__init__"}):
            continue
        if name.startswith("_") and not (name == "__init__" and callable(member)):
            continue
        if inspect.isclass(member):
            yield from members_of(member, f"{prefix}.{name}")
        elif not (is_enum(cls) and isinstance(member, cls)):
            yield f"{prefix}.{name}", member.__func__ if isinstance(member, staticmethod) else member, name


def public_members(module):
    for name, member in vars(module).items():
        if name.startswith("_"):
            continue
        if inspect.isclass(member):
            if member.__module__ == module.__name__:
                yield from members_of(member, name)
        elif callable(member):
            yield name, member, name


@pytest.mark.parametrize("room", MODULES)
def test_every_public_member_is_documented(room):
    module = importlib.import_module(f"pilotfish.{room}")
    members = list(public_members(module))
    assert len(members) >= 5, "nothing is tested"
    assert said(module, room).strip(), f"pilotfish.{room} says nothing of itself"
    missing = [dotted for dotted, member, name in members if not said(member, name).strip()]
    assert missing == [], f"without a docstring in pilotfish.{room}"


@pytest.mark.parametrize("room", MODULES)
def test_no_signature_is_hidden_behind_keywords(room):
    """A configuration's constructor names its keywords."""
    hidden = [
        dotted
        for dotted, member, _ in public_members(importlib.import_module(f"pilotfish.{room}"))
        if "**kwargs" in (getattr(member, "__doc__", None) or "")
    ]
    assert hidden == []


def test_every_module_has_a_page():
    pages = {page.stem for page in (ROOT / "docs/api/python").glob("*.rst")}
    assert set(MODULES) <= pages


ORIGIN = sim.Pose2()
LAW = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
VALUES = [
    core.Twist(),
    core.Setpoint(),
    core.Observation(utime=1, distance_m=1.0),
    core.RelativeMeasurement(distance_m=1.0, bearing_rad=0.0, heading_rad=0.0, covariance=np.zeros((3, 3))),
    core.Frame(np.zeros((16, 16), np.uint8), utime=1),
    core.CameraModel(width=640, height=480, fx=600, fy=600, cx=319.5, cy=239.5),
    core.CameraMounting(),
    core.BodyTag(),
    core.LeaderBody([core.BodyTag()]),
    core.TagDetection(id=0, corners_px=np.zeros((4, 2))),
    fuzzy.Triangle(-1, 0, 1),
    LAW,
    LAW.error,
    LAW.rules,
    fuzzy.InputWidths(),
    fuzzy.infer(LAW, 0.0, 0.0),
    fuzzy.explain(LAW, 0.1, 0.0),
    vision.LeaderObserverConfig(),
    vision.TagDetectorConfig(),
    vision.TagGates(),
    vision.LeaderPoseConfig(),
    control.LimitsConfig(),
    control.FollowerConfig(law=LAW),
    control.LeaderMotion(),
    control.FieldOfView(right_rad=-0.5, left_rad=0.5),
    control.built_in_laws()[0],
    coordinator.SafetyConfig(),
    coordinator.CoordinatorConfig(),
    coordinator.ConfigOverrides(),
    coordinator.load_coordinator(data.path("config/line.yaml")),
    bus.CommandReport(utime=1),
    bus.SetpointReport(utime=1),
    bus.BaseReport(utime=1),
    bus.StatusReport(utime=1),
    bus.ObservationReport(utime=1),
    bus.PoseReport(utime=1, x_m=0, y_m=0, heading_rad=0),
    bus.MotionReport(utime=1),
    sim.DriveConfig(),
    sim.Scenario(),
    ORIGIN,
    sim.state_at(sim.Still(), ORIGIN, 0.0),
    sim.Line(),
    sim.load_scenario(data.path("scenarios/line.yaml")).robots[0],
    base.BaseConfig(),
    base.DriveGeometry(),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_a_value_shows_what_it_holds(value):
    shown = repr(value)
    assert shown.startswith(type(value).__name__ + "("), shown
    assert " object at 0x" not in shown


def test_a_repr_of_plain_numbers_gives_the_value_back():
    for value in (core.Twist(linear_mps=0.25, angular_radps=-1.5), core.Setpoint(distance_m=1.25, run=False)):
        assert repr(eval(repr(value), vars(core))) == repr(value)

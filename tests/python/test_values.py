"""What Python expects of values: equality, copies and pickles that are equal, and refusal of what cannot be."""

import copy
import math
import pickle

import numpy as np
import pytest

from pilotfish import ConfigError, control, coordinator, core, data, fuzzy, sim, vision

FUZZY = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
CAMERA = core.CameraModel(width=64, height=48, fx=60, fy=60, cx=32, cy=24, k1=0.01)
TAG = core.BodyTag(id=3, position_m=[0.1, 0.2, 0.3])
SEEN = core.Observation(
    utime=5,
    distance_m=2.0,
    bearing_rad=0.1,
    covariance=np.diag([1.0, 2.0, 3.0]),
    cMo=np.eye(4),
    tags=[core.TagDetection(id=3, corners_px=np.arange(8.0).reshape(4, 2))],
)


class OwnLaw:
    def __init__(self, parameters, limits):
        pass

    def follow(self, observation, setpoint, dt_s):
        return core.Twist()


def follower_config():
    parameter = control.LawParameter("gain", 1.0, min=0.0, max=2.0)
    own = control.LawDescription(name="own", text="mine", parameters=[parameter], make=OwnLaw)
    config = control.FollowerConfig(law=FUZZY, laws=[*control.built_in_laws(), own], active_law="own")
    config.limits.max_linear_mps = 0.3
    return config


def robot_body():
    body = sim.RobotBody()
    body.leader = core.LeaderBody(tags=[TAG])
    return body


VALUES = [
    core.Twist(linear_mps=1.0, angular_radps=2.0),
    core.Setpoint(distance_m=1.5, bearing_rad=0.1, run=False),
    TAG,
    core.LeaderBody(tags=[TAG], name="other"),
    CAMERA,
    core.CameraMounting(),
    SEEN,
    core.Frame(np.zeros((32, 32), np.uint8), utime=4),
    fuzzy.Triangle(-1, 0, 1),
    fuzzy.Trapezoid(-math.inf, -math.inf, 0, 1),
    fuzzy.Gaussian(0, 1),
    FUZZY.error,
    FUZZY.rules,
    FUZZY,
    fuzzy.InputWidths(error=0.1),
    follower_config(),
    control.built_in_laws()[0],
    vision.LeaderObserverConfig(acquisition_range_m=4.0),
    coordinator.load_coordinator(data.path("config/line.yaml")).coordinator,
    robot_body(),
    sim.Circle(radius_m=2.0),
]


def name(value):
    return type(value).__name__


@pytest.mark.parametrize("value", VALUES, ids=name)
def test_a_value_equals_its_copies_and_its_pickle(value):
    for twin in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
        assert twin is not value
        assert twin == value
        if value.__hash__ is not None:
            assert hash(twin) == hash(value)
    assert value != "something else"


def test_what_cannot_be_changed_is_a_key_and_what_can_is_not():
    assert {CAMERA: "a"}[copy.copy(CAMERA)] == "a"
    assert hash(core.LeaderBody(tags=[TAG], name="other")) == hash(core.LeaderBody(tags=[TAG], name="other"))
    for changeable in (core.Setpoint(), core.CameraMounting(), control.LimitsConfig()):
        with pytest.raises(TypeError, match="unhashable"):
            hash(changeable)


@pytest.mark.parametrize(
    ("value", "attribute", "other"),
    [
        (core.Setpoint(), "distance_m", 2.0),
        (TAG, "position_m", [0.1, 0.2, 0.4]),
        (follower_config(), "active_law", "fuzzy"),
        (vision.LeaderObserverConfig(), "acquisition_range_m", 3.0),
    ],
    ids=name,
)
def test_a_copy_is_one_s_own(value, attribute, other):
    twin = copy.deepcopy(value)
    setattr(twin, attribute, other)
    assert twin != value
    assert getattr(value, attribute) != other


def test_parts_are_copied_too():
    value = follower_config()
    twin = copy.copy(value)
    twin.limits.max_linear_mps = 0.1
    assert value.limits.max_linear_mps == 0.3
    assert twin != value


def test_results_are_compared_and_copied():
    one, other = (fuzzy.infer(FUZZY, error, 0.0) for error in (-0.5, 0.5))
    assert one == copy.copy(one) == copy.deepcopy(one)
    assert one != other


@pytest.mark.parametrize(
    ("key", "number"), [("distance_m", math.inf), ("distance_m", -1.0), ("distance_m", math.nan), ("bearing_rad", 1.5)]
)
def test_a_setpoint_that_cannot_be_kept_is_refused_by_its_key(key, number):
    setpoint = core.Setpoint()
    for attempt in (lambda: core.Setpoint(**{key: number}), lambda: setattr(setpoint, key, number)):
        with pytest.raises(ConfigError) as refused:
            attempt()
        assert refused.value.key == key
    assert setpoint == core.Setpoint()
    assert str(getattr(core.Setpoint.unchecked(**{key: number}), key)) == str(number)


@pytest.mark.parametrize(
    ("assign", "said"),
    [
        (lambda: setattr(control.LimitsConfig(), "max_linear_mps", None), "LimitsConfig.max_linear_mps: None is not a"),
        (lambda: core.BodyTag(id="0"), "BodyTag.id: '0' is not a whole number"),
        (lambda: core.CameraMounting(position_m=[0, 0]), "CameraMounting.position_m: [0, 0] is not a sequence"),
        (lambda: setattr(core.Setpoint(), "run", "yes"), "Setpoint.run: 'yes' is not True or False"),
    ],
)
def test_a_parameter_of_the_wrong_type_is_refused_by_its_name(assign, said):
    with pytest.raises(TypeError) as refused:
        assign()
    assert str(refused.value).startswith(said)

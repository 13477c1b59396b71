"""A law of one's own that fails: the robot stands still, whoever drives, and who wants out of the program gets out."""

import math
import signal
import sys

import pytest

from pilotfish import ConfigError, control, coordinator, core, data, fuzzy

FUZZY = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
SEEN = core.Observation(utime=1_000_000, distance_m=2.0, bearing_rad=0.1)


def config_of(make):
    law = control.LawDescription(name="mine", text="", make=make)
    return control.FollowerConfig(law=FUZZY, laws=[*control.built_in_laws(), law], active_law="mine")


def law_that(answer, restart=lambda: None):
    class Law:
        def __init__(self, parameters, limits):
            pass

        def follow(self, observation, setpoint, dt_s):
            return answer()

        def restart(self):
            restart()

    return config_of(Law)


def raising(exception):
    def answer():
        raise exception

    return answer


def core_with(control_config):
    config = coordinator.load_coordinator(data.path("config/line.yaml")).coordinator
    config.control = control_config
    return coordinator.Coordinator(config)


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("name", ["linear_mps", "angular_radps"])
def test_a_twist_that_is_not_finite_stands_still(number, name):
    config = law_that(lambda: core.Twist(**{name: number}))
    output = control.Follower(config).follow(SEEN, core.Setpoint())
    assert (output.command, output.reason) == (core.Twist(), core.Reason.law_not_finite)
    result = core_with(config).step_observation(SEEN.utime, SEEN, SEEN.utime)
    assert (result.command, result.reason) == (core.Twist(), core.Reason.law_not_finite)
    assert result.status != core.Status.tracking


@pytest.mark.parametrize("number", [math.nan, math.inf])
def test_a_measurement_that_is_no_number_stands_still(number):
    seen = core.Observation(utime=1, distance_m=number)
    output = control.Follower(control.FollowerConfig(law=FUZZY)).follow(seen, core.Setpoint())
    assert (output.command, output.reason) == (core.Twist(), core.Reason.law_not_finite)


@pytest.fixture
def printed(monkeypatch):
    """What the interpreter says of exceptions that cannot be raised."""
    said = []
    monkeypatch.setattr(sys, "unraisablehook", lambda about: said.append(str(about.exc_value)))
    return said


@pytest.mark.parametrize("answer", [None, (0.1, 0.2), 0.1])
def test_an_answer_that_is_no_twist_is_named(answer, printed):
    control.Follower(law_that(lambda: answer)).follow(SEEN, core.Setpoint())
    assert printed == [f"follow() of a law returned {type(answer).__name__} instead of a pilotfish.core.Twist"]


@pytest.mark.parametrize("made", [None, object(), core.Twist()])
def test_what_has_no_follow_is_refused_when_it_is_made(made):
    with pytest.raises(ConfigError, match=r"control\.mine: make\(\) returned .*, which has no method follow\(\)"):
        control.Follower(config_of(lambda parameters, limits: made))


@pytest.mark.parametrize("exception", [KeyboardInterrupt(), SystemExit(3)])
def test_who_wants_out_of_the_program_gets_out(exception):
    config = law_that(raising(exception))
    with pytest.raises(type(exception)) as raised:
        control.Follower(config).follow(SEEN, core.Setpoint())
    assert raised.value is exception
    follower = core_with(config)
    with pytest.raises(type(exception)):
        follower.step_observation(SEEN.utime, SEEN, SEEN.utime)
    assert follower.command_at(SEEN.utime).command == core.Twist()


def test_an_interrupt_in_restart_gets_out_too():
    follower = control.Follower(law_that(core.Twist, restart=raising(KeyboardInterrupt())))
    with pytest.raises(KeyboardInterrupt):
        follower.restart(0)
    follower.follow(SEEN, core.Setpoint())  # once


def test_ctrl_c_interrupts_a_law():
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job begins without it

    def answer():
        signal.raise_signal(signal.SIGINT)
        for _ in range(1000):  # the interpreter looks for signals between two instructions
            pass
        return core.Twist()

    with pytest.raises(KeyboardInterrupt):
        control.Follower(law_that(answer)).follow(SEEN, core.Setpoint())


def test_an_ordinary_exception_is_printed_and_stands_still(printed):
    output = control.Follower(law_that(raising(ValueError("boom")))).follow(SEEN, core.Setpoint())
    assert (output.command, output.reason) == (core.Twist(), core.Reason.law_not_finite)
    assert printed == ["boom"]

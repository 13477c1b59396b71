"""What can be configured of the base process: each parameter has bounds, and they belong to it."""

import math
from contextlib import nullcontext

import pytest

from pilotfish import ConfigError, base

BOUNDS = {
    "rate_hz": (30.0, 200.0),
    "commands.max_command_age_s": (0.02, 0.1),  # the rule: never more than 100 ms
    "commands.takeover_s": (0.2, 60.0),
    "serial.timeout_s": (0.05, 5.0),
    "wheels.wheel_radius_m": (0.005, 1.0),
    "wheels.track_width_m": (0.02, 5.0),
    "limits.max_linear_mps": (0.01, 5.0),
    "limits.max_reverse_mps": (0.0, 5.0),
    "limits.max_linear_acceleration_mps2": (0.01, 20.0),
    "limits.brake_mps2": (0.01, 100.0),
    "limits.max_angular_radps": (0.01, 20.0),
    "limits.max_angular_acceleration_radps2": (0.01, 200.0),
    "limits.max_wheel_radps": (0.1, 1000.0),
}


def base_with(path, value):
    config = base.BaseConfig()
    *sections, name = path.split(".")
    where = getattr(config, sections[0]) if sections else config
    setattr(where, name, value)
    return base.Base(config, session=1, simulated_allowed=False)


@pytest.mark.parametrize(("path", "bounds"), BOUNDS.items(), ids=BOUNDS)
def test_the_bounds_are_taken_and_what_lies_beyond_them_is_refused_by_name(path, bounds):
    low, high = bounds
    base_with(path, low)
    base_with(path, high)
    for beyond in (math.nextafter(low, -math.inf), math.nextafter(high, math.inf), math.nan):
        with pytest.raises(ConfigError) as refused:  # where it is assigned, which knows its own section only
            base_with(path, beyond)
        assert refused.value.key == path.split(".")[-1]


@pytest.mark.parametrize(("ticks", "allowed"), [(0, False), (1, True), (1_000_000, True), (1_000_001, False)])
def test_a_wheel_has_one_tick_a_turn_at_least_and_a_million_at_most(ticks, allowed):
    with nullcontext() if allowed else pytest.raises(ValueError, match=r"ticks_per_revolution"):
        base_with("wheels.ticks_per_revolution", ticks)

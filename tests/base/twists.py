"""Short to write: Twist(0.3, 0.5) is 0.3 m/s and 0.5 rad/s."""

from pilotfish import core


def Twist(linear_mps: float = 0.0, angular_radps: float = 0.0) -> core.Twist:  # noqa: N802
    return core.Twist(linear_mps=linear_mps, angular_radps=angular_radps)

"""The numbers of the model of following (following.py says what they mean together)."""

from __future__ import annotations

from dataclasses import dataclass, fields

from pilotfish.errors import ConfigError


@dataclass(frozen=True)
class Following:
    """The numbers of the model above."""

    setpoint_m: float = 1.1  # d_p
    stop_distance_m: float = 0.4  # D_stop
    error_scale_m: float = 0.8  # E_s
    error_change_scale_m: float = 0.05  # EC_s
    velocity_scale_mps: float = 0.6  # V_s
    speed_limit_mps: float = 0.6  # V
    reverse_limit_mps: float = 0.3  # V_r
    acceleration_mps2: float = 1.0  # a, of the limits and of the drive's ramp
    latency_s: float = 1.0 / 30.0  # L
    lag_s: float = 0.1  # tau
    period_s: float = 1.0 / 30.0  # T
    noise_m: float = 0.005  # N
    leader_speed_mps: float = 0.6  # V_l
    leader_deceleration_mps2: float = 1000.0  # b

    def __post_init__(self) -> None:
        for each in fields(self):
            low, high = RANGES[each.name]
            value = getattr(self, each.name)
            if not low <= value <= high:
                raise ConfigError(f"{each.name}: {value:g} is outside [{low:g}, {high:g}]")
        if self.setpoint_m < self.stop_distance_m:
            raise ConfigError(
                f"setpoint_m: {self.setpoint_m:g} is below stop_distance_m ({self.stop_distance_m:g}); allowed: from "
                f"there to {RANGES['setpoint_m'][1]:g}"
            )


RANGES: dict[str, tuple[float, float]] = {
    "setpoint_m": (0.05, 20.0),
    "stop_distance_m": (0.0, 20.0),
    "error_scale_m": (0.01, 20.0),
    "error_change_scale_m": (1e-4, 5.0),
    "velocity_scale_mps": (0.01, 5.0),
    "speed_limit_mps": (0.01, 5.0),
    "reverse_limit_mps": (0.0, 5.0),
    "acceleration_mps2": (0.01, 20.0),
    "latency_s": (0.0, 0.25),
    "lag_s": (0.0, 1.0),
    "period_s": (1e-3, 1.0),
    "noise_m": (0.0, 1.0),
    "leader_speed_mps": (0.0, 5.0),
    "leader_deceleration_mps2": (1e-3, 1000.0),
}
"""Both inclusive; those of the coordinator's configuration and of scenarios where these have the parameter."""

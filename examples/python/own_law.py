"""A law of one's own, behind the same limits and guards as the fuzzy one. It drives a robot up to a leader that is 2 m
ahead and 0.3 m to the left, measured without noise."""

import math
import signal

from pilotfish import control, core, data, fuzzy

for number in (signal.SIGINT, signal.SIGPIPE):
    signal.signal(number, signal.SIG_DFL)  # Ctrl-C and `| head` end it, as any program


class Proportional:
    """Speed in proportion to the error, turn rate in proportion to the bearing."""

    def __init__(self, parameters: dict[str, float], limits: control.LimitsConfig) -> None:
        self.gain_per_s = parameters["gain_per_s"]

    def follow(self, seen: core.Observation, setpoint: core.Setpoint, dt_s: float) -> core.Twist:
        return core.Twist(
            linear_mps=self.gain_per_s * (seen.distance_m - setpoint.distance_m),
            angular_radps=2.0 * self.gain_per_s * (seen.bearing_rad - setpoint.bearing_rad),
        )


law = control.LawDescription(
    name="proportional",
    text="speed in proportion to the error",
    parameters=[control.LawParameter("gain_per_s", 0.8, min=0.0, max=10.0, text="of the distance")],
    make=Proportional,
)
config = control.FollowerConfig(
    law=fuzzy.load_controller(data.path("fuzzy/coordination.yaml")),  # still evaluated, to compare with
    laws=[*control.built_in_laws(), law],
    active_law="proportional",
)
follower = control.Follower(config)

x_m, y_m, heading_rad, period_s = 0.0, 0.0, 0.0, 1 / 30
for k in range(241):
    seen = core.Observation(
        utime=1 + int(k * period_s * 1e6),
        distance_m=math.hypot(2.0 - x_m, 0.3 - y_m),
        bearing_rad=math.atan2(0.3 - y_m, 2.0 - x_m) - heading_rad,
    )
    command = follower.follow(seen, core.Setpoint()).command
    if k % 30 == 0:
        print(f"{k // 30} s: d = {seen.distance_m:.3f} m, v = {command.linear_mps:.3f} m/s")
    heading_rad += command.angular_radps * period_s
    x_m += command.linear_mps * period_s * math.cos(heading_rad)
    y_m += command.linear_mps * period_s * math.sin(heading_rad)

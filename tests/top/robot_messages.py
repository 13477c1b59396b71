"""Messages of a robot, made by hand."""

from __future__ import annotations

from pilotfish import core
from pilotfish.lcmtypes.pilotfish import base_t, command_t, counter_t, observation_t, status_t
from pilotfish.watching import Kind, Message


def status(name="tracking", reason="none", *, session=7, latency_s=0.02, wanted_m=1.0, **counts):
    message = status_t()
    message.status, message.reason = int(core.Status.__members__[name]), int(core.Reason.__members__[reason])
    message.session, message.latency_s, message.frame_rate_hz = session, latency_s, 30.0
    message.setpoint_distance_m, message.output = wanted_m, 0.25
    for counter_name, count in counts.items():
        counter = counter_t()
        counter.name, counter.count = counter_name, count
        message.rejected.append(counter)
    message.rejected_count = len(message.rejected)
    return message


def command(name="tracking", reason="none", *, session=7, linear_mps=0.0, angular_radps=0.0):
    message = command_t()
    message.status, message.reason = int(core.Status.__members__[name]), int(core.Reason.__members__[reason])
    message.session, message.linear_mps, message.angular_radps = session, linear_mps, angular_radps
    message.mac = bytes(32)
    return message


def observation(distance_m=None, bearing_rad=0.0, latency_s=0.001):
    message = observation_t()
    message.detected = distance_m is not None
    message.distance_m, message.bearing_rad, message.latency_s = distance_m or 0.0, bearing_rad, latency_s
    return message


def base(state=1):
    message = base_t()
    message.state, message.mac = state, bytes(32)
    return message


_KINDS = {status_t: Kind.status, command_t: Kind.command, observation_t: Kind.observation, base_t: Kind.base}


def received(value, arrival_s=0.0, robot="robot1"):
    kind = _KINDS[type(value)]
    return Message(arrival_s, f"{robot.upper()}_{kind.value}", robot, kind, value)

"""What a replay compares, as texts in which every bit shows: float.hex() is exact."""

from __future__ import annotations

from pilotfish import core
from pilotfish.coordinator import HeldCommand


def twist_text(twist: core.Twist) -> str:
    """Speed and turn rate, rounded and exact."""
    exact = f"{float(twist.linear_mps).hex()}, {float(twist.angular_radps).hex()}"
    return f"{twist.linear_mps:.6g} m/s, {twist.angular_radps:.6g} rad/s ({exact})"


def answer_text(status: core.Status, reason: core.Reason, command: core.Twist) -> str:
    """Status, reason and command."""
    return f"{status.name}, {reason.name}, {twist_text(command)}"


def held_text(held: HeldCommand) -> str:
    """A held command with its times and flags."""
    flags = f"holding {held.holding}, run {held.run}, ever measured {held.ever_measured}, turning {held.turning}"
    return f"{twist_text(held.command)} of {held.utime} us, from {held.from_us} to {held.until_us} us, {flags}"


def observation_text(observation: core.Observation | None) -> str:
    """Where a leader was seen, and by which tags."""
    if observation is None:
        return "nothing"
    o = observation
    return f"{o.distance_m!r} m, {o.bearing_rad!r} rad, {o.heading_rad!r} rad, tags {[tag.id for tag in o.tags]}"

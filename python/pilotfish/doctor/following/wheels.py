"""The way from the command to the wheels: what pilotfish-base says, and whether the robot comes nearer."""

from __future__ import annotations

import math

from pilotfish.doctor.following import advice
from pilotfish.doctor.following.cause import MOVES_MPS, Cause, speed_text
from pilotfish.doctor.following.evidence import Evidence
from pilotfish.doctor.following.swing import Swing


def what_the_wheels_do(robot: str, seen: Evidence) -> tuple[list[Cause], list[Cause]]:
    """What the wheels' process does: reasons to stand still, and notes."""
    if not seen.base_state:
        what = f"no pilotfish-base of {robot} answers the commands; wheels driven by another program do not show here"
        do = f"pilotfish-base --config base.yaml, if it is to drive them ({robot.upper()}_BASE is silent)"
        if others := other_bases_text(seen):
            what = f"no pilotfish-base of {robot} answers the commands; {others}"
            do = f"name: {robot} in its base.yaml, if it is the one that is to drive {robot}'s wheels; {do}"
        return [], [Cause("no_base", what, do)]
    if len(seen.base_sessions) > 1 and "another_base" in seen.base_counters_risen:
        return [Cause("two_bases", "two pilotfish-base of this name", "end one of them")], []
    if seen.base_state == "stopped":
        return [
            Cause(
                "base_stopped",
                "the wheels hold a stop of their own (state stopped)",
                f"pilotfish resume {robot}: coordinator and wheels are both resumed by it",
            )
        ], []
    if seen.base_state == "fault":
        said = f": {seen.base_text}" if seen.base_text else ""
        return [
            Cause(
                "base_fault",
                f"the motor controller does not answer or reports a fault{said}",
                "check the serial line (pilotfish doctor), the battery and the emergency stop",
            )
        ], []
    refused = [(name, count) for name, count in seen.base_counters_risen.items() if name in advice.BASE_COUNTERS]
    if seen.base_states.get("driving", 0.0) >= 0.5 or seen.last_status not in ("tracking", "coasting"):
        return [], []
    if not refused:
        if not seen.commanded_mps.count or seen.commanded_mps.maximum < MOVES_MPS:
            return [], []  # it waits because nothing is commanded
        said = f" ({seen.base_text})" if seen.base_text else ""
        return [Cause("base_waits", f"the wheels wait{said} although commands are sent", "restart pilotfish-base")], []
    texts = [
        Cause(
            "base_refuses",
            f"the wheels refuse the commands: {name} rose by {count} ({advice.BASE_COUNTERS[name][0]})",
            advice.BASE_COUNTERS[name][1].replace("ROBOT_BASE", f"{robot.upper()}_BASE"),
        )
        for name, count in refused
    ]
    return texts, []


def distance_that_stays(robot: str, seen: Evidence) -> list[Cause]:
    """It tracks, and yet it does not come nearer: the error is large and does not shrink while it commands speed."""
    first, last, wanted = seen.error_first_m, seen.error_last_m, seen.setpoint_distance_m
    if not all(map(math.isfinite, (first, last, wanted))):
        return []
    large = abs(last) > max(0.3, 0.25 * wanted)
    if not large or abs(last) < 0.9 * abs(first):
        return []
    where = f"{abs(last):.2f} m too {'far' if last < 0 else 'close'} (wanted {wanted:.2f} m)"
    if seen.commanded_mps.count == 0 or seen.commanded_mps.median < MOVES_MPS:
        return [
            Cause(
                "no_speed_commanded",
                f"it tracks, is {where}, and commands only {speed_text(seen)}",
                "control.limits and control.guard.minimum_distance_m in its configuration say how fast it may drive",
            )
        ]
    still = seen.wheels_moved is False
    why = (
        "the encoders say that the wheels stand"
        if still
        else "the wheels do not turn, or the leader is faster than it may drive"
    )
    others = f", but {text}" if (text := other_bases_text(seen)) else ""
    base = "" if seen.base_state else f"; no pilotfish-base of {robot} is on the bus{others}"
    dry = "; is driver: dry_run in base.yaml?" if seen.base_state else ""
    return [
        Cause(
            "distance_error",
            f"it tracks and is {where}, no nearer than {seen.seconds:.0f} s ago, at {speed_text(seen)} commanded: "
            f"{why}{base}",
            f"lift it and see if the wheels turn; compare control.limits.max_linear_mps with the leader's speed{dry}",
        )
    ]


def other_bases_text(seen: Evidence) -> str:
    """ "one of robot2 is there": whose wheels' processes are heard instead."""
    if not seen.other_bases:
        return ""
    listed = ", ".join(seen.other_bases)
    return f"one of {listed} is there" if len(seen.other_bases) == 1 else f"those of {listed} are there"


def distance_that_swings(seen: Evidence) -> list[Cause]:
    """It tracks, and the distance goes to and fro, or past what is wanted."""
    wanted, swing = seen.setpoint_distance_m, seen.swing
    if not (swing.swings or swing.overshoots(wanted)):
        return []
    least, most = seen.commanded_range_mps
    commanded = f" while {least:+.2f} to {most:+.2f} m/s are commanded" if math.isfinite(least) else ""
    if swing.swings:
        what = f"the distance swings about what is wanted ({wanted:.2f} m), {extremes_text(swing)}{commanded}"
    else:
        what = (
            f"it overshoots: {swing.overshot_m:.2f} m too close (wanted {wanted:.2f} m) after it was too far{commanded}"
        )
    return [
        Cause(
            "swings" if swing.swings else "overshoots",
            what,
            "the wheels speed up or brake less than control.limits says: compare base.yaml's limits (pilotfish doctor "
            "--config FILE does) and the motor controller's own ramps; else control.limits' acceleration or the law's "
            "gains are too high for this drive (pilotfish identify, pilotfish tune). A leader that drives to and fro "
            "itself looks like this, too",
        )
    ]


def extremes_text(swing: Swing) -> str:
    """ "from 157 mm too far to 243 mm too close": of the deciding part."""
    errors_m = (swing.lowest_m, swing.highest_m)
    ends = [f"{1000 * abs(error_m):.0f} mm too {'far' if error_m < 0 else 'close'}" for error_m in errors_m]
    return f"from {ends[0]} to {ends[1]}"

"""Why a robot does not follow, the most likely cause first. Pure functions of Evidence and Setup.

The order is that of the way from the camera to the wheels: a fault early on makes everything behind it look wrong, too.
What held only in the first half of the watch is not a cause: it is over.
"""

from __future__ import annotations

from pilotfish.doctor.following.base_here import BaseHere, what_the_base_is_set_to
from pilotfish.doctor.following.cause import (
    FOLLOWS_SHARE,
    MIN_FRAME_RATE_HZ,
    Cause,
    held_share,
    risen_by,
)
from pilotfish.doctor.following.evidence import Evidence
from pilotfish.doctor.following.in_view import InView
from pilotfish.doctor.following.load import Machine
from pilotfish.doctor.following.mounting import bearing_that_stays, how_it_stands, off_the_floor
from pilotfish.doctor.following.seeing import overloaded, what_is_missing_while_stopped, what_it_sees
from pilotfish.doctor.following.setup import Setup
from pilotfish.doctor.following.wheels import distance_that_stays, distance_that_swings, what_the_wheels_do


def causes(
    robot: str,
    seen: Evidence,
    setup: Setup | None = None,
    in_view: InView | None = None,
    machine: Machine | None = None,
    base_here: BaseHere | None = None,
) -> tuple[list[Cause], list[Cause]]:
    """What keeps it from following, and what does not but is worth knowing. It follows if the first list is empty.

    Needs a coordinator that was heard: what there is without one is said in no_coordinator.py.
    """
    found = _senders(robot, seen)
    standing: list[Cause] = []
    before = len(found)
    if not found:  # two coordinators send zeros, whatever they see; one that is gone sees nothing any more
        found += what_is_missing_while_stopped(robot, seen, setup, machine)
        found += _stopped(robot, seen, setup)
        standing, before = how_it_stands(seen, setup), len(found)
        found += what_it_sees(robot, seen, setup, in_view, machine)
    held = held_share(seen)
    blocking, notes = what_the_wheels_do(robot, seen)
    found += blocking
    if not found and held < FOLLOWS_SHARE:
        found.append(_unexplained(robot, seen, held))
    if not found:
        found += [
            *bearing_that_stays(robot, seen, setup),
            *(distance_that_stays(robot, seen) or distance_that_swings(seen)),
        ]
    if found or (setup is not None and setup.mounting is not None):
        found[before:before] = standing  # before what it sees: with a camera upside down it turns away from its leader
    else:
        notes += standing  # it may be mounted with that roll, and follows
    if not standing and "mounting" not in {cause.name for cause in found}:
        (found if found else notes).extend(off_the_floor(seen, setup))
    first, more = what_the_base_is_set_to(found, seen, base_here)
    found, notes = first + found, notes + more
    busy = overloaded(seen, machine)
    if busy and "overloaded" not in {cause.name for cause in found}:
        late = {"too_old", "intermittent", "too_few_images"} & {cause.name for cause in found}
        (found if late else notes).append(busy)
    return found, notes + _notes(robot, seen)


def _senders(robot: str, seen: Evidence) -> list[Cause]:
    if seen.rivals or "another_coordinator" in seen.reason_shares:
        counted = f"; it counted {risen} commands of another" if (risen := risen_by(seen, "rival_commands")) else ""
        return [
            Cause(
                "two_coordinators",
                f"{max(2, len(seen.sessions))} coordinators send commands for {robot}: all of them send zeros{counted}",
                f"end all but one (pgrep -a pilotfish-coord; also on other computers), or give each a --name; "
                f"lcm-logplayer that plays {robot.upper()}_COMMAND counts, too",
            )
        ]
    if seen.silent_at_end_s:
        return [
            Cause(
                "fell_silent",
                f"its coordinator has not said anything for the last {seen.silent_at_end_s:.1f} s: it ended or hangs",
                f"start it again; systemctl status pilotfish-coordinator@{robot}, or its log, says why it ended",
            )
        ]
    return []


def _stopped(robot: str, seen: Evidence, setup: Setup | None) -> list[Cause]:
    if seen.last_status != "stopped" and seen.setpoint_run:
        return []
    if not seen.setpoint_taken and (setup is None or not setup.run):
        where = f" ({setup.file})" if setup else ""
        return [
            Cause(
                "stopped",
                "nobody has let it drive since it was started: it looks, and stands still, as setpoint.run: false says "
                f"in its configuration{where}",
                f"pilotfish go {robot} (with --key FILE where there is a key)",
            )
        ]
    return [
        Cause(
            "stopped",
            "a stop is latched: it sees what it sees, and stands still until it is resumed",
            f"pilotfish resume {robot} (with --key FILE where there is a key); "
            "if it starts like this: setpoint.run in its configuration is false",
        )
    ]


def _unexplained(robot: str, seen: Evidence, held: float) -> Cause:
    shares = ", ".join(f"{name} {100 * share:.0f} %" for name, share in seen.status_shares.items())
    return Cause(
        "intermittent",
        f"it follows only {100 * held:.0f} % of the time ({shares})",
        f"watch it for longer (--seconds 60), or pilotfish top to see when; the log of {robot} has every change",
    )


def _notes(robot: str, seen: Evidence) -> list[Cause]:
    notes = []
    if len(seen.sessions) > 1 and not seen.rivals:
        notes.append(
            Cause(
                "restarted",
                f"its coordinator was started anew {len(seen.sessions) - 1} times while it was watched",
                f"journalctl -u pilotfish-coordinator@{robot} says why",
            )
        )
    if seen.pictures_hz > 0.0 and seen.frame_rate_hz < MIN_FRAME_RATE_HZ and "no_frame" not in seen.reason_shares:
        notes.append(
            Cause(
                "slow_camera",
                f"only {seen.frame_rate_hz:.1f} pictures a second",
                "see 'A slow camera' in docs/operating-guide.md",
            )
        )
    if overtaken := risen_by(seen, "frames_overtaken"):
        notes.append(
            Cause(
                "vision_too_slow",
                f"{overtaken} pictures were replaced by newer ones before they were looked at "
                f"(vision takes {seen.processing_ms.median:.1f} ms, {seen.processing_ms.maximum:.1f} ms at most)",
                "a smaller vision.acquisition_range_m, a smaller picture, or a lower frame rate",
            )
        )
    return notes

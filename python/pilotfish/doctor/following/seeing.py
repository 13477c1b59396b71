"""Reasons in the pictures: from no image at all to a tag that is refused. One cause for each reason of the status."""

from __future__ import annotations

from pilotfish.doctor.following import advice
from pilotfish.doctor.following.cause import (
    FOLLOWS_SHARE,
    MIN_FRAME_RATE_HZ,
    Cause,
    held_share,
    ids_text,
    risen_by,
    time_text,
)
from pilotfish.doctor.following.evidence import Evidence
from pilotfish.doctor.following.in_view import InView
from pilotfish.doctor.following.load import Machine
from pilotfish.doctor.following.mounting import upside_down
from pilotfish.doctor.following.setup import Setup
from pilotfish.doctor.network import KEEP_BUFFER, RAW_IMAGE_BYTES, WANTED_IMAGES
from pilotfish.reason_words import reason_text

_LOST_ON_THE_WAY = ("receive_buffer_full", "message_incomplete", "message_displaced")
_ON_ITS_HEAD = "its leader, which stands on its head"
_OFTEN = 0.1  # a reason that holds for less of the time is not worth a line
_OFTEN_LATE = 0.25  # of pictures that come, and now and then a period late


def what_is_missing_while_stopped(
    robot: str, seen: Evidence, setup: Setup | None, machine: Machine | None
) -> list[Cause]:
    """A status that is stopped gives no other reason: that no picture comes shows in stamps that stand still."""
    if (seen.last_status != "stopped" and seen.setpoint_run) or seen.pictures_hz > 0.0 or not seen.status_rate_hz:
        return []
    return [_no_frame(robot, seen, setup, machine, "100 % of the time")]


def overloaded(seen: Evidence, machine: Machine | None) -> Cause | None:
    """The computer has too much to do: by its load, if it is this one, or by what the coordinator counts as late."""
    if not (seen.late.overloaded or (machine is not None and machine.overloaded)):
        return None
    texts = [*([str(machine)] if machine is not None else []), *seen.late.texts()]
    where = "" if machine is not None else " (it does not run here: look at the load there)"
    return Cause(
        "overloaded",
        f"the coordinator's computer has too much to do{where}: {'; '.join(texts)}",
        "end what else runs there (top shows it); give base and coordinator real-time priority (ulimit -r, or their "
        "systemd units); smaller pictures or a lower frame_rate_hz",
    )


def what_it_sees(
    robot: str, seen: Evidence, setup: Setup | None, in_view: InView | None, machine: Machine | None = None
) -> list[Cause]:
    """One for each reason that holds for long enough to matter."""
    found: list[Cause] = []
    held = held_share(seen)
    for name, share in seen.reason_shares.items():
        if name in ("none", "stop_requested", "another_coordinator") or share < _OFTEN:
            continue
        if held >= FOLLOWS_SHARE and share < 1.0 - FOLLOWS_SHARE:
            continue  # a gap that coasting bridges
        if name == "no_frame" and share < _OFTEN_LATE and len(seen.reason_shares) > 1:
            continue
        times = f"{100 * share:.0f} % of the time"
        special = {
            "no_frame": lambda times: _no_frame(robot, seen, setup, machine, times),
            "leader_upside_down": lambda times: upside_down(f"{times}: the coordinator refuses {_ON_ITS_HEAD}"),
            "no_tag_of_the_leader": lambda times: _wrong_tags(seen, setup, in_view, times),
            "frame_size_not_calibrated": lambda times: _wrong_size(robot, seen, setup, times),
            "frame_stale": lambda times: _stale(seen, times),
            "no_tag_found": lambda times: _no_tag(seen, setup, in_view, times),
        }.get(name)
        if special:
            found.append(special(times))
        else:
            what, do = advice.REASONS.get(name, (reason_text(name), "see docs/operating-guide.md"))
            found.append(Cause(name, f"{times}: {what}", do))
    return found


def _no_frame(robot: str, seen: Evidence, setup: Setup | None, machine: Machine | None, times: str) -> Cause:
    wanted = setup.image_channel if setup else f"{robot.upper()}_IMAGE"
    others = {name: rate for name, rate in seen.image_rate_hz.items() if name != wanted}
    if wanted is None:  # a camera of its own
        return Cause(
            "no_images",
            f"{times}: its source {setup.source} gives no picture" if setup else f"{times}: no picture arrives",
            "is the camera plugged in, and does another program use it? "
            "v4l2-ctl --list-devices; pilotfish doctor --config FILE measures it",
        )
    if rate := seen.image_rate_hz.get(wanted):
        if rate < MIN_FRAME_RATE_HZ:
            return Cause(
                "too_few_images",
                f"{times}: no frame in time; {wanted} carries only {rate:.1f} images a second",
                "a faster camera or more light (a long exposure halves the rate); below 12 Hz see "
                "'A slow camera' in docs/operating-guide.md",
            )
        return _images_lost(seen, machine, wanted, rate, times)
    if others:
        listed = ", ".join(f"{name} ({rate:.1f} Hz)" for name, rate in others.items())
        return Cause(
            "images_on_another_channel",
            f"{times}: no images on {wanted}; there are some on {listed}",
            f"start the coordinator with --source lcm:{next(iter(others))}, or let the camera's program publish "
            f"on {wanted}",
        )
    return Cause(
        "no_images",
        f"{times}: no images arrive; none is on the bus ({wanted})" + ("" if setup else ", if it waits for them there"),
        "start the camera's program (or pilotfish-sim --realtime), or let the coordinator open a camera itself: "
        "--source camera:0",
    )


def _images_lost(seen: Evidence, machine: Machine | None, wanted: str, rate_hz: float, times: str) -> Cause:
    """Pictures are on the bus, and do not come to be looked at in time."""
    what = f"{times}: no frame in time, although {wanted} carries {rate_hz:.1f} images a second"
    if busy := overloaded(seen, machine):
        return Cause("overloaded", f"{what}: {busy.what}", busy.do)
    lost = [(name, count) for name in _LOST_ON_THE_WAY if (count := risen_by(seen, name))]
    buffer = machine.receive_buffer_bytes if machine is not None else None
    do = f"do its --lcm-url and --source agree with {wanted}?"
    if lost or buffer is None or buffer < WANTED_IMAGES * RAW_IMAGE_BYTES:
        do = f"{KEEP_BUFFER}, and restart the coordinator; {do}"
    else:
        do = f"the receive buffer is large enough ({buffer} bytes); {do}"
    counted = "; ".join(f"{name} rose by {count}" for name, count in lost)
    return Cause("images_lost", what + (f"; {counted}" if counted else ""), do)


def _wrong_tags(seen: Evidence, setup: Setup | None, in_view: InView | None, times: str) -> Cause:
    body = f"the body has {ids_text(setup.ids)} ({setup.body})" if setup else "the leader's body has others"
    foreign = risen_by(seen, "tag_foreign_id")
    if in_view and in_view.ids:
        sight = f"saw ids {ids_text(in_view.ids)}, {body}"
    else:
        sight = f"saw {foreign} tags of other ids; {body}"
    hint = (
        "" if setup else " (with --config FILE this says which; pictures on the bus are needed to say which were seen)"
    )
    return Cause(
        "wrong_ids",
        f"{times}: the tags in view are not the leader's: {sight}{hint}",
        "name the leader file of the robot in view (leader: in the configuration), or correct its ids",
    )


def _no_tag(seen: Evidence, setup: Setup | None, in_view: InView | None, times: str) -> Cause:
    what, do = advice.REASONS["no_tag_found"]
    if in_view and in_view.images:
        what += f"; looked at {in_view.images} of them here: "
        what += f"found ids {ids_text(in_view.ids)}" if in_view.ids else "no tag of any id in them"
        if in_view.mean_level is not None and not 20 < in_view.mean_level < 235:
            dark = in_view.mean_level < 128
            what += f"; they are nearly {'black' if dark else 'white'} (mean level {in_view.mean_level:.0f} of 255)"
            do = "take the cap off, or more light" if dark else "less light or a shorter exposure"
    if setup:
        do += f" (configured: {setup.family})"
    if seen.status_shares.get("lost"):
        do += (
            ". Does it turn away from its leader as soon as it drives? Then stop it, put the leader into the picture "
            "and ask again: what it measures then says whether the camera is upside down (camera.mounting.roll_deg)"
        )
    return Cause("no_tag_found", f"{times}: {what}", do)


def _wrong_size(robot: str, seen: Evidence, setup: Setup | None, times: str) -> Cause:
    channel = setup.image_channel if setup else f"{robot.upper()}_IMAGE"
    sizes = seen.image_sizes.get(channel or "", {})
    images = " and ".join(f"{width}x{height}" for width, height in sizes) if sizes else "of another size"
    calibrated = f"{setup.width}x{setup.height}" if setup else "for another size"
    return Cause(
        "frame_size",
        f"{times}: the pictures are of the wrong size: the images are {images}, the calibration is {calibrated}"
        + (f" ({setup.file})" if setup else "")
        + f"; {risen_by(seen, 'frames_invalid') + risen_by(seen, 'image_size_unexpected')} were refused",
        "calibrate at the size the camera gives, or set the camera to the calibration's size; "
        "a calibration cannot be scaled by hand",
    )


def _stale(seen: Evidence, times: str) -> Cause:
    age = seen.image_age_s
    aged = f"; by their stamps they are {time_text(age.median)} old in the median, {time_text(age.maximum)} at most"
    refused = f"; {risen} were refused" if (risen := risen_by(seen, "frames_stale")) else ""
    return Cause(
        "too_old",
        f"{times}: the measurement is too old when it arrives{aged if age.count else ''}{refused}",
        "synchronise the clocks of camera and robot (chrony); end a played log; empty the camera's queue; "
        "is a computer or the network overloaded?",
    )

"""The camera that a configuration names: which formats it has, how it exposes, and what it really gives.

Formats and controls are those that ``v4l2-ctl`` (package v4l-utils) lists; the rate, the age and the size are measured
on pictures taken as the coordinator takes them.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

from pilotfish.doctor.finding import Finding, note, ok, wrong
from pilotfish.doctor.following.setup import Setup
from pilotfish.doctor.host import Host

_MEASURE_S = 2.0
_OPEN_S = 5.0
_WANTED_RATE = 0.9  # of the configured rate


@dataclass(frozen=True)
class Mode:
    """A picture that a camera can give."""

    pixelformat: str  # FourCC
    width: int  # [px]
    height: int  # [px]
    rate_hz: float  # the highest one


@dataclass(frozen=True)
class Measured:
    """Pictures that were taken."""

    description: str  # of the source, as the coordinator logs it
    frames: int
    seconds: float  # from the first to the last
    width: int  # [px]
    height: int  # [px]
    problem: str = ""  # why there are none
    age_s: float | None = None  # when it was read, by the driver's stamp: median; None: the driver says nothing

    @property
    def rate_hz(self) -> float:
        """Pictures a second."""
        return (self.frames - 1) / self.seconds if self.frames > 1 and self.seconds > 0.0 else 0.0


def check_camera(host: Host, setup: Setup, measure: Callable[[int, Setup], Measured] | None = None) -> list[Finding]:
    """Formats, exposure and, with ``measure(index, setup)``, what comes out. Nothing for a source that is no camera."""
    kind, _, number = setup.source.partition(":")
    if kind != "camera":
        return [note("camera of the robot", f"{setup.file}: source {setup.source} is no camera of this host")]
    device = f"/dev/video{number}"
    if not host.path(device).exists():
        there = ", ".join(file.name for file in host.find("/dev", "video[0-9]*")) or "none"
        return [
            wrong(
                "camera of the robot",
                f"{device} is not there; cameras here: {there}",
                "plug it in, or name another one: source: camera:N in the configuration",
            )
        ]
    findings = [check_formats(host, device, setup), check_exposure(host, device)]
    findings.append(judge(setup, (measure or take_pictures)(int(number), setup)))
    return findings


def check_formats(host: Host, device: str, setup: Setup) -> Finding:
    """Whether the calibration's size is among those that it has."""
    shown = host.run(["v4l2-ctl", "--device", device, "--list-formats-ext"])
    if shown is None or shown.returncode != 0:
        return note("camera formats", "not known: v4l2-ctl is missing or fails", "sudo apt-get install v4l-utils")
    modes = parse_modes(shown.stdout)
    fitting = [mode for mode in modes if (mode.width, mode.height) == (setup.width, setup.height)]
    if fitting:
        return ok("camera formats", ", ".join(_say(mode) for mode in fitting))
    if not modes:
        return note("camera formats", "it lists none with a fixed size")
    return wrong(
        "camera formats",
        f"none of {setup.width}x{setup.height}, which the calibration is for; it has {', '.join(map(_say, modes[:8]))}",
        "calibrate at a size that it has (a calibration cannot be scaled by hand)",
    )


def parse_modes(listed: str) -> list[Mode]:
    """What ``v4l2-ctl --list-formats-ext`` prints; each size once, with its highest rate."""
    modes: dict[tuple[str, int, int], float] = {}
    pixelformat, size = "", (0, 0)
    for line in listed.splitlines():
        if match := re.search(r"\[\d+\]: '(....)'", line):
            pixelformat = match[1].strip()
        elif match := re.search(r"Size: Discrete (\d+)x(\d+)", line):
            size = int(match[1]), int(match[2])
            modes.setdefault((pixelformat, *size), 0.0)
        elif "Size:" in line:
            size = 0, 0  # any size within bounds
        elif (match := re.search(r"\(([\d.]+) fps\)", line)) and size != (0, 0):
            key = (pixelformat, *size)
            modes[key] = max(modes[key], float(match[1]))
    return [Mode(*key, rate_hz) for key, rate_hz in modes.items()]


def check_exposure(host: Host, device: str) -> Finding:
    """Whether it may lengthen its exposure in the dark, which halves its rate."""
    shown = host.run(["v4l2-ctl", "--device", device, "--list-ctrls"])
    if shown is None or shown.returncode != 0:
        return note("camera exposure", "not known: v4l2-ctl is missing or fails", "sudo apt-get install v4l-utils")
    controls = {
        match[1]: int(match[2]) for match in re.finditer(r"^\s*(\w+) 0x.*?\bvalue=(-?\d+)", shown.stdout, re.MULTILINE)
    }
    automatic = next((name for name in ("auto_exposure", "exposure_auto") if name in controls), None)
    absolute = next((name for name in ("exposure_time_absolute", "exposure_absolute") if name in controls), None)
    if automatic is None:
        return note("camera exposure", "it has no control for that")
    manual = 1  # V4L2_EXPOSURE_MANUAL
    if controls[automatic] == manual:
        shown_time = f", {controls[absolute] / 10:g} ms" if absolute else ""  # in units of 100 us
        return ok("camera exposure", f"fixed{shown_time}")
    priority = next((n for n in ("exposure_dynamic_framerate", "exposure_auto_priority") if controls.get(n)), None)
    slows = f" and may lower the frame rate ({priority}=1)" if priority else ""
    settings = f"{automatic}=1" + (f",{absolute}=100" if absolute else "") + (f",{priority}=0" if priority else "")
    return note(
        "camera exposure",
        f"automatic{slows}: a long exposure blurs tags that move",
        f"v4l2-ctl --device {device} --set-ctrl {settings} ({absolute or 'its exposure'}=100 is 10 ms)",
    )


def take_pictures(index: int, setup: Setup) -> Measured:
    """Opens the camera as the coordinator does, for about two seconds."""
    from pilotfish.capture import CaptureError, open_camera

    try:
        source = open_camera(index, width=setup.width, height=setup.height, frame_rate_hz=setup.frame_rate_hz)
    except CaptureError as error:
        return Measured("", 0, 0.0, 0, 0, str(error))
    give_up_s = time.monotonic() + _OPEN_S
    first_s = last_s = 0.0
    frames, size = 0, (0, 0)
    ages_s: list[float] = []
    while time.monotonic() < give_up_s and not source.ended and (frames == 0 or last_s - first_s < _MEASURE_S):
        frame = source.next()
        if frame is None:
            continue  # no picture yet
        last_s = time.monotonic()
        first_s = first_s or last_s
        frames, size = frames + 1, (frame.width, frame.height)
        if frame.known_age_us > 0:
            ages_s.append(frame.known_age_us * 1e-6)
    problem = "" if frames else (source.why_ended or f"no picture within {_OPEN_S:g} s")
    return Measured(source.describe(), frames, last_s - first_s, *size, problem, median(ages_s) if ages_s else None)


def judge(setup: Setup, measured: Measured) -> Finding:
    """Pure: what the pictures say."""
    check = "camera of the robot"
    if measured.problem:
        in_use = "busy" in measured.problem.lower() or "use" in measured.problem.lower()
        advice = "a coordinator that runs has it: stop that, or pilotfish doctor --following" if in_use else "see above"
        return (note if in_use else wrong)(check, measured.problem, advice)
    aged = "" if measured.age_s is None else f", {1000 * measured.age_s:.0f} ms old when read"
    seen = (
        f"{measured.rate_hz:.1f} pictures a second of {measured.width}x{measured.height}{aged} ({measured.description})"
    )
    if (measured.width, measured.height) != (setup.width, setup.height):
        return wrong(
            check, f"{seen}; the calibration is for {setup.width}x{setup.height}", "calibrate at the size it gives"
        )
    if measured.rate_hz < _WANTED_RATE * setup.frame_rate_hz:
        return note(
            check,
            f"{seen}, where {setup.frame_rate_hz:g} are configured",
            "fix the exposure, give it more light, or lower frame_rate_hz; is the USB bus shared?",
        )
    return ok(check, seen)


def _say(mode: Mode) -> str:
    return f"{mode.pixelformat} {mode.width}x{mode.height} at {mode.rate_hz:g} Hz"

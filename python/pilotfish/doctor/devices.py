"""Cameras and serial lines: there, and usable by whoever asks."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from pilotfish.doctor.finding import Finding, note, ok, wrong
from pilotfish.doctor.host import Host


def check_cameras(host: Host) -> Finding:
    """Whether there is a camera, and whether this user may open it."""
    devices = host.find("/dev", "video[0-9]*")
    return _check(host, "camera", devices, "video", lambda device: _camera_name(host, device))


def check_serial_lines(host: Host) -> Finding:
    """Adapters and on-board lines of small computers; a PC's ttyS exist whether something is there or not."""
    devices = [line for pattern in ("ttyUSB*", "ttyACM*", "ttyAMA*") for line in host.find("/dev", pattern)]
    return _check(host, "serial line", devices, "dialout", lambda device: device.name)


def _camera_name(host: Host, device: Path) -> str:
    name = host.read(f"/sys/class/video4linux/{device.name}/name")
    return f"{device.name} ({name})" if name else device.name


def _check(host: Host, what: str, devices: Sequence[Path], group: str, name_of) -> Finding:
    if not devices:
        return note(what, "none on this host")
    closed = [device for device in devices if not host.may_use(device)]
    if closed:
        return wrong(
            what,
            "no permission for " + ", ".join(name_of(device) for device in closed),
            f"sudo usermod -aG {group} $USER, and log in again (the services are in the group already)",
        )
    return ok(what, ", ".join(name_of(device) for device in devices))

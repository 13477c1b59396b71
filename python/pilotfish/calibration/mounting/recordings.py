"""The pictures of a robot that turns and drives, and, if they were recorded, its odometry or its commands."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pilotfish.black_box import Event, events_in
from pilotfish.black_box.log import files_in
from pilotfish.bus import BusError, LogReader, channel
from pilotfish.calibration.mounting.phases import Odometry
from pilotfish.calibration.video_length import pictures_in_video
from pilotfish.capture import PICTURE_SUFFIXES, CaptureError, open_images, open_video
from pilotfish.core import Frame
from pilotfish.errors import CalibrationError, MissingFileError
from pilotfish.lcmtypes.bot_core import pose_t
from pilotfish.lcmtypes.pilotfish import command_t

_SYNC = b"\xed\xa1\xda\x01"
ODOMETRY, COMMANDS = "odometry", "commands"
MIN_MESSAGES = 10


@dataclass(frozen=True)
class Film:
    """``frames``: the pictures; ``total``: how many, if that is known; ``motion``: what the robot did by its
    ``motion_from`` (odometry, commands), None if nothing was recorded of it."""

    frames: Iterator[Frame]
    total: int | None
    motion: Odometry | None = None
    motion_from: str = ""


def open_film(path: Path, robot: str = "ROBOT1") -> Film:
    """A folder of pictures, a video, a log of lcm-logger, or the folder of a black box. ``robot``: whose channels.

    MissingFileError, CalibrationError.
    """
    if not path.exists():
        raise MissingFileError(f"{path}: no such file or folder; a camera is spelled camera:0")
    try:
        if is_log(path):
            return _log(path, robot)
        if path.is_dir():
            pictures = sum(1 for file in path.iterdir() if file.suffix.lower() in PICTURE_SUFFIXES)
            return Film(iter(open_images(str(path))), pictures or None)
        return Film(iter(open_video(str(path))), pictures_in_video(path))
    except CaptureError as error:
        raise CalibrationError(str(error)) from error


def is_log(path: Path) -> bool:
    """Whether it is a file of LCM events, or a folder with such files."""
    if path.is_dir():
        return any(file.suffix == ".lcmlog" for file in path.iterdir())
    with path.open("rb") as file:
        return file.read(len(_SYNC)) == _SYNC


def _log(path: Path, robot: str) -> Film:
    images = channel(robot.lower(), "IMAGE")
    readers, problem = [], None
    for file in files_in(path, robot.lower() if path.is_dir() else None):
        try:
            readers.append(LogReader(str(file), channel=images))
        except BusError as error:
            problem = error
    if not readers:
        raise CalibrationError(
            f"{path}: no pictures on {images} ({problem}); of another robot: --robot NAME. A black box records raw "
            "pictures at black_box.picture_rate_hz, 2 Hz unless configured"
        )
    motion, motion_from = _motion(path, robot)
    total = sum(len(reader) for reader in readers)
    return Film((frame for reader in readers for frame in reader), total, motion, motion_from)


def _motion(path: Path, robot: str) -> tuple[Odometry | None, str]:
    for what, kind, read in ((ODOMETRY, "POSE", _pose), (COMMANDS, "COMMAND", _command)):
        rows = _messages(path, robot, channel(robot.lower(), kind), read)
        if len(rows) >= MIN_MESSAGES:
            utime, *columns = np.array(sorted(rows)).T
            steps = np.concatenate([[True], np.diff(utime) > 0])
            utime, columns = utime[steps], [column[steps] for column in columns]
            if what == COMMANDS:
                columns = _integrated(utime, *columns)
            return Odometry(utime, *columns), what
    return None, ""


def _messages(
    path: Path, robot: str, wanted: str, read: Callable[[bytes], tuple[float, ...]]
) -> list[tuple[float, ...]]:
    rows = []
    for event in events_in(path, robot.lower() if path.is_dir() else None):
        if not isinstance(event, Event) or event.channel != wanted:
            continue
        try:
            row = read(event.data)
        except Exception:  # lcm-gen's decoders raise whatever the bytes lead to
            continue
        if np.isfinite(row).all():
            rows.append(row)
    return rows


def _pose(data: bytes) -> tuple[float, ...]:
    message = pose_t.decode(data)
    w, x, y, z = message.orientation
    heading = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return float(message.utime), message.pos[0], message.pos[1], float(heading)


def _command(data: bytes) -> tuple[float, ...]:
    message = command_t.decode(data)
    return float(message.utime), message.linear_mps, message.angular_radps


def _integrated(utime: np.ndarray, speed_mps: np.ndarray, rate_radps: np.ndarray) -> list[np.ndarray]:
    """Where constant twists from one command to the next lead: x, y, heading; good for telling turns from drives
    only."""
    dt = np.diff(utime, append=utime[-1]) * 1e-6
    heading = np.concatenate([[0.0], np.cumsum(rate_radps * dt)[:-1]])
    middle = heading + rate_radps * dt / 2.0
    steps = [speed_mps * dt * np.cos(middle), speed_mps * dt * np.sin(middle)]
    return [*(np.concatenate([[0.0], np.cumsum(step)[:-1]]) for step in steps), heading]

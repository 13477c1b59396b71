"""Where rendered pictures go: a folder of PNGs, a film (MP4), or a log as lcm-logger writes it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import numpy as np

from pilotfish.capture import PICTURE_SUFFIXES
from pilotfish.errors import ExistsError, MissingPackageError, UsageError
from pilotfish.extras import require
from pilotfish.whole_files import written_whole

FOLDER, FILM, LOG = "folder", "film", "log"
_SUFFIXES = {".mp4": FILM, ".lcmlog": LOG}
_OURS = re.compile(r"\d{4,}\.png")
_TIME_BASE = Fraction(1, 1_000_000)  # microseconds, as the stamps
# crf 8: errors of the coding below one gray level, where a corner's place is read from differences of some ten levels.
_QUALITY = {"crf": "8", "preset": "veryfast", "bf": "0"}

OnPicture = Callable[[int, int | None], None]


@dataclass(frozen=True)
class Shot:
    """One picture: ``image`` (H, W) uint8, exposed at ``utime`` [us]."""

    utime: int
    image: np.ndarray


@dataclass(frozen=True)
class Pose:
    """What odometry said at ``utime`` [us]: the base in the world in which it counts."""

    utime: int
    x_m: float
    y_m: float
    heading_rad: float


def kind_of(out: Path) -> str:
    """FOLDER, FILM or LOG, by the name's ending. UsageError for an ending that is neither."""
    if out.is_dir() or not out.suffix:
        return FOLDER
    if out.suffix.lower() not in _SUFFIXES:
        raise UsageError(f"{out}: not known what '{out.suffix}' is; a folder's name has no ending, a film's is .mp4")
    return _SUFFIXES[out.suffix.lower()]


def beside(out: Path, name: str) -> Path:
    """Where ``name`` belongs: into the folder ``out``, or beside the file ``out``, with whose name it begins."""
    return out / name if kind_of(out) == FOLDER else out.with_name(f"{out.stem}_{name}")


def picture_name(number: int) -> str:
    """Of a folder's picture, counted from 0."""
    return f"{number:04d}.png"


def check_folder(folder: Path, count: int) -> None:
    """ExistsError if ``folder`` has pictures beside which, or in place of which, ``count`` new ones would mislead."""
    if not folder.is_dir():
        return
    there = sorted(file.name for file in folder.iterdir() if file.suffix.lower() in PICTURE_SUFFIXES)
    new = {picture_name(number) for number in range(count)}
    ours = (folder / "truth.yaml").is_file()
    foreign = [name for name in there if name not in new or not ours]
    if foreign:
        raise ExistsError(
            f"{folder} has pictures that would be mixed with the new ones ({foreign[0]}"
            f"{f' and {len(foreign) - 1} more' if len(foreign) > 1 else ''}): name another folder, or remove them"
        )


def write_folder(folder: Path, shots: Iterable[Shot], count: int, on_picture: OnPicture | None = None) -> int:
    """Writes 0000.png, ... and frames.csv with their times; the number of pictures. ExistsError as check_folder."""
    from PIL import Image

    from pilotfish.harness.sequences import FRAMES_FILE

    check_folder(folder, count)
    folder.mkdir(parents=True, exist_ok=True)
    rows = ["file,utime_us"]
    for number, shot in enumerate(shots):
        Image.fromarray(shot.image).save(folder / picture_name(number), compress_level=1)
        rows.append(f"{picture_name(number)},{shot.utime}")
        if on_picture:
            on_picture(number + 1, count)
    (folder / FRAMES_FILE).write_text("\n".join(rows) + "\n")
    return len(rows) - 1


def write_film(file: Path, shots: Iterable[Shot], count: int, on_picture: OnPicture | None = None) -> int:
    """Writes an MP4 (H.264); the number of pictures. MissingPackageError without PyAV; ConfigError for an odd size."""
    av = require("av", "export")
    written = 0
    try:
        with written_whole(file) as partial, av.open(str(partial), "w", format="mp4") as container:
            stream = container.add_stream("libx264", rate=30, options=_QUALITY)
            stream.pix_fmt = "yuv420p"
            stream.codec_context.time_base = stream.time_base = _TIME_BASE
            for shot in shots:
                if not written:
                    stream.height, stream.width = shot.image.shape
                frame = av.VideoFrame.from_ndarray(np.repeat(shot.image[..., None], 3, axis=2), format="rgb24")
                frame.pts, frame.time_base = shot.utime, _TIME_BASE
                container.mux(stream.encode(frame))
                written += 1
                if on_picture:
                    on_picture(written, count)
            container.mux(stream.encode(None))
    except av.codec.codec.UnknownCodecError as error:
        raise MissingPackageError(f"this PyAV has no encoder for H.264 ({error}): write a folder instead") from error
    except av.error.FFmpegError as error:
        raise OSError(error.errno, error.strerror, str(file)) from error
    return written


def write_log(
    file: Path,
    robot: str,
    shots: Iterable[Shot],
    odometry: Iterable[Pose],
    count: int,
    on_picture: OnPicture | None = None,
) -> int:
    """Writes ROBOT_IMAGE (gray) and ROBOT_POSE in the order of their times; the number of pictures."""
    import lcm

    from pilotfish.bus import channel

    images, poses = channel(robot, "IMAGE"), channel(robot, "POSE")
    written = 0
    with written_whole(file) as partial:
        log = lcm.EventLog(str(partial), "w", overwrite=True)
        try:
            for each in _by_time(shots, odometry):
                if isinstance(each, Pose):
                    log.write_event(each.utime, poses, _pose_message(each))
                    continue
                log.write_event(each.utime, images, _image_message(each))
                written += 1
                if on_picture:
                    on_picture(written, count)
        finally:
            log.close()
    return written


def _by_time(shots: Iterable[Shot], odometry: Iterable[Pose]) -> Iterator[Shot | Pose]:
    """Both are in order of their times."""
    poses = iter(odometry)
    pose = next(poses, None)
    for shot in shots:
        while pose is not None and pose.utime <= shot.utime:
            yield pose
            pose = next(poses, None)
        yield shot
    while pose is not None:
        yield pose
        pose = next(poses, None)


def _image_message(shot: Shot) -> bytes:
    from pilotfish.lcmtypes.bot_core import image_t

    message = image_t()
    message.utime = shot.utime
    message.height, message.width = shot.image.shape
    message.row_stride, message.pixelformat = message.width, image_t.PIXEL_FORMAT_GRAY
    message.data = shot.image.tobytes()
    message.size = len(message.data)
    return message.encode()


def _pose_message(pose: Pose) -> bytes:
    from pilotfish.lcmtypes.bot_core import pose_t

    message = pose_t()
    message.utime = pose.utime
    message.pos = [pose.x_m, pose.y_m, 0.0]
    message.orientation = [float(np.cos(pose.heading_rad / 2)), 0.0, 0.0, float(np.sin(pose.heading_rad / 2))]
    return message.encode()

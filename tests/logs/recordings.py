"""Recordings for tests: of the real programs, and written event by event."""

from __future__ import annotations

import io
import signal
import struct
import subprocess
import sysconfig
import time
from dataclasses import dataclass
from pathlib import Path

import lcm
import numpy as np
from PIL import Image

from pilotfish import data as shipped
from pilotfish.harness.child import Child
from pilotfish.harness.over_lcm import run_over_lcm
from pilotfish.harness.ports import private_lcm_url
from pilotfish.harness.scenario import Scenario
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import (
    command_t,
    counter_t,
    observation_t,
    setpoint_t,
    stage_t,
    status_t,
    tag_detection_t,
)

WALL_US = 1_764_000_000_000_000  # when the written recordings begin
STAMP_US = 5_000_000  # of their first frame
PERIOD_US = 33_333
TRACKING, COASTING, LOST = command_t.STATUS_TRACKING, command_t.STATUS_COASTING, command_t.STATUS_LOST
STOPPED = command_t.STATUS_STOPPED
NO_TAG, NO_FRAME, STOP_REQUESTED = 1, 5, 13  # numbers of pilotfish::Reason


@dataclass(frozen=True)
class Recorded:
    """The same run twice: as the coordinator recorded itself, and as lcm-logger heard it."""

    box: Path
    bus: Path


def record(folder: Path, scenario: str, profile: str, duration_s: float) -> Recorded:
    """The real programs in lock-step."""
    url, bus = private_lcm_url(), folder / "bus.lcmlog"
    logger = Path(sysconfig.get_path("scripts")) / "lcm-logger"
    with Child([logger, "-q", "-l", url, bus], folder, "lcm-logger") as child:
        knock = lcm.LCM(url)

        def listens() -> bool:
            knock.publish("KNOCK", b"")
            return bus.exists() and bus.stat().st_size > 0

        child.wait_until(listens, 20.0, "hearing something")
        run_over_lcm(
            Scenario.load(shipped.path(f"scenarios/{scenario}.yaml")),
            profile=profile,
            duration_s=duration_s,
            lcm_url=url,
            coordinator_options=["--black-box", str(folder / "box")],
        )
        size, deadline = -1, time.monotonic() + 20.0
        while size != bus.stat().st_size and time.monotonic() < deadline:  # until it has written all that it heard
            size = bus.stat().st_size
            try:
                child.process.wait(0.3)
            except subprocess.TimeoutExpired:
                continue
        child.process.send_signal(signal.SIGINT)
        child.process.wait(10)
    return Recorded(folder / "box", bus)


def event(utime: int, channel: str, data: bytes, number: int = 0) -> bytes:
    """One event of a log, as lcm-logger writes it."""
    return struct.pack(">Iqqii", 0xEDA1DA01, number, utime, len(channel), len(data)) + channel.encode() + data


class Writer:
    """Writes a log; ``wall_us`` is the time at which the next event is recorded."""

    def __init__(self, file: Path, robot: str = "ROBOT1", session: int = 77) -> None:
        self.file, self.robot, self.session = file, robot, session
        self.wall_us, self.stamp_us, self.counter = WALL_US, STAMP_US, 0
        self.file.write_bytes(b"")

    def write(self, kind: str, message: object) -> None:
        self.raw(f"{self.robot}_{kind}", message.encode())

    def raw(self, channel: str, data: bytes) -> None:
        with self.file.open("ab") as stream:
            stream.write(event(self.wall_us, channel, data))

    def passes(self, us: int = PERIOD_US) -> None:
        self.wall_us += us
        self.stamp_us += us

    def frame(self, distance_m: float | None = 1.0, **status: object) -> None:
        """What a coordinator says of one frame: command, observation, status."""
        self.command(TRACKING if distance_m is not None else LOST, 0 if distance_m is not None else NO_TAG)
        self.write("OBSERVATION", self.observation(distance_m))
        self.write("STATUS", self.status(distance_m, **status))

    def command(self, status: int = TRACKING, reason: int = 0, linear_mps: float = 0.1, skipped: int = 0) -> None:
        self.counter += 1 + skipped
        message = command_t()
        message.mac = bytes(32)
        message.utime, message.session, message.counter = self.stamp_us, self.session, self.counter
        message.status, message.reason, message.linear_mps = status, reason, linear_mps
        self.write("COMMAND", message)

    def observation(self, distance_m: float | None, reason: int | None = None) -> observation_t:
        message = observation_t()
        message.utime, message.detected = self.stamp_us, distance_m is not None
        message.reason = reason if reason is not None else 0 if message.detected else NO_TAG
        message.distance_m, message.latency_s = distance_m or 0.0, 0.002
        message.covariance = [[4e-6, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 9e-4]]
        if message.detected:
            tag = tag_detection_t()
            tag.id, tag.decision_margin = 3, 90.0
            tag.corners_px = [[10.0, 40.0], [40.0, 40.0], [40.0, 10.0], [10.0, 10.0]]
            message.tags, message.tag_count = [tag], 1
        return message

    def status(
        self,
        distance_m: float | None = 1.0,
        *,
        setpoint_m: float = 1.1,
        run: bool = True,
        rejected: dict[str, int] | None = None,
        stages: dict[str, list[int]] | None = None,
        reason: int | None = None,
    ) -> status_t:
        message = status_t()
        message.utime, message.session = self.stamp_us, self.session
        message.status = TRACKING if distance_m is not None else LOST
        message.reason = reason if reason is not None else 0 if distance_m is not None else NO_TAG
        message.setpoint_distance_m, message.setpoint_run = setpoint_m, run
        message.error_m = setpoint_m - distance_m if distance_m is not None else 0.0
        for name, count in (rejected or {}).items():
            counter = counter_t()
            counter.name, counter.count = name, count
            message.rejected.append(counter)
        for name, counts in (stages or {}).items():
            stage = stage_t()
            stage.name, stage.counts, stage.max_ms = name, counts, float(sum(counts))
            message.stages.append(stage)
        message.rejected_count, message.stage_count = len(message.rejected), len(message.stages)
        return message

    def setpoint(self) -> None:
        """What somebody asks for, and is not taken."""
        message = setpoint_t()
        message.distance_m, message.mac = 9.0, bytes(32)
        self.write("SETPOINT", message)

    def image(self, pixels: np.ndarray, *, jpeg: bool = False) -> None:
        message = image_t()
        message.utime, (message.height, message.width) = self.stamp_us, pixels.shape[:2]
        if jpeg:
            stream = io.BytesIO()
            Image.fromarray(pixels).save(stream, "JPEG", quality=95)
            message.pixelformat, message.data = image_t.PIXEL_FORMAT_MJPEG, stream.getvalue()
        else:
            gray = pixels.ndim == 2
            message.pixelformat = image_t.PIXEL_FORMAT_GRAY if gray else image_t.PIXEL_FORMAT_BGR
            message.row_stride = message.width * (1 if gray else 3)
            message.data = pixels.tobytes()
        message.size = len(message.data)
        self.write("IMAGE", message)

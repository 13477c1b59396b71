"""One robot's run as equally long arrays, and its CSV form.

The CSV is the one ``pilotfish-sim --record`` writes: a header, then one row per robot and camera period. A
file of ours may begin with ``# key: value`` lines (the setpoint and where the run came from) and has three
more columns with what the coordinator measured; both are optional when reading.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pilotfish.errors import RecordingError
from pilotfish.files import read_text
from pilotfish.whole_files import written_whole

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Meta:
    """Whose run it is and what it was asked to keep."""

    robot: str = "robot1"
    leader: str = "leader"
    scenario: str = ""
    profile: str = ""
    transport: str = ""  # "lcm" or "in-process"
    distance_setpoint_m: float = float("nan")  # d_p
    bearing_setpoint_rad: float = float("nan")  # theta_pd


@dataclass(frozen=True)
class Recording:
    """One robot's run: every array has shape (N,), one element per camera period.

    Poses are in the world frame; ``true_*`` are the leader's, relative to the robot's base frame (x forward,
    y left); ``measured_*`` are what the coordinator saw, NaN where it saw nothing; ``command_*`` is the
    answer to this picture.
    """

    meta: Meta
    time_s: FloatArray
    utime_us: NDArray[np.int64]
    x_m: FloatArray
    y_m: FloatArray
    heading_rad: FloatArray
    linear_mps: FloatArray
    angular_radps: FloatArray
    leader_x_m: FloatArray
    leader_y_m: FloatArray
    leader_heading_rad: FloatArray
    leader_linear_mps: FloatArray
    true_distance_m: FloatArray
    true_bearing_rad: FloatArray
    true_heading_rad: FloatArray
    command_linear_mps: FloatArray
    command_angular_radps: FloatArray
    status: NDArray[np.str_]
    delivered: NDArray[np.bool_]  # False where the camera dropped the frame
    measured_distance_m: FloatArray
    measured_bearing_rad: FloatArray
    measured_heading_rad: FloatArray

    def __post_init__(self) -> None:
        lengths = {name: len(getattr(self, name)) for name in COLUMNS}
        if len(set(lengths.values())) != 1:
            raise RecordingError(f"columns of different lengths: {lengths}")
        if not len(self):
            raise RecordingError("a recording needs at least one row")
        if np.any(np.diff(self.time_s) <= 0):
            raise RecordingError("time_s does not increase")

    def __len__(self) -> int:
        return len(self.time_s)

    @property
    def distance_error_m(self) -> FloatArray:
        """e(t) = d_p - d(t), shape (N,), of the true distance; positive: too close."""
        return self.meta.distance_setpoint_m - self.true_distance_m

    @property
    def bearing_error_rad(self) -> FloatArray:
        """theta(t) - theta_pd in (-pi, pi], shape (N,), of the true bearing; positive: the leader is too far
        left."""
        return wrap_angle(self.true_bearing_rad - self.meta.bearing_setpoint_rad)

    def with_meta(self, **changes: Any) -> Recording:
        """The same run with other words about it."""
        return replace(self, meta=replace(self.meta, **changes))

    def with_measurements(self, measured: Mapping[int, tuple[float, float, float]]) -> Recording:
        """The same run with (distance_m, bearing_rad, heading_rad) by ``utime_us``; what is not named becomes
        NaN."""
        nothing = (np.nan, np.nan, np.nan)
        rows = np.array([measured.get(int(utime), nothing) for utime in self.utime_us], dtype=float)
        return replace(
            self,
            measured_distance_m=rows[:, 0],
            measured_bearing_rad=rows[:, 1],
            measured_heading_rad=rows[:, 2],
        )

    @classmethod
    def from_rows(cls, rows: Iterable[Mapping[str, Any]], meta: Meta) -> Recording:
        """From one mapping a row; a column that is missing in all rows must be an optional one."""
        table = list(rows)
        if not table:
            raise RecordingError(f"no rows of robot '{meta.robot}'")
        columns = {name: [row.get(name, _OPTIONAL.get(name)) for row in table] for name in COLUMNS}
        missing = [name for name, values in columns.items() if any(value is None for value in values)]
        if missing:
            raise RecordingError(f"missing column or value: {', '.join(missing)}")
        try:
            return cls(meta=meta, **{name: _to_array(name, values) for name, values in columns.items()})
        except (ValueError, OverflowError) as error:
            raise RecordingError(f"not a recording: {error}") from error

    @classmethod
    def from_csv(cls, file: str | Path, robot: str | None = None) -> Recording:
        """The run of ``robot``, which need not be named if there is one robot in the file."""
        runs = read_csv(file)
        if robot is None and len(runs) == 1:
            return next(iter(runs.values()))
        if robot not in runs:
            asked = "name the robot" if robot is None else f"there is no robot '{robot}'"
            raise RecordingError(f"{file}: {asked}; in the file: {', '.join(runs)}")
        return runs[robot]

    def to_csv(self, file: str | Path) -> Path:
        """Writes the run; ``from_csv`` gives back the same bits."""
        file = Path(file)
        with written_whole(file) as partial, partial.open("w", newline="") as stream:
            for field in fields(Meta):
                stream.write(f"# {field.name}: {getattr(self.meta, field.name)}\n")
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(["robot", "leader", *COLUMNS])
            for row in zip(*(getattr(self, name).tolist() for name in COLUMNS), strict=True):
                writer.writerow([self.meta.robot, self.meta.leader, *map(_to_text, row)])
        return file


COLUMNS: tuple[str, ...] = tuple(field.name for field in fields(Recording) if field.name != "meta")
_OPTIONAL = {name: "nan" for name in COLUMNS if name.startswith("measured_")} | {"delivered": "1"}


def read_csv(file: str | Path) -> dict[str, Recording]:
    """Every robot's run in a recording, by the robot's name, in the order of the file."""
    file = Path(file)
    lines = read_text(file, RecordingError).splitlines()
    notes = dict(line[1:].strip().partition(": ")[::2] for line in lines if line.startswith("#"))
    reader = csv.DictReader(line for line in lines if line and not line.startswith("#"))
    rows: dict[str, list[dict[str, str]]] = {}
    try:
        if not {"robot", "leader"} <= set(reader.fieldnames or ()):
            raise RecordingError(f"{file}: not a recording (no columns 'robot' and 'leader')")
        for row in reader:
            rows.setdefault(row["robot"], []).append(row)
    except csv.Error as error:
        raise RecordingError(f"{file}: not a recording, line {reader.line_num}: {error}") from error
    if not rows:
        raise RecordingError(f"{file}: a header, but no rows")
    try:
        return {name: Recording.from_rows(own, _to_meta(name, own[0], notes)) for name, own in rows.items()}
    except RecordingError as error:
        raise RecordingError(f"{file}: {error}") from error


def wrap_angle(angle_rad: FloatArray) -> FloatArray:
    """The same angles in (-pi, pi], any shape."""
    return np.pi - np.mod(np.pi - angle_rad, 2.0 * np.pi)


def _to_meta(robot: str, row: Mapping[str, str], notes: Mapping[str, str]) -> Meta:
    known = {field.name: field.type for field in fields(Meta)}
    try:
        said = {k: float(v) if known[k] == "float" else v for k, v in notes.items() if k in known}
    except ValueError as error:
        raise RecordingError(f"a setpoint is not a number: {error}") from error
    return replace(Meta(**said), robot=robot, leader=row["leader"])


def _to_array(name: str, values: list[Any]) -> NDArray[Any]:
    if name == "status":
        return np.array(values, dtype=np.str_)
    if name == "utime_us":
        return np.array([int(value) for value in values], dtype=np.int64)
    if name == "delivered":
        return np.array([int(value) != 0 for value in values], dtype=np.bool_)
    return np.array(values, dtype=np.float64)


def _to_text(value: Any) -> str:
    return str(int(value)) if isinstance(value, bool) else repr(value) if isinstance(value, float) else str(value)

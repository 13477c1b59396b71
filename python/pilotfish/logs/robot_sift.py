"""One robot's messages become rows of tables, and events where something changes."""

from __future__ import annotations

import math
from collections import OrderedDict
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pilotfish.lcmtypes.pilotfish import step_t
from pilotfish.logs.beginning import late_text
from pilotfish.logs.clock import RunClock
from pilotfish.logs.columns import COMMANDS, FRAMES, NONE
from pilotfish.logs.frame_rows import FrameRows
from pilotfish.logs.messages import Message
from pilotfish.logs.notes import RobotNotes, Stage, settings_of

Row = tuple[str, dict[str, Any]]  # table, values by column
GAP_S = 1.0  # longer without a frame is an event
_COMMANDS_KEPT = 64
_STATUSES_AWAITED = 5  # a coordinator sends a command with every status; a recording may have none
_FIRST_COMMANDS = 20  # a recorder that is ready a second after the program has missed no approach
_WORDS = {column.name: column for column in (*FRAMES, *COMMANDS) if column.words}


@dataclass
class _Session:
    """What one coordinator has counted since its start."""

    counted: dict[str, int] = field(default_factory=dict)
    staged: dict[str, Stage] = field(default_factory=dict)
    next_call: int = NONE
    box_losses: int = 0
    last_counter: int = 0


class RobotSift:
    """``take`` a message, get the rows that are complete by then."""

    def __init__(self, start_utime: int, notes: RobotNotes) -> None:
        self._clock = RunClock(start_utime)
        self._frames = FrameRows(self._clock)
        self._notes = notes
        self._rows: list[Row] = []
        self._status: tuple[int, int] | None = None
        self._setpoint: tuple[float, float, bool] | None = None
        self._session = 0
        self._began: tuple[int, int] | None = None  # session and when it was first heard, until its beginning is known
        self._statuses_before = 0  # the first command of this session
        self._file = Path()
        self._late = False  # this session was running before the recording began
        self._of = _Session()  # of the session that speaks
        self._sessions: dict[int, _Session] = {0: self._of}  # two coordinators of one name take turns
        self._taking_turns = False
        self._sent: OrderedDict[tuple[int, int], None] = OrderedDict()
        self._last_frame_s = math.nan

    def take(self, message: Message) -> list[Row]:
        """The rows that this message completes."""
        self._file = message.event.file
        handler = getattr(self, f"on_{message.kind.lower()}", None)
        if handler is not None:
            handler(message.event.utime, message.content)
        return self._drain()

    def note(self, log_utime: int, kind: str, text: str) -> list[Row]:
        """An event that is not this robot's alone."""
        self._event(log_utime, kind, text)
        return self._drain()

    def end(self) -> list[Row]:
        """What is left."""
        return self._drain(at_end=True)

    def _drain(self, *, at_end: bool = False) -> list[Row]:
        for frame in self._frames.finished(at_end=at_end):
            t_s = frame.values["t_s"]
            if t_s - self._last_frame_s > GAP_S:
                text = f"no frame for {t_s - self._last_frame_s:.2f} s"
                self._rows.append(
                    ("events", {"t_s": self._last_frame_s, "log_utime_us": NONE, "kind": "gap", "text": text})
                )
            self._last_frame_s = t_s
            self._rows.append(("frames", frame.values))
            self._rows += [("tags", tag) for tag in frame.tags]
        rows, self._rows = self._rows, []
        return rows

    def _event(self, log_utime: int, kind: str, text: str) -> None:
        values = {"t_s": self._clock.at(log_utime), "log_utime_us": log_utime, "kind": kind, "text": text}
        self._rows.append(("events", values))

    # One method for every kind of message, of its name.

    def on_box(self, log_utime: int, message: Any) -> None:
        """A place to replay from: who, with what settings, what was lost."""
        self._notes.name = message.robot
        self._session_now(log_utime, message.session)
        self._begins(before=message.sequence, of="calls of the core")
        if self._of.next_call not in (NONE, message.sequence):
            self._event(log_utime, "gap", f"{message.sequence - self._of.next_call} calls are missing")
        self._of.next_call = message.sequence
        if (losses := message.dropped + message.lost) > self._of.box_losses:
            self._event(log_utime, "gap", f"the black box has lost {losses - self._of.box_losses} events")
        self._of.box_losses = losses
        settings = settings_of(message)
        if settings not in self._notes.settings:
            self._notes.settings.append(settings)
            self._event(log_utime, "configuration", settings.program)

    def on_step(self, log_utime: int, message: Any) -> None:
        """A call of the core."""
        if self._of.next_call not in (NONE, message.sequence):
            self._event(log_utime, "gap", f"{message.sequence - self._of.next_call} calls are missing")
        self._of.next_call = message.sequence + 1
        twist = {"utime_us": message.utime, "linear_mps": message.linear_mps, "angular_radps": message.angular_radps}
        if message.kind == step_t.KIND_FRAME:
            self._frames.step(log_utime, message)
        elif message.kind == step_t.KIND_SETPOINT and message.taken:
            self._setpoint_now(log_utime, message.distance_m, message.bearing_rad, bool(message.run), asked=True)
        elif message.kind == step_t.KIND_OWN_MOTION:
            self._rows.append(("odometry", {"t_s": self._clock.at(log_utime)} | twist))
        elif message.kind == step_t.KIND_LEADER_INTENT:
            self._rows.append(("intents", {"t_s": self._clock.at(log_utime)} | twist))

    def on_observation(self, log_utime: int, message: Any) -> None:
        """What was seen in a frame, as published."""
        self._frames.observation(log_utime, message)

    def on_status(self, log_utime: int, message: Any) -> None:
        """The law's intermediate results, the setpoint that was taken, counters, stages."""
        self._session_now(log_utime, message.session)
        self._frames.status(log_utime, message)
        self._setpoint_now(
            log_utime, message.setpoint_distance_m, message.setpoint_bearing_rad, bool(message.setpoint_run)
        )
        for counter in message.rejected:
            if counter.name not in self._of.counted:
                self._event(log_utime, "counter", f"{counter.name}: {counter.count}, the first in this recording")
            self._of.counted[counter.name] = counter.count
        self._of.staged |= {stage.name: Stage(list(stage.counts), stage.max_ms) for stage in message.stages}
        self._sum_up()

    def on_command(self, log_utime: int, message: Any) -> None:
        """A command as it went over the bus."""
        self._frames.command(message)
        self._notes.simulated = self._notes.simulated or bool(message.simulated)
        self._sent_command(log_utime, message.utime, message)

    def on_sent(self, log_utime: int, message: Any) -> None:
        """The same as it was decided."""
        self._sent_command(log_utime, message.held.utime, message)

    def on_base(self, log_utime: int, message: Any) -> None:
        """What the wheels do."""
        values = {name: getattr(message, name) for name in ("linear_mps", "angular_radps", "state")}
        values |= {"t_s": self._clock.at(log_utime), "log_utime_us": log_utime, "stopped": bool(message.stopped)}
        if message.measured:
            values |= {name: getattr(message, name) for name in ("measured_linear_mps", "measured_angular_radps")}
        self._rows.append(("wheels", values))

    def on_pose(self, log_utime: int, message: Any) -> None:
        """A robot's odometry, or a simulator's truth."""
        w, x, y, z = message.orientation
        heading_rad = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
        values = {"t_s": self._clock.at(log_utime), "utime_us": message.utime, "heading_rad": heading_rad}
        self._rows.append(("poses", values | {"x_m": message.pos[0], "y_m": message.pos[1]}))

    def on_motion(self, log_utime: int, message: Any) -> None:
        """What a robot announces."""
        values = {name: getattr(message, name) for name in ("linear_mps", "angular_radps")}
        self._rows.append(("intents", values | {"t_s": self._clock.at(log_utime), "utime_us": message.utime}))

    # What is watched for changes.

    def _sent_command(self, log_utime: int, utime: int, message: Any) -> None:
        """A black box has each command twice: as it was decided, and as it went over the bus."""
        key = (message.session, message.counter)
        if key in self._sent:
            return
        self._sent[key] = None
        while len(self._sent) > _COMMANDS_KEPT:
            self._sent.popitem(last=False)
        self._session_now(log_utime, message.session)
        self._begins(before=message.counter - 1 if message.counter > _FIRST_COMMANDS else 0, of="commands")
        missing = message.counter - self._of.last_counter - 1
        if self._of.last_counter and missing > 0:
            self._event(log_utime, "gap", f"{missing} commands are missing in the recording")
        self._of.last_counter = max(self._of.last_counter, message.counter)
        values = {name: getattr(message, name) for name in ("session", "counter", "status", "reason")}
        values |= {"linear_mps": message.linear_mps, "angular_radps": message.angular_radps, "utime_us": utime}
        self._rows.append(("commands", {"t_s": self._clock.at(log_utime), "log_utime_us": log_utime} | values))
        if (message.status, message.reason) != self._status:
            self._status = (message.status, message.reason)
            status, reason = _WORDS["status"].word(message.status), _WORDS["reason"].word(message.reason)
            self._event(log_utime, "status", status if message.reason == 0 else f"{status}: {reason}")

    def _setpoint_now(
        self, log_utime: int, distance_m: float, bearing_rad: float, run: bool, *, asked: bool = False
    ) -> None:
        if self._began is not None:  # a status comes before the first command: has it begun here, or long ago?
            self._statuses_before += 1
            if self._statuses_before <= _STATUSES_AWAITED:
                return
        before, self._setpoint = self._setpoint, (distance_m, bearing_rad, run)
        where = f"{distance_m:g} m at {math.degrees(bearing_rad):.6g}°"
        self._begins(before=0, of="")  # neither a command nor a black box has said more
        if before is None and self._late and not asked:
            self._event(log_utime, "begin", f"{'keeps' if run else 'stopped; would keep'} {where}, as before")
        elif before is None or before[:2] != (distance_m, bearing_rad):
            self._event(log_utime, "setpoint", where)
        if before is None and not run and not self._late:
            self._event(log_utime, "stop", "stopped from the start")
        elif before is not None and before[2] != run:
            self._event(log_utime, "resume" if run else "stop", where)

    def _session_now(self, log_utime: int, session: int) -> None:
        if session in (0, self._session):
            return
        known = session in self._sessions
        self._session, self._of = session, self._sessions.setdefault(session, _Session())
        if not known:
            self._notes.sessions.append(session)
            self._began, self._statuses_before = (session, log_utime), 0
        elif not self._taking_turns:  # said once: they may do so for hours
            self._taking_turns = True
            self._event(log_utime, "start", f"two coordinators take turns: session {session} speaks again")

    def _begins(self, *, before: int, of: str) -> None:
        """Whether the session that was just heard of started here: ``before`` calls or commands of it are not in the
        recording."""
        if self._began is None:
            return
        (session, log_utime), self._began = self._began, None
        self._late = before > 0
        if not self._late:
            self._event(log_utime, "start", f"session {session} of the coordinator")
            return
        self._event(log_utime, "begin", late_text(self._file, log_utime, f"{before} {of} of session {session}"))

    def _sum_up(self) -> None:
        self._notes.counters, self._notes.stages = self._counter_sums(), self._stage_sums()

    def _counter_sums(self) -> dict[str, int]:
        sums: dict[str, int] = {}
        for session in self._sessions.values():
            for name, count in session.counted.items():
                sums[name] = sums.get(name, 0) + count
        return sums

    def _stage_sums(self) -> dict[str, Stage]:
        sums: dict[str, Stage] = {}
        for session in self._sessions.values():
            for name, stage in session.staged.items():
                if (before := sums.get(name)) is not None:
                    counts = [a + b for a, b in zip(before.counts, stage.counts, strict=True)]
                    stage = Stage(counts, max(before.max_ms, stage.max_ms))
                sums[name] = stage
        return sums

"""A recording, computed again: the same core is given the same calls and must give the same bits."""

from __future__ import annotations

from collections import OrderedDict, deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from pilotfish import core
from pilotfish.black_box import causes, messages
from pilotfish.black_box.exact_text import answer_text, held_text, observation_text
from pilotfish.black_box.log import Damage, Event
from pilotfish.black_box.recorded_config import recorded_config
from pilotfish.coordinator import Coordinator, CoordinatorFile, StepResult, step_values
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import box_start_t, measurement_t, observation_t, sent_t, status_t, step_t

_KINDS = {
    step_t.KIND_FRAME: "frame",
    step_t.KIND_SETPOINT: "setpoint",
    step_t.KIND_OWN_MOTION: "own motion",
    step_t.KIND_LEADER_INTENT: "leader_intent",
    step_t.KIND_RANGES: "ranges",
}
# The sender holds what one of the last frames led to; its thread and the core's record in any order.
_HELD_BACK, _HELD_AHEAD = 64, 4
_PICTURES_KEPT = 64
# Of a frame that is refused by its time the pixels are not looked at.
_REFUSED_BY_TIME = {
    core.Reason.frame_time_not_advancing,
    core.Reason.frame_time_implausible,
    core.Reason.frame_stale,
}
_TRACES = {"_OBSERVATION": observation_t, "_STATUS": status_t}
# Why a sender sends zeros whatever it holds.
_WITHHELD = {core.Reason.another_coordinator, core.Reason.internal_error, core.Reason.stop_requested}


@dataclass
class Difference:
    """Where the recording and the computation part."""

    event: Event
    what: str
    inputs: str
    recorded: str
    recomputed: str
    agreed_before: int = 0  # calls since the last start or compared memory, all of which agreed
    causes: list[str] = field(default_factory=list)  # which input, which stage: see causes.py


@dataclass
class ReplayReport:
    """What a replay has compared, and where it found something else."""

    programs: list[str] = field(default_factory=list)
    starts: int = 0  # places to replay from, of which the first of a run is one
    calls: int = 0
    frames: int = 0
    measured: int = 0
    commands: int = 0  # of frames, compared
    sent: int = 0  # commands that were sent, compared
    sent_unchecked: int = 0  # what they held was decided before the replay begins
    memories: int = 0  # of the core, at a start within a run, compared
    observations: int = 0  # made again in recorded pictures, compared
    observations_unchecked: int = 0
    gaps: int = 0
    skipped: int = 0  # calls behind a gap, before the next start
    damage: list[Damage] = field(default_factory=list)
    unreadable: int = 0  # events on our channels that are no messages of these types
    differences: int = 0
    first_difference: Difference | None = None


def replay(
    events: Iterable[Event | Damage],
    *,
    from_pixels: bool = False,
    on_progress: Callable[[int, int | None], None] | None = None,
) -> ReplayReport:
    """Every command is recomputed from the recorded calls; with ``from_pixels`` every observation as well, as far as
    there are the pictures that were seen. ConfigError if this program refuses the recorded configuration,
    RecordingError if that is damaged."""
    run = _Run(from_pixels)
    handlers = {"_BOX": run.start, "_STEP": run.step, "_SENT": run.sent}
    for count, event in enumerate(events):
        if on_progress and count % 100 == 0:
            on_progress(count, None)
        if isinstance(event, Damage):
            run.report.damage.append(event)
            continue
        suffix = event.channel[event.channel.rfind("_") :]
        types = {"_BOX": box_start_t, "_STEP": step_t, "_SENT": sent_t}
        try:
            message = types[suffix].decode(event.data) if suffix in types else messages.original_picture(event.data)
        except Exception:  # lcm-gen's decoders raise whatever the bytes lead to
            run.report.unreadable += 1
            continue
        if suffix in types:
            handlers[suffix](event, message)
        elif suffix in _TRACES:
            run.trace(suffix, event)
        elif message is not None:
            run.picture(message)
    run.resolve_sent(at_end=True)
    return run.report


_OTHER_BUILD = "another build of the program made the recording: what it remembers has another size"


@dataclass(frozen=True)
class _Traced:
    """The frame whose command was the first to differ; what was published of it follows in the recording."""

    utime: int
    measurement: measurement_t | None
    values: dict[str, object]
    difference: Difference


class _Run:
    def __init__(self, from_pixels: bool) -> None:
        self.report = ReplayReport()
        self._from_pixels = from_pixels
        self._core: Coordinator | None = None
        self._config: tuple[bytes, CoordinatorFile | None] = (b"", None)
        self._session = 0
        self._next = -1  # sequence of the call that must come
        self._sees = False  # what the vision remembers is known
        self._pictures: OrderedDict[int, image_t] = OrderedDict()
        self._held: deque[tuple[object, ...]] = deque(maxlen=_HELD_BACK)
        self._pending: deque[tuple[int, Event, sent_t]] = deque()
        self._frames_since_start = 0
        self._agreed = 0
        self._traced: _Traced | None = None

    def start(self, event: Event, message: box_start_t) -> None:
        if self._core is not None and (message.session, message.sequence) == (self._session, self._next):
            self._compare_memory(event, message)
            return
        self.resolve_sent(at_end=True)
        self._session, self._next = message.session, message.sequence
        self.report.starts += 1
        if message.program not in self.report.programs:
            self.report.programs.append(message.program)
        self._core = Coordinator(self._config_of(event, message).coordinator)
        recorded = (bytes(message.decisions), bytes(message.vision))
        if message.sequence == 0 and self._core.memory != recorded:
            self._differs(
                event,
                "the coordinator at the start",
                message.robot,
                _size(recorded),
                _size(self._core.memory),
                None if _size(recorded) == _size(self._core.memory) else _OTHER_BUILD,
            )
        try:
            self._core.memory = recorded
        except ValueError as error:
            self._differs(event, "what the core remembers", message.program, _size(recorded), str(error))
            self._core = None
            return
        self._sees = True
        self._frames_since_start = self._agreed = 0
        self._held.clear()
        self._held.append(messages.held_key(self._core.held))

    def step(self, event: Event, message: step_t) -> None:
        if self._core is not None and message.sequence != self._next:
            self.report.gaps += 1
            self.resolve_sent(at_end=True)
            self._core = None
        if self._core is None:
            self.report.skipped += 1
            return
        try:
            observation = messages.observation_of(message.measurement[0]) if message.measurement else None
        except ValueError:  # no pose: the event is damaged
            self.report.unreadable += 1
            self._core = None
            return
        self._next += 1
        self.report.calls += 1
        if message.kind == step_t.KIND_FRAME:
            self._frame(event, message, observation)
        else:
            self._other_call(event, message)
        recorded, held = messages.held_of(message.held), self._core.held
        self._expect(
            event,
            message,
            "what is held",
            held_text(recorded),
            held_text(held),
            lambda: causes.held_cause(recorded, held),
        )
        self._agreed += 1
        self._held.append(messages.held_key(held))
        self.resolve_sent(at_end=False)

    def sent(self, event: Event, message: sent_t) -> None:
        """Computed at once from what the sender held; whether that was right is seen a little later."""
        held = messages.held_of(message.held)
        status, reason, command = held.at(message.now_us, core.Reason(message.missing))
        if message.missing == core.Reason.none.value and message.status == core.Status.tracking.value:
            # Nothing was missing: the answer to a frame with the leader in it, while what is held only coasts.
            status = core.Status.tracking if status == core.Status.coasting else status
        recorded = core.Twist(linear_mps=message.linear_mps, angular_radps=message.angular_radps)
        self.report.sent += 1
        withheld = core.Reason(message.reason) in _WITHHELD and recorded == core.Twist()
        if not withheld:
            was = answer_text(core.Status(message.status), core.Reason(message.reason), recorded)
            inputs = f"sent at {message.now_us} us, missing: {core.Reason(message.missing).name}"
            if was != (now := answer_text(status, reason, command)):
                parts = (core.Status(message.status), core.Reason(message.reason), recorded)
                cause = causes.answer_cause(parts, (status, reason, command))
                self._differs(event, "a command that was sent", inputs, was, now, cause)
        self._pending.append((self._next + _HELD_AHEAD, event, message))

    def picture(self, message: image_t) -> None:
        if self._from_pixels:
            self._pictures[message.utime] = message
            self._pictures.move_to_end(message.utime)
            while len(self._pictures) > _PICTURES_KEPT:
                self._pictures.popitem(last=False)

    def resolve_sent(self, *, at_end: bool) -> None:
        while self._pending and (at_end or self._pending[0][0] <= self._next):
            _, event, message = self._pending.popleft()
            held = messages.held_of(message.held)
            if messages.held_key(held) in self._held:
                continue
            if self._core is None or self._frames_since_start < _HELD_BACK or at_end:
                self.report.sent_unchecked += 1
            else:
                self._differs(event, "what the sender held", f"sent at {message.now_us} us", held_text(held), "never")

    def _config_of(self, event: Event, message: box_start_t) -> CoordinatorFile:
        key = b"".join(bytes(file.data) + file.role.encode() for file in message.files)
        key += "\n".join(message.overrides).encode()
        if self._config[1] is None or self._config[0] != key:
            self._config = (key, recorded_config(event, message))
        return self._config[1]

    def _compare_memory(self, event: Event, message: box_start_t) -> None:
        decisions, vision = self._core.memory
        self.report.memories += 1
        if decisions != bytes(message.decisions):
            self._differs(
                event, "what the core remembers", f"before call {self._next}", *_first_byte(message, decisions)
            )
        if self._from_pixels and self._sees and vision != bytes(message.vision):
            self._differs(event, "what the vision remembers", f"before call {self._next}", "", "")
        if self._from_pixels and not self._sees:  # from here on it is known
            self._core.memory = (decisions, bytes(message.vision))
            self._sees = True

    def _frame(self, event: Event, message: step_t, recorded_observation: core.Observation | None) -> None:
        self.report.frames += 1
        self.report.commands += 1
        self.report.measured += len(message.measurement)
        self._frames_since_start += 1
        result = self._see(message) if self._from_pixels else None
        if result is not None:
            self.report.observations += 1
            was, now = messages.observation_key(recorded_observation), messages.observation_key(result.observation)
            if was != now:
                self._differs(
                    event,
                    "what was seen",
                    _inputs(message),
                    observation_text(recorded_observation),
                    observation_text(result.observation),
                    causes.observation_cause(recorded_observation, result.observation),
                )
        else:
            result = self._core.step_recorded(
                message.utime,
                recorded_observation,
                message.leaders_in_view,
                message.now_us,
                core.Reason(message.reason),
                message.known_age_us,
            )
        command = core.Twist(linear_mps=message.command_linear_mps, angular_radps=message.command_angular_radps)
        was = answer_text(core.Status(message.status), core.Reason(message.reason), command)
        now = answer_text(result.status, result.reason, result.command)
        parts = (core.Status(message.status), core.Reason(message.reason), command)
        first = self.report.first_difference is None
        self._expect(
            event,
            message,
            "the command",
            was,
            now,
            lambda: causes.answer_cause(parts, (result.status, result.reason, result.command)),
        )
        if first and self.report.first_difference is not None:
            measurement = message.measurement[0] if message.measurement else None
            difference = self.report.first_difference
            self._traced = _Traced(message.utime, measurement, step_values(result), difference)

    def trace(self, suffix: str, event: Event) -> None:
        """What was published of the frame that differs first: an observation, a status."""
        traced = self._traced
        if traced is None:
            return
        try:
            message = _TRACES[suffix].decode(event.data)
        except Exception:  # lcm-gen's decoders raise whatever the bytes lead to
            return
        if message.utime != traced.utime or message.reason == core.Reason.no_frame.value:
            return
        if suffix == "_OBSERVATION":
            cause = causes.input_cause(message, traced.measurement)
            if cause is not None:
                traced.difference.causes.append(cause)
            return
        traced.difference.causes.append(causes.stage_cause(message, traced.values))
        self._traced = None  # the status comes last

    def _see(self, message: step_t) -> StepResult | None:
        """The frame through the vision; None where its pixels are not there, or the vision's memory is not known."""
        picture = self._pictures.get(message.utime)
        if picture is None or not self._sees:
            if core.Reason(message.reason) not in _REFUSED_BY_TIME:
                self._sees = False
                self.report.observations_unchecked += 1
            return None
        frame = messages.frame_of(picture)
        frame.known_age_us = message.known_age_us
        frame.coarse_search = bool(message.coarse_search)
        return self._core.step(frame, message.now_us)

    def _other_call(self, event: Event, message: step_t) -> None:
        twist = core.Twist(linear_mps=message.linear_mps, angular_radps=message.angular_radps)
        if message.kind == step_t.KIND_SETPOINT:
            setpoint = core.Setpoint(
                distance_m=message.distance_m, bearing_rad=message.bearing_rad, run=bool(message.run)
            )
            taken = self._core.set_setpoint(setpoint)
        elif message.kind == step_t.KIND_OWN_MOTION:
            taken = self._core.set_ego_motion(message.utime, twist)
        elif message.kind == step_t.KIND_RANGES:
            taken = self._core.set_ranges(messages.scan_of(message), message.now_us)
        else:
            taken = self._core.set_leader_intent(message.utime, twist)
        was = bool(message.taken)
        verb = {True: "taken", False: "refused"}
        self._expect(
            event,
            message,
            "whether it was taken",
            str(was),
            str(taken),
            lambda: f"it was {verb[was]} then, and is {verb[taken]} now",
        )

    def _expect(
        self, event: Event, message: step_t, what: str, recorded: str, recomputed: str, cause: Callable[[], str]
    ) -> None:
        if recorded != recomputed:
            self._differs(event, what, _inputs(message), recorded, recomputed, cause())

    def _differs(
        self, event: Event, what: str, inputs: str, recorded: str, recomputed: str, cause: str | None = None
    ) -> None:
        self.report.differences += 1
        if self.report.first_difference is None:
            found = [] if cause is None else [cause]
            self.report.first_difference = Difference(event, what, inputs, recorded, recomputed, self._agreed, found)


def _inputs(message: step_t) -> str:
    call = f"call {message.sequence}, {_KINDS.get(message.kind, 'unknown')}"
    if message.kind == step_t.KIND_FRAME:
        seen = "measured" if message.measurement else core.Reason(message.reason).name
        return (
            f"{call} of {message.utime} us, arrived at {message.now_us} us, known age {message.known_age_us} us, {seen}"
        )
    if message.kind == step_t.KIND_SETPOINT:
        return f"{call}: {message.distance_m} m, {message.bearing_rad} rad, {'run' if message.run else 'stop'}"
    return f"{call} of {message.utime} us: {message.linear_mps} m/s, {message.angular_radps} rad/s"


def _size(memory: tuple[bytes, bytes]) -> str:
    return f"{len(memory[0])} + {len(memory[1])} bytes"


def _first_byte(message: box_start_t, decisions: bytes) -> tuple[str, str]:
    pairs = enumerate(zip(bytes(message.decisions), decisions, strict=False))
    at = next((i for i, (a, b) in pairs if a != b), min(len(decisions), message.decisions_size))
    return f"{message.decisions_size} bytes", f"{len(decisions)} bytes, first different at {at}"

"""What is known of each robot by now, folded from its messages. No clock of its own: arrivals and ``now`` are given."""

from __future__ import annotations

from collections import OrderedDict, deque
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from pilotfish.core import Reason, Status
from pilotfish.printable import printable
from pilotfish.watching.feed import Kind, Message

WINDOW_S = 10.0  # of maxima, and of counters that are shown as rising
STALE_S = 0.5  # a coordinator sends every 50 ms at least
DEAD_S = 2.0
_RIVAL_S = 1.0
_FORGOTTEN_S = 60.0  # then another robot may have its place, if there are too many
_EVENTS = 200
MOST_ROBOTS = 64
_MOST_COUNTED = 1000  # names that are remembered to be counted once
_STARTS_WITHIN_S = 0.25  # no coordinator starts as fast as that: a new session that speaks so soon is another one's
_MOST_SESSIONS = 8  # of one robot, that take turns
_MOST_COUNTERS = 256  # of one robot; a coordinator has some 60

_STATUSES = {int(status): name for name, status in Status.__members__.items()}
_REASONS = {int(reason): name for name, reason in Reason.__members__.items()}
_BASE_STATES = {0: "waiting", 1: "driving", 2: "stopped", 3: "fault"}


@dataclass(frozen=True)
class Event:
    """A change; ``arrival_s`` is the monotonic time of the message that showed it."""

    arrival_s: float
    text: str


@dataclass(frozen=True)
class Row:
    """A robot at one moment. None: not known, or not measured in the newest frame."""

    robot: str
    status: str  # name of the status; "two coordinators" where two take turns
    reason: str  # in words
    distance_m: float | None = None
    bearing_rad: float | None = None  # positive: to the left
    error_m: float | None = None  # wanted - measured distance, positive: too close; the law's may be predicted
    output: float | None = None  # u of the fuzzy law, -1 to 1
    linear_mps: float | None = None  # commanded
    angular_radps: float | None = None
    frame_rate_hz: float | None = None
    latency_s: float | None = None  # from the exposure (or arrival) to the command, median of the last frames
    latency_max_s: float | None = None  # the largest within WINDOW_S
    rising: dict[str, int] = field(default_factory=dict)  # counters that rose within WINDOW_S, and by how much
    leader_index: int | None = None  # who is followed: 0 the configured leader, 1 the first alternative, ...
    leader_changes: int = 0  # since the coordinator's start
    wheels: str = ""  # state of pilotfish-base; empty: none on the bus
    age_s: float = 0.0  # since the newest message

    @property
    def freshness(self) -> str:
        """fresh, stale or dead."""
        return "fresh" if self.age_s < STALE_S else "stale" if self.age_s < DEAD_S else "dead"


class RobotState:
    """One robot. Feed it with receive(); row() and ``events`` say what is known."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.events: deque[Event] = deque(maxlen=_EVENTS)
        self.heard_s = 0.0  # arrival of the newest message of the coordinator or the wheels
        self._status: Any = None
        self._status_s = self._command_s = self._base_s = -1e9
        self._command: Any = None
        self._observation: Any = None
        self._base: Any = None
        self._said: tuple[str, str] | None = None
        self._sessions: dict[int, float] = {}  # of commands: when each was heard last
        self._latencies: deque[tuple[float, float]] = deque()  # arrival, of single frames
        self._counts: OrderedDict[int, dict[str, int]] = OrderedDict()  # by session; the one that spoke last at the end
        self._rises: deque[tuple[float, str, int]] = deque()
        self._unreadable = False

    def receive(self, message: Message) -> None:
        """Takes over a message of this robot."""
        self.heard_s = message.arrival_s
        take = {
            Kind.status: self._take_status,
            Kind.command: self._take_command,
            Kind.observation: self._take_observation,
            Kind.base: self._take_base,
        }.get(message.kind)
        if take is not None:
            take(message.arrival_s, message.value)
        elif message.kind is Kind.unreadable and not self._unreadable:
            self._unreadable = True
            self._note(message.arrival_s, f"{message.channel} cannot be read: a program of another version")

    def row(self, now_s: float) -> Row:
        """The robot at ``now_s``, on the clock of the arrivals."""
        self._forget(now_s)
        status, reason = self._words(now_s)
        seen = self._observation
        detected = seen is not None and seen.detected
        return Row(
            robot=self.name,
            status=status,
            reason=reason,
            distance_m=seen.distance_m if detected else None,
            bearing_rad=seen.bearing_rad if detected else None,
            error_m=self._status.setpoint_distance_m - seen.distance_m if detected and self._status else None,
            output=self._status.output if detected and self._status is not None else None,
            linear_mps=self._command.linear_mps if self._command is not None else None,
            angular_radps=self._command.angular_radps if self._command is not None else None,
            frame_rate_hz=self._status.frame_rate_hz if self._status is not None else None,
            latency_s=self._status.latency_s if self._latencies and self._status is not None else None,
            latency_max_s=self._latency_max_s(),
            rising=self._rising(),
            leader_index=self._status.leader_index if self._status is not None else None,
            leader_changes=self._status.leader_changes if self._status is not None else 0,
            wheels=self._wheels(now_s),
            age_s=max(0.0, now_s - self.heard_s),
        )

    def note(self, arrival_s: float, text: str) -> None:
        """Adds an event of the observer's own, such as a stop that was sent."""
        self._note(arrival_s, text)

    # --- messages
    def _take_status(self, arrival_s: float, status: Any) -> None:
        known = {printable(counter.name): counter.count for counter in status.rejected}
        before = self._counts.get(status.session)
        restarted = self._status is not None and arrival_s - self._status_s > _STARTS_WITHIN_S
        # A counter that is named for the first time counts from 0, unless it may have risen before one looked.
        whole = "others" not in known and (before is not None or restarted)
        before = before or {}
        if len(before) > _MOST_COUNTERS:
            before = {}
        for name, count in known.items():
            rise = count - before.get(name, 0 if whole else count)
            if rise > 0 and name != "others":
                if not any(known_rise[1] == name for known_rise in self._rises):
                    self._note(arrival_s, f"{name} rises ({count} by now)")
                self._rises.append((arrival_s, name, rise))
        self._counts[status.session] = before | known
        self._counts.move_to_end(status.session)
        while len(self._counts) > _MOST_SESSIONS:
            self._counts.popitem(last=False)
        self._status, self._status_s = status, arrival_s
        self._say(arrival_s, status)

    def _take_command(self, arrival_s: float, command: Any) -> None:
        if command.session not in self._sessions and self._sessions:
            self._note(arrival_s, f"another session of the coordinator: {command.session & (2**64 - 1):016x}")
        self._sessions[command.session] = arrival_s
        self._command, self._command_s = command, arrival_s
        if arrival_s - self._status_s > STALE_S:  # while two coordinators send, neither says its status
            self._say(arrival_s, command)

    def _take_observation(self, arrival_s: float, observation: Any) -> None:
        self._observation = observation
        if observation.detected:
            self._latencies.append((arrival_s, observation.latency_s))

    def _take_base(self, arrival_s: float, base: Any) -> None:
        if self._base is None or base.state != self._base.state:
            self._note(arrival_s, f"wheels: {_BASE_STATES.get(base.state, base.state)}")
        self._base, self._base_s = base, arrival_s

    # --- what they mean
    def _say(self, arrival_s: float, message: Any) -> None:
        said = _name(message), _text(message)
        if said != self._said:
            self._said = said
            self._note(arrival_s, f"{said[0]}: {said[1]}" if said[1] else said[0])

    def _words(self, now_s: float) -> tuple[str, str]:
        if sum(now_s - heard_s < _RIVAL_S for heard_s in self._sessions.values()) > 1 and self._takes_turns(now_s):
            return "two coordinators", "end all but one of this name"
        return self._said or ("", "only its wheels are on the bus" if self._base is not None else "")

    def _takes_turns(self, now_s: float) -> bool:
        """Both were heard at last: after a restart the old session falls silent."""
        return sum(self._command_s - heard_s < 0.2 for heard_s in self._sessions.values()) > 1

    def _wheels(self, now_s: float) -> str:
        if self._base is None:
            return ""
        if now_s - self._base_s > DEAD_S:
            return "silent"
        return _BASE_STATES.get(self._base.state, str(self._base.state))

    def _latency_max_s(self) -> float | None:
        """An observation says the time from its frame's arrival; the status's median may count from the exposure. What
        lies between exposure and arrival is taken as the difference of the two medians."""
        if not self._latencies or self._status is None:
            return None
        single = [latency_s for _, latency_s in self._latencies]
        return max(single) + max(0.0, self._status.latency_s - median(single))

    def _rising(self) -> dict[str, int]:
        total: dict[str, int] = {}
        for _, name, count in self._rises:
            total[name] = total.get(name, 0) + count
        return dict(sorted(total.items(), key=lambda item: -item[1]))

    def _forget(self, now_s: float) -> None:
        for queue in (self._latencies, self._rises):
            while queue and now_s - queue[0][0] > WINDOW_S:
                queue.popleft()

    def _note(self, arrival_s: float, text: str) -> None:
        self.events.append(Event(arrival_s, text))


class Robots:
    """All robots that were heard, by name; ``only``: no others than these."""

    def __init__(self, only: tuple[str, ...] = ()) -> None:
        self.by_name: dict[str, RobotState] = {}
        self._left_out: set[str] = set()  # robots beyond MOST_ROBOTS
        self._others: set[str] = set()  # channels that can be no robot's
        self._only = {name.lower() for name in only}

    def receive(self, message: Message) -> None:
        """Takes over a message; pictures and robots that were not asked for are left out."""
        if message.kind is Kind.other:
            _count(self._others, message.channel)
            return
        if message.kind is Kind.image or (self._only and message.robot not in self._only):
            return
        if not self._is_known(message):
            return
        self.by_name.setdefault(message.robot, RobotState(message.robot)).receive(message)

    def left_out(self) -> str:
        """What was heard and is not shown, in words; empty: nothing."""
        counts = ((self._left_out, "robots more"), (self._others, "other channels"))
        return ", ".join(f"{_counted(names)} {what}" for names, what in counts if names)

    def _is_known(self, message: Message) -> bool:
        """One that is silent for long makes room."""
        if message.robot in self.by_name or len(self.by_name) < MOST_ROBOTS:
            return True
        name, oldest = min(self.by_name.items(), key=lambda item: item[1].heard_s)
        if message.arrival_s - oldest.heard_s < _FORGOTTEN_S:
            _count(self._left_out, message.robot)
            return False
        del self.by_name[name]
        return True

    def rows(self, now_s: float) -> list[Row]:
        """One of each robot, by name."""
        return [self.by_name[name].row(now_s) for name in sorted(self.by_name)]


def _count(names: set[str], name: str) -> None:
    if len(names) < _MOST_COUNTED:
        names.add(name)


def _counted(names: set[str]) -> str:
    return str(len(names)) if len(names) < _MOST_COUNTED else f"{_MOST_COUNTED} or more"


def _name(message: Any) -> str:
    return _STATUSES.get(message.status, f"status {message.status}")


def _text(message: Any) -> str:
    name = _REASONS.get(message.reason)
    return Reason.__members__[name].text if name else f"reason {message.reason}"

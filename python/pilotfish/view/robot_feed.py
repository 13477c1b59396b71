"""One robot's messages: kept as bytes while nobody watches, decoded in their order as soon as somebody does."""

from __future__ import annotations

import math
from collections import Counter, OrderedDict, deque
from typing import Any

from pilotfish.view import words
from pilotfish.view.dead_reckoning import PlanarPose
from pilotfish.view.feed import Feed, OnNews
from pilotfish.view.limits import limits_of
from pilotfish.view.messages import MAX_MESSAGE_BYTES, MalformedError, Values, decode
from pilotfish.view.pictures import Picture, picture_of
from pilotfish.view.samples import SPAN_S, Samples
from pilotfish.view.setup import Setup, axes_px
from pilotfish.zero_commands import FOLLOWING, NO_PICTURE

KINDS = ("STATUS", "OBSERVATION", "COMMAND", "BASE")
PICTURE_KINDS = ("PREVIEW", "IMAGE")
_MAX_PENDING = 12000  # a minute of four channels at 50 Hz
_DECODE_EVERY_S = 0.1  # of what was kept while nobody watched: as often as a sample is made
_COUNTERS_EVERY_S = 0.05  # kept, to say what rose in the last second
_PREVIEW_FOR_S = 1.0  # so long a preview is preferred to the camera's own pictures
_PICTURE_EVERY_S = 0.08  # a raw picture is encoded no more often
_OVERLAYS = 64
_FRESH_S = 0.25  # a sample takes a measurement no older than this


class RobotFeed(Feed):
    """Everything about one robot. ``take`` receives its messages; samples and paths go back a minute."""

    def __init__(self, name: str, setup: Setup) -> None:
        super().__init__(name)
        self.setup = setup
        self.malformed: Counter[str] = Counter()
        self._pending: deque[tuple[float, str, bytes]] = deque(maxlen=_MAX_PENDING)
        self._latest: dict[str, Values] = {}
        self._arrived_s: dict[str, float] = {}
        self._kept_s: dict[str, float] = {}  # when a message of a kind was last decoded
        self._samples = Samples()
        self._pose = PlanarPose()
        self._twist = (0.0, 0.0)
        self._moved_s: float | None = None
        self._session = ""
        self._rejected: dict[str, int] = {}
        self._rejected_before: deque[tuple[float, dict[str, int]]] = deque()
        self._last_seen_s: float | None = None
        self._followed = False  # the last command was one of a robot that followed
        self._zeros_s: deque[float] = deque()  # when zero was commanded for want of a picture, while following
        self._overlays: OrderedDict[int, Values] = OrderedDict()
        self._picture_bytes: tuple[float, bytes] | None = None
        self._picture: tuple[Picture, float] | None = None
        self._picture_told_s = self._preview_s = -math.inf

    def wants(self, kind: str) -> bool:
        """Whether a message of this kind is worth receiving now: pictures only while somebody watches."""
        if kind in KINDS:
            return True
        if not self.watched or kind not in PICTURE_KINDS:
            return False
        newest_s = max(self._arrived_s.values(), default=-math.inf)
        return kind == "PREVIEW" or not newest_s - self._preview_s <= _PREVIEW_FOR_S

    def take(self, kind: str, data: bytes, arrival_s: float) -> None:
        """A message on the robot's channel of this kind."""
        if kind in PICTURE_KINDS:
            self._take_picture(kind, data, arrival_s)
        elif len(data) > MAX_MESSAGE_BYTES:
            self.malformed[kind] += 1
        else:
            self._pending.append((arrival_s, kind, data))
            if self.watched:
                self._catch_up(every=True)
                self.tell("state")
            else:
                while self._pending and arrival_s - self._pending[0][0] > SPAN_S:
                    self._pending.popleft()

    def watch(self, on_news: OnNews) -> None:
        """As Feed's; the first one gets the last minute."""
        if not self.watched:
            self._catch_up(every=False)
        super().watch(on_news)

    def unwatch(self, on_news: OnNews) -> None:
        """As Feed's; without watchers, a picture is stale at once."""
        super().unwatch(on_news)
        if not self.watched:
            self._picture = self._picture_bytes = None

    def hello(self) -> dict[str, Any]:
        """As Feed's."""
        limits = limits_of(self.setup)
        return {
            "mode": self.mode,
            "robot": self.name,
            "configured": self.setup.configured,
            "counter_words": words.COUNTER_WORDS,
            "base_counter_words": words.BASE_COUNTER_WORDS,
            "limits": {"distance_m": limits.distance_m, "bearing_deg": limits.bearing_deg},
        }

    def state(self, samples_from: int, now_s: float) -> tuple[dict[str, Any], int]:
        """As Feed's."""
        next_sample, rows = self._samples.since(samples_from)
        status = self._latest.get("STATUS")
        base = self._latest.get("BASE")
        state = {
            "ages_s": {kind.lower(): round(now_s - at_s, 4) for kind, at_s in self._arrived_s.items()},
            "status": status,
            "observation": self._latest.get("OBSERVATION"),
            "command": self._latest.get("COMMAND"),
            "base": base,
            "base_words": words.describe_base(base) if base else None,
            "words": None if status is None else self._words(status, now_s),
            "rejected": self._rejected,
            "zeros_without_picture": self._zeros_in_the_last_minute(now_s),
            "malformed": dict(self.malformed),
            "samples": rows,
        }
        return state, next_sample

    def picture(self) -> tuple[Picture, float] | None:
        """As Feed's: decoded, and if it came raw encoded, now, once for all pages."""
        if self._picture_bytes is not None:
            (arrival_s, data), self._picture_bytes = self._picture_bytes, None
            try:
                self._picture = picture_of(data), arrival_s
            except (MalformedError, OSError, ValueError):
                self.malformed["PICTURE"] += 1
        return self._picture

    def overlay(self, utime_us: int) -> dict[str, Any] | None:
        """As Feed's."""
        seen = self._overlays.get(utime_us)
        if seen is None:
            return None
        pose, camera = seen["camera_from_leader"], self.setup.camera
        axes = axes_px(camera, pose) if seen["detected"] and pose is not None and camera is not None else None
        size = self.setup.camera_size
        return {
            "utime_us": utime_us,
            "detected": seen["detected"],
            "text": seen["text"],
            "tags": seen["tags"],
            "axes_px": axes,
            "calibrated_size": None if size is None else list(size),
            "distance_m": seen["distance_m"],
            "bearing_rad": seen["bearing_rad"],
        }

    def _take_picture(self, kind: str, data: bytes, arrival_s: float) -> None:
        if not self.wants(kind):
            return
        if kind == "PREVIEW":
            self._preview_s = arrival_s
        self._arrived_s["PICTURE"] = arrival_s
        if arrival_s - self._picture_told_s < _PICTURE_EVERY_S and kind == "IMAGE":
            return
        self._picture_told_s = arrival_s
        self._picture_bytes = arrival_s, data
        self.tell("picture")

    def _catch_up(self, *, every: bool) -> None:
        """Decodes what is pending; not every one, if that is a minute's."""
        last_s = {kind: arrival_s for arrival_s, kind, _ in self._pending}
        while self._pending:
            arrival_s, kind, data = self._pending.popleft()
            due = kind == "COMMAND" or arrival_s - self._kept_s.get(kind, -math.inf) >= _DECODE_EVERY_S
            if every or due or arrival_s == last_s[kind]:
                self._kept_s[kind] = arrival_s
                self._decode(kind, data, arrival_s)

    def _decode(self, kind: str, data: bytes, arrival_s: float) -> None:
        try:
            values = decode(kind, data)
        except MalformedError:
            self.malformed[kind] += 1
            return
        self._latest[kind] = values
        self._arrived_s[kind] = arrival_s
        if kind == "COMMAND":
            self._on_command(values, arrival_s)
        elif kind == "STATUS":
            self._on_status(values, arrival_s)
        elif kind == "OBSERVATION":
            self._on_observation(values, arrival_s)

    def _on_status(self, values: Values, arrival_s: float) -> None:
        if values["session"] != self._session:
            self._session, self._rejected = values["session"], {}
            self._rejected_before.clear()
        self._rejected = self._rejected | values["rejected"]
        if not self._rejected_before or arrival_s - self._rejected_before[-1][0] >= _COUNTERS_EVERY_S:
            self._rejected_before.append((arrival_s, dict(self._rejected)))
        while len(self._rejected_before) > 1 and arrival_s - self._rejected_before[1][0] >= 1.0:
            self._rejected_before.popleft()

    def _on_observation(self, values: Values, arrival_s: float) -> None:
        before = self._overlays.get(values["utime_us"])
        if values["detected"] or before is None or not before["detected"]:  # "no frame arrived" repeats the last utime
            self._overlays[values["utime_us"]] = values
        self._overlays.move_to_end(values["utime_us"])
        while len(self._overlays) > _OVERLAYS:
            self._overlays.popitem(last=False)
        if values["detected"]:
            self._last_seen_s = arrival_s

    def _on_command(self, values: Values, arrival_s: float) -> None:
        if self._followed and values["reason"] in NO_PICTURE and values["status"] not in FOLLOWING:
            self._zeros_s.append(arrival_s)
        self._followed = values["status"] in FOLLOWING
        if self._moved_s is not None:
            self._pose = self._pose.moved(*self._twist, arrival_s - self._moved_s)
        self._moved_s = arrival_s
        base = self._latest.get("BASE")
        wheels = base is not None and base["measured"] and arrival_s - self._arrived_s["BASE"] < _FRESH_S
        twist = (
            (base["measured_linear_mps"], base["measured_angular_radps"])
            if wheels and base is not None
            else (values["linear_mps"], values["angular_radps"])
        )
        self._twist = (twist[0] or 0.0, twist[1] or 0.0)
        if self._samples.due(arrival_s):
            self._samples.add(arrival_s, self._sample(values, arrival_s))

    def _zeros_in_the_last_minute(self, now_s: float) -> int:
        while self._zeros_s and now_s - self._zeros_s[0] > SPAN_S:
            self._zeros_s.popleft()
        return len(self._zeros_s)

    def _sample(self, command: Values, arrival_s: float) -> list[float | None]:
        status, seen = self._latest.get("STATUS"), self._latest.get("OBSERVATION")
        fresh = seen is not None and seen["detected"] and arrival_s - self._arrived_s["OBSERVATION"] < _FRESH_S
        pose = self._pose
        distance_error_mm = bearing_error_deg = latency_ms = None
        leader: tuple[float | None, float | None] = (None, None)
        if fresh and seen is not None:
            leader = tuple(round(x, 4) for x in pose.point_at(seen["distance_m"], seen["bearing_rad"]))  # type: ignore[assignment]
            if status is not None:
                kept_m, kept_rad = status["setpoint_distance_m"], status["setpoint_bearing_rad"]
                distance_error_mm = None if kept_m is None else round((kept_m - seen["distance_m"]) * 1e3, 2)
                off = None if kept_rad is None else math.remainder(seen["bearing_rad"] - kept_rad, math.tau)
                bearing_error_deg = None if off is None else round(math.degrees(off), 3)
        if status is not None and status["latency_s"] is not None and fresh:
            latency_ms = round(status["latency_s"] * 1e3, 2)
        return [
            *(distance_error_mm, bearing_error_deg, command["linear_mps"], command["angular_radps"], latency_ms),
            *(round(pose.x_m, 4), round(pose.y_m, 4), round(pose.heading_rad, 4), *leader),
            None,  # the range is a camera's, without a robot
        ]

    def _words(self, status: Values, now_s: float) -> dict[str, Any]:
        before = self._rejected_before[0][1] if self._rejected_before else {}
        risen = {name: count - before.get(name, 0) for name, count in self._rejected.items() if name in before}
        picture = self._picture[0] if self._picture else None
        size = (picture.source_width, picture.source_height) if picture else None
        return words.describe(
            status,
            self._latest.get("OBSERVATION"),
            self.setup,
            picture_size=size,
            last_seen_s=None if self._last_seen_s is None else now_s - self._last_seen_s,
            risen=risen,
        )

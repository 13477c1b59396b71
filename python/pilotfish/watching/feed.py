"""Messages of every robot on the bus, decoded; nothing is sent.

Channels are taken by their names (``ROBOT1_STATUS``), images by their type's fingerprint: a camera's program may use
any channel. What cannot be decoded becomes a Message of the kind ``unreadable``: mostly a program of another version.
"""

from __future__ import annotations

import os
import struct
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from enum import Enum
from typing import Any

from pilotfish.bus import DEFAULT_URL
from pilotfish.errors import SilentRobotError
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import base_t, command_t, observation_t, status_t
from pilotfish.names_on_bus import split_channel


class Kind(str, Enum):
    """What a message is."""

    status = "STATUS"
    command = "COMMAND"
    observation = "OBSERVATION"
    base = "BASE"
    image = "IMAGE"
    other = "other"  # on a channel of this kind, of whom no robot can be named: ``robot`` is empty
    unreadable = "unreadable"  # on one of these channels, but of another type or version


_TYPES = {
    Kind.status: status_t,
    Kind.command: command_t,
    Kind.observation: observation_t,
    Kind.base: base_t,
}
_HEAD = struct.Struct(">8sqiiiii")  # image_t up to its bytes: fingerprint, utime, width, height, stride, format, size
IMAGE_FINGERPRINT: bytes = image_t._get_packed_fingerprint()


@dataclass(frozen=True)
class ImageHead:
    """A bot_core.image_t without its pixels; ``data`` is the whole message, for whoever wants to decode it."""

    utime: int  # exposure [us]
    width: int  # [px]
    height: int  # [px]
    pixelformat: int  # FourCC
    data: bytes


@dataclass(frozen=True)
class Message:
    """One message. ``value`` is a status_t, command_t, observation_t, base_t or ImageHead; else None."""

    arrival_s: float  # on this process's monotonic clock
    channel: str
    robot: str  # as it is written on the command line: robot1; the channel's whole name for images
    kind: Kind
    value: Any


def parse(channel: str, data: bytes, arrival_s: float) -> Message | None:
    """Pure: the message, or None for a channel and type that is not a robot's."""
    if data[:8] == IMAGE_FINGERPRINT:
        if len(data) < _HEAD.size:
            return Message(arrival_s, channel, channel, Kind.unreadable, None)
        _, utime, width, height, _, pixelformat, _ = _HEAD.unpack_from(data)
        return Message(arrival_s, channel, channel, Kind.image, ImageHead(utime, width, height, pixelformat, data))
    suffix = channel.rpartition("_")[2]
    if suffix not in {kind.value for kind in _TYPES}:
        return None
    kind, named = Kind(suffix), split_channel(channel)
    if named is None:
        return Message(arrival_s, channel, "", Kind.other, None)
    robot = named[0]
    try:
        value = _TYPES[kind].decode(data)
    except Exception:  # lcm-gen's decoders raise whatever the bytes lead to
        return Message(arrival_s, channel, robot, Kind.unreadable, None)
    return Message(arrival_s, channel, robot, kind, value)


class Feed:
    """A connection that only receives. SilentRobotError if there is no bus at ``url`` (default: $LCM_DEFAULT_URL, else
    this host's)."""

    def __init__(self, url: str, on_message: Callable[[Message], None], channels: str = ".*") -> None:
        import lcm

        self.url = url or os.environ.get("LCM_DEFAULT_URL") or DEFAULT_URL
        try:
            self._bus = lcm.LCM(self.url)
        except RuntimeError as error:
            raise SilentRobotError(f"the bus {self.url} cannot be opened: {error}; see `pilotfish doctor`") from error
        self._on_message = on_message
        subscription = self._bus.subscribe(channels, self._receive)
        subscription.set_queue_capacity(500)  # lcm's default of 30 is a third of a second of three robots

    def handle(self, timeout_s: float) -> bool:
        """Waits for a message for at most ``timeout_s``; whether one came."""
        return self._bus.handle_timeout(max(1, int(1000 * timeout_s))) > 0

    def fileno(self) -> int:
        """For event loops: readable when handle() has something to do."""
        return self._bus.fileno()

    def _receive(self, channel: str, data: bytes) -> None:
        message = parse(channel, data, time.monotonic())
        if message is not None:
            self._on_message(message)


def watch(url: str, seconds: float, on_time: Callable[[float], None] = lambda passed_s: None) -> Iterator[Message]:
    """The messages of ``seconds``; ``on_time`` gets the time that has passed [s], a few times a second."""
    received: list[Message] = []
    feed = Feed(url, received.append)
    start = time.monotonic()
    while (passed_s := time.monotonic() - start) < seconds:
        on_time(passed_s)
        until = min(start + seconds, time.monotonic() + 0.2)
        while (left_s := until - time.monotonic()) > 0:
            feed.handle(left_s)
        yield from received
        received.clear()
    on_time(seconds)

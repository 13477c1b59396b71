"""A socket on LCM's multicast group, read by asyncio."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import struct
import time
from collections.abc import Callable
from urllib.parse import parse_qs, urlsplit

from pilotfish.bus import Bus, BusError
from pilotfish.errors import SilentRobotError, UsageError
from pilotfish.view.datagrams import Reassembly

_MAX_DATAGRAM_BYTES = 65536
_AT_ONCE = 64  # datagrams for each turn of the event loop: a flood must not keep it from the pages
_KNOWN_SENDERS = 256

OnMessage = Callable[[str, bytes, float], None]


def resolve_url(url: str) -> str:
    """The URL that is in use: the given one, else $LCM_DEFAULT_URL, else this host's bus.

    Raises SilentRobotError with what to do if there is no such bus (no multicast route, a bad URL), UsageError for a
    provider that has no datagrams.
    """
    try:
        used = Bus(url).url
    except BusError as error:
        raise SilentRobotError(str(error)) from error
    if urlsplit(used).scheme != "udpm":
        raise UsageError(f"--lcm-url: {used} is not of the provider udpm (udpm://239.255.76.67:7667?ttl=0)")
    return used


class Listener:
    """Calls ``on_message(channel, payload, arrival_s)`` for every whole message on a channel that ``wanted`` accepts.

    arrival_s is time.monotonic(). With ttl=0 in the URL, what another host sends is dropped, as Pilotfish's own
    programs do.
    """

    def __init__(self, url: str, wanted: Callable[[str], bool], on_message: OnMessage) -> None:
        parts = urlsplit(url)
        options = parse_qs(parts.query)
        self._on_message = on_message
        self._local_only = options.get("ttl", ["0"])[0] == "0"
        self._senders: dict[str, bool] = {}
        self.reassembly = Reassembly(wanted)
        group = parts.hostname or "239.255.76.67"
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        buffer_bytes = options.get("recv_buf_size", [""])[0]
        if buffer_bytes.isdecimal():
            self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, min(int(buffer_bytes), 1 << 26))
        self._socket.bind((group, parts.port or 7667))
        member = struct.pack("=4s4s", socket.inet_aton(group), socket.inet_aton("0.0.0.0"))
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """Receives from now on, on this loop's thread."""
        loop.add_reader(self._socket.fileno(), self.receive)

    def stop(self, loop: asyncio.AbstractEventLoop) -> None:
        """Receives no more."""
        loop.remove_reader(self._socket.fileno())
        self._socket.close()

    def receive(self) -> None:
        """Everything that has come, or a part of it."""
        now_s = time.monotonic()
        for _ in range(_AT_ONCE):
            try:
                datagram, sender = self._socket.recvfrom(_MAX_DATAGRAM_BYTES)
            except BlockingIOError:
                return
            except OSError:
                self.reassembly.refused["receive_failed"] += 1
                return
            if self._local_only and not self._is_local(sender[0]):
                self.reassembly.refused["datagram_foreign"] += 1
                continue
            message = self.reassembly.take(datagram, sender, now_s)
            if message is not None:
                self._on_message(*message, now_s)

    def _is_local(self, address: str) -> bool:
        """A socket can be bound to this host's own addresses alone. 0.0.0.0: a host with no route but loopback."""
        if address == "0.0.0.0":
            return True
        if address not in self._senders:
            if len(self._senders) >= _KNOWN_SENDERS:
                self._senders.clear()
            with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as probe:
                try:
                    probe.bind((address, 0))
                    self._senders[address] = True
                except OSError:
                    self._senders[address] = False
        return self._senders[address]

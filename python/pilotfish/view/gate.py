"""Accepts connections so that nobody can keep others out by opening many.

asyncio's own server accepts until the process has no descriptors, then logs a traceback for each try, and a STOP gets
no connection. Here the number of connections is bounded, in all and by address. Whoever comes when there is no room
takes the place of the connection that has waited longest without asking anything; where all are busy, it is closed at
once.
"""

from __future__ import annotations

import asyncio
import logging
import socket
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from pilotfish.view.descriptors import Limits

_AT_ONCE = 8  # for each turn of the event loop: what has been accepted is to be read before it is displaced
_RETRY_S = 0.5
_SAY_AGAIN_S = 60.0
_log = logging.getLogger(__name__)


class Guarded(Protocol):
    """What the gate has to know of a connection's protocol."""

    def is_displaceable(self) -> bool:
        """Whether it may be closed for another one: nobody waits for what it does."""

    def displace(self) -> None:
        """Closes it at once."""


@dataclass(frozen=True)
class _Connection:
    socket: socket.socket  # asyncio's transport closes it, and its number is -1 then
    address: str
    protocol: Guarded


class Gate:
    """A listening socket of an event loop. ``make_protocol`` is called for each connection that is let in."""

    def __init__(self, listening: socket.socket, limits: Limits, make_protocol: Callable[[], Any]) -> None:
        self._listening, self._limits, self._make_protocol = listening, limits, make_protocol
        self._connections: list[_Connection] = []  # the oldest first
        self._handshakes: set[asyncio.Task[Any]] = set()
        self._retry: asyncio.TimerHandle | None = None
        self._silent_until_s = 0.0
        listening.setblocking(False)

    def open(self) -> None:
        """Accepts from now on, on the running loop."""
        self._loop = asyncio.get_running_loop()
        self._loop.add_reader(self._listening.fileno(), self._accept)

    def close(self) -> None:
        """Accepts no more; what is open stays open."""
        if self._retry is not None:
            self._retry.cancel()
        self._loop.remove_reader(self._listening.fileno())

    async def wait_closed(self) -> None:
        """As asyncio's servers have it."""

    def _accept(self) -> None:
        for _ in range(_AT_ONCE):
            try:
                accepted, peer = self._listening.accept()
            except (BlockingIOError, InterruptedError, ConnectionAbortedError):
                return
            except OSError as error:  # this computer has no descriptors or no memory left
                self._wait(error)
                return
            if self._has_room(peer[0]):
                self._let_in(accepted, peer[0])
            else:
                accepted.close()

    def _wait(self, error: OSError) -> None:
        """The socket stays readable: without a pause the loop would do nothing else."""
        self._loop.remove_reader(self._listening.fileno())
        self._retry = self._loop.call_later(_RETRY_S, self.open)
        if self._loop.time() >= self._silent_until_s:
            self._silent_until_s = self._loop.time() + _SAY_AGAIN_S
            _log.error("no new connection can be accepted: %s; trying again every %g s", error.strerror, _RETRY_S)

    def _has_room(self, address: str) -> bool:
        """Makes it, if it can."""
        self._connections = [one for one in self._connections if one.socket.fileno() != -1]
        if sum(one.address == address for one in self._connections) >= self._limits.per_address:
            return self._displace_of(address)
        if len(self._connections) >= self._limits.total:
            idle = Counter(one.address for one in self._connections if one.protocol.is_displaceable())
            return bool(idle) and self._displace_of(idle.most_common(1)[0][0])
        return True

    def _displace_of(self, address: str) -> bool:
        for one in self._connections:
            if one.address == address and one.protocol.is_displaceable():
                one.protocol.displace()
                self._connections.remove(one)
                return True
        return False

    def _let_in(self, accepted: socket.socket, address: str) -> None:
        protocol = self._make_protocol()
        self._connections.append(_Connection(accepted, address, protocol))
        task = self._loop.create_task(self._connect(accepted, protocol))
        self._handshakes.add(task)  # the loop itself holds tasks weakly
        task.add_done_callback(self._handshakes.discard)

    async def _connect(self, accepted: socket.socket, protocol: Any) -> None:
        try:
            await self._loop.connect_accepted_socket(lambda: protocol, accepted)
        except OSError:
            accepted.close()

"""uvicorn's HTTP with deadlines: h11 would wait for the rest of a request forever."""

from __future__ import annotations

import asyncio
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol

REQUEST_WITHIN_S = 5.0  # from the connection, or the last answer, to a request that is complete
ANSWER_WITHIN_S = 20.0  # from there until the answer is sent; a resume and its wheels may take 7 s


class DeadlineProtocol(H11Protocol):
    """A connection that asks nothing, half a question, or does not take the answer is closed. A WebSocket has pings of
    its own."""

    _deadline: asyncio.TimerHandle | None = None
    _answering = False

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """As asyncio's."""
        super().connection_made(transport)
        self._set_deadline(REQUEST_WITHIN_S)

    def data_received(self, data: bytes) -> None:
        """As asyncio's."""
        super().data_received(data)
        self._look()

    def on_response_complete(self) -> None:
        """As uvicorn's; the next request has a time of its own."""
        self._answering = False
        self._set_deadline(REQUEST_WITHIN_S)
        super().on_response_complete()
        self._look()

    def connection_lost(self, exc: Exception | None) -> None:
        """As asyncio's; not called once the connection is a WebSocket."""
        self._cancel_deadline()
        super().connection_lost(exc)

    def is_displaceable(self) -> bool:
        """As the gate wants it."""
        if self.transport is None:  # accepted a moment ago
            return False
        if self._is_websocket():  # a slow page stays, one that has been told to go does not
            return self.transport.is_closing() or bool(getattr(self.transport.get_protocol(), "close_sent", False))
        does_not_take_the_answer = self.transport.get_write_buffer_size() > 0
        return self.transport.is_closing() or does_not_take_the_answer or not self._answering

    def displace(self) -> None:
        """As the gate wants it."""
        self._cancel_deadline()
        self.transport.abort()

    def _look(self) -> None:
        """A request may have become complete."""
        if self._is_websocket():
            self._cancel_deadline()
        elif not self._answering and self.conn.their_state in (h11.DONE, h11.MUST_CLOSE):
            self._answering = True
            self._set_deadline(ANSWER_WITHIN_S)

    def _is_websocket(self) -> bool:
        return self.transport.get_protocol() is not self

    def _set_deadline(self, within_s: float) -> None:
        self._cancel_deadline()
        self._deadline = self.loop.call_later(within_s, self.displace)

    def _cancel_deadline(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None


def make_protocol(server: Any) -> DeadlineProtocol:
    """For a running uvicorn.Server, as its own servers make theirs."""
    return DeadlineProtocol(config=server.config, server_state=server.server_state, app_state=server.lifespan.state)

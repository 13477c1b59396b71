"""Runs the application on a socket of its own until SIGINT, SIGTERM or SIGHUP."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import logging
import socket
from collections.abc import Callable
from typing import Any

from pilotfish.errors import SilentRobotError
from pilotfish.extras import require
from pilotfish.loop_signals import run_until_signal
from pilotfish.view.descriptors import limits
from pilotfish.view.gate import Gate

_BACKLOG = 512  # waiting to be accepted; beyond it the kernel lets a newcomer wait for a second or more
_GRACE_S = 1
_MAX_MESSAGE_BYTES = 1024  # from a page: acknowledgements


def open_socket(host: str, port: int) -> socket.socket:
    """A listening socket; SilentRobotError with what to do if there is none to be had. port 0: any."""
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)[0]
        with contextlib.ExitStack() as on_error:
            listening = on_error.enter_context(socket.socket(family, socket.SOCK_STREAM))
            listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            listening.bind(address)
            listening.listen(_BACKLOG)
            on_error.pop_all()
    except socket.gaierror as error:
        raise SilentRobotError(f"--host {host}: {error.strerror}; use an address of this host") from error
    except OSError as error:
        remedy = {
            errno.EADDRINUSE: "another program listens there; choose another --port, or 0 for any that is free",
            errno.EADDRNOTAVAIL: "this host has no such address; 0.0.0.0 is all that it has",
            errno.EACCES: "ports below 1024 are root's; choose another --port",
        }.get(error.errno or 0, error.strerror)
        raise SilentRobotError(f"cannot listen on {host} port {port}: {remedy}") from error
    return listening


def serve(app: Any, listening: socket.socket, on_ready: Callable[[], None]) -> None:
    """Returns after SIGINT, SIGTERM or SIGHUP; ``on_ready`` is called once pages can be opened."""
    uvicorn = require("uvicorn", "view")
    require("websockets", "view")
    from pilotfish.view.http_protocol import make_protocol

    allowed = limits()
    config = uvicorn.Config(
        app,
        http="h11",  # whose deadlines and connections are guarded
        ws="websockets-sansio",
        ws_max_size=_MAX_MESSAGE_BYTES,
        ws_ping_interval=20.0,  # a phone that has left the network does not count as watching for long
        ws_ping_timeout=20.0,
        ws_per_message_deflate=False,  # costs more than it saves beside JPEGs
        lifespan="on",
        log_level="error",
        access_log=False,
        server_header=False,
        timeout_graceful_shutdown=_GRACE_S,
    )

    class Server(uvicorn.Server):  # type: ignore[name-defined, misc]
        async def startup(self, sockets: Any = None) -> None:
            await super().startup([])  # with no server of asyncio's
            if self.started:
                gate = Gate(listening, allowed, lambda: make_protocol(self))
                gate.open()
                self.servers.append(gate)
                on_ready()

    server = Server(config)

    def end(_number: int) -> None:
        server.force_exit = server.should_exit  # asked twice: without waiting for what is still being answered
        server.should_exit = True

    async def run() -> None:
        logging.getLogger("uvicorn.error").addFilter(_is_no_cancellation)
        await server._serve([listening])  # without uvicorn's own handling of signals, which raises them again
        await server.lifespan.shutdown()  # left out by uvicorn if it is forced; if it was not, this does nothing

    run_until_signal(run, end)


def _is_no_cancellation(record: logging.LogRecord) -> bool:
    """At the end what is still being answered is cancelled, which is no error; uvicorn logs it as one."""
    error = record.exc_info[1] if record.exc_info else None
    return not isinstance(error, asyncio.CancelledError) and not record.getMessage().startswith("Cancel ")

"""Who may look and who may command: token, Host and Origin. Pure decisions, and an ASGI layer that applies them.

- A page is served to this host without a token, to others only with it (query once, then a cookie).
- Every command needs the token, which the page carries: another site's page cannot read it (request forgery).
- A browser that was sent here under another site's name (DNS rebinding) says that name in Host: refused. A number
  cannot be rebound, and neither can this host's own name.
- A WebSocket, and every POST, needs an Origin equal to the Host: browsers let any site open a WebSocket.
"""

from __future__ import annotations

import hmac
import ipaddress
import secrets
import socket
from collections.abc import Awaitable, Callable, Mapping, MutableMapping
from dataclasses import dataclass, field
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs, urlsplit

COOKIE = "pilotfish_view"
TOKEN_HEADER = "x-pilotfish-token"

Scope = MutableMapping[str, Any]
Receive = Callable[[], Awaitable[MutableMapping[str, Any]]]
Send = Callable[[MutableMapping[str, Any]], Awaitable[None]]


def new_token() -> str:
    """192 bits at random, fit for a URL."""
    return secrets.token_urlsafe(24)


def is_loopback(host: str) -> bool:
    """Whether a server on this address can be reached from this host alone."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def own_names(listens_on: str = "localhost") -> frozenset[str]:
    """What this host is called, also by whoever started the server."""
    name = socket.gethostname().lower()
    return frozenset({"localhost", listens_on.lower(), name, name.split(".")[0], f"{name.split('.')[0]}.local"})


@dataclass(frozen=True)
class Access:
    """The rules of one server."""

    token: str
    open_to_others: bool  # listens on more than loopback: the token is needed to look
    names: frozenset[str] = field(default_factory=own_names)

    def token_is_right(self, given: str | None) -> bool:
        """In constant time."""
        return given is not None and hmac.compare_digest(given.encode(), self.token.encode())

    def refusal(self, kind: str, method: str, headers: Mapping[str, str], query: str) -> str | None:
        """Why a request is refused; None: it is not. kind: http or websocket; names of headers in small letters."""
        host = headers.get("host", "")
        if not self._host_is_ours(host):
            return f"this server is not {host or 'nameless'}: open it by its address"
        if kind == "websocket" or method not in ("GET", "HEAD"):
            origin = urlsplit(headers.get("origin", ""))
            if origin.scheme not in ("http", "https") or origin.netloc.lower() != host.lower():
                return "the request comes from another site"
        if not self.open_to_others:
            return None
        given = query_token(query) or _cookie_token(headers.get("cookie", ""))
        return (
            None if self.token_is_right(given) else "open the address that `pilotfish view` has printed, with its token"
        )

    def _host_is_ours(self, host: str) -> bool:
        try:
            name = (urlsplit(f"//{host}").hostname or "").lower()
        except ValueError:
            return False
        if not self.open_to_others:
            return is_loopback(name)
        if name in self.names:
            return True
        try:
            ipaddress.ip_address(name)
        except ValueError:
            return False
        return True


def query_token(query: str) -> str | None:
    """The token in a query string."""
    return parse_qs(query).get("token", [None])[0]


def _cookie_token(header: str) -> str | None:
    try:
        morsel = SimpleCookie(header).get(COOKIE)
    except CookieError:
        return None
    return None if morsel is None else morsel.value


class AccessLayer:
    """ASGI: asks ``access`` before the application sees anything, and adds the headers that keep a page to itself."""

    def __init__(self, app: Callable[[Scope, Receive, Send], Awaitable[None]], access: Access) -> None:
        self._app, self._access = app, access

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """As ASGI says."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in scope["headers"]}
        query = scope.get("query_string", b"").decode("latin-1")
        refusal = self._access.refusal(scope["type"], scope.get("method", "GET"), headers, query)
        if refusal is not None:
            await _refuse(scope, send, refusal)
            return

        async def send_guarded(message: MutableMapping[str, Any]) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message.get("headers", []), *_guards(headers["host"])]
            await send(message)

        await self._app(scope, receive, send_guarded)


def _guards(host: str) -> list[tuple[bytes, bytes]]:
    policy = (
        f"default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
        f"connect-src 'self' ws://{host} wss://{host}; manifest-src 'self'; "
        "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
    )
    return [
        (b"content-security-policy", policy.encode("latin-1")),
        (b"x-content-type-options", b"nosniff"),
        (b"x-frame-options", b"DENY"),
        (b"referrer-policy", b"no-referrer"),
        (b"cache-control", b"no-cache"),
    ]


async def _refuse(scope: Scope, send: Send, reason: str) -> None:
    if scope["type"] == "websocket":
        await send({"type": "websocket.close", "code": 1008, "reason": reason[:120]})  # before accept: HTTP 403
        return
    await send(
        {"type": "http.response.start", "status": 403, "headers": [(b"content-type", b"text/plain; charset=utf-8")]}
    )
    await send({"type": "http.response.body", "body": f"403: {reason}\n".encode()})

"""The web application: page, assets, WebSocket, commands."""

from __future__ import annotations

import asyncio
import contextlib
import html
import json
import secrets
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

from pilotfish.extras import require
from pilotfish.view.access import COOKIE, TOKEN_HEADER, Access, AccessLayer, query_token
from pilotfish.view.commands import ACTIONS, Commander
from pilotfish.view.hub import Hub
from pilotfish.view.limits import SetpointLimits, limits_of
from pilotfish.view.robot_feed import RobotFeed
from pilotfish.view.setup import Setup, law_of
from pilotfish.view.watcher import Watcher

STATIC = Path(__file__).parent / "static"
MAX_PAGES = 24
MAX_BODY_BYTES = 4096
NO_SUCH_ROBOT, TOO_MANY = 4404, 4429  # codes with which a WebSocket is closed


def make_app(hub: Hub, access: Access, setup: Setup, commander: Commander | None) -> Any:
    """An ASGI application. commander None: there is nothing to command."""
    applications, responses, routing = (
        require(f"starlette.{name}", "view") for name in ("applications", "responses", "routing")
    )
    static_files = require("starlette.staticfiles", "view").StaticFiles
    pages = Pages(hub, access, setup, commander, responses)
    routes = [
        routing.Route("/", pages.index),
        routing.Route("/api/robots", pages.robots),
        routing.Route("/api/law", pages.law),
        routing.Route("/api/robots/{robot}/{action}", pages.command, methods=["POST"]),
        routing.WebSocketRoute("/ws", pages.watch),
        routing.Mount("/static", static_files(directory=STATIC)),
    ]

    @contextlib.asynccontextmanager
    async def lifespan(_: Any) -> AsyncIterator[None]:
        loop = asyncio.get_running_loop()
        hub.start(loop)
        try:
            yield
        finally:
            hub.stop(loop)
            if commander is not None:
                commander.close()

    return AccessLayer(applications.Starlette(routes=routes, lifespan=lifespan), access)


class Pages:
    """The endpoints."""

    def __init__(self, hub: Hub, access: Access, setup: Setup, commander: Commander | None, responses: Any) -> None:
        self._hub, self._access, self._commander, self._responses = hub, access, commander, responses
        self._law = json.dumps(law_of(setup))
        self._template = (STATIC / "index.html").read_text(encoding="utf-8")
        self._instance = secrets.token_hex(8)  # not a secret: a page sees by it that another server answers
        self._open = 0
        self._stops: set[asyncio.Task[None]] = set()  # the loop itself holds tasks weakly

    async def index(self, request: Any) -> Any:
        """The page, with the token that its commands need. A token in the address goes into a cookie instead, so that
        it stands neither in the history nor in a screenshot."""
        token = self._access.token
        if query_token(request.url.query) is not None and self._access.open_to_others:
            response = self._responses.RedirectResponse("/", status_code=303)
            response.set_cookie(COOKIE, token, httponly=True, samesite="lax", max_age=7 * 86400)
            return response
        feed = self._hub.find(request.query_params.get("robot", ""))
        named = {"token": token, "server": self._instance, "robot": "NAME" if feed is None else feed.name}
        page = self._template
        for name, value in named.items():
            page = page.replace("{{" + name + "}}", html.escape(value))
        return self._responses.HTMLResponse(page)

    async def robots(self, _: Any) -> Any:
        """Whom one can watch, and who else was heard of."""
        return self._responses.JSONResponse({"robots": self._hub.names(), "heard": self._hub.others()})

    async def law(self, _: Any) -> Any:
        """Rule table and surface."""
        return self._responses.Response(self._law, media_type="application/json")

    async def command(self, request: Any) -> Any:
        """Stop, resume or setpoint; answers when the robot has confirmed it, or has not."""
        answer = self._responses.JSONResponse
        if not self._access.token_is_right(request.headers.get(TOKEN_HEADER)):
            return answer({"confirmed": False, "text": "this page is of another server: reload it"}, 403)
        robot, action = request.path_params["robot"], request.path_params["action"]
        feed = self._hub.find(robot)
        if self._commander is None or feed is None or action not in ACTIONS:
            return answer({"confirmed": False, "text": f"there is no {action} of {robot} here"}, 404)
        values: Any = {}
        if action != "stop":  # a stop is obeyed whatever comes with it
            body = b""
            async for chunk in request.stream():
                body += chunk
                if len(body) > MAX_BODY_BYTES:
                    return answer({"confirmed": False, "text": "the request is too long"}, 413)
            try:
                values = json.loads(body or b"{}")
            except (ValueError, RecursionError):
                values = None
            if not isinstance(values, dict):
                return answer({"confirmed": False, "text": "the request is no JSON object"}, 400)
        limits = limits_of(feed.setup) if isinstance(feed, RobotFeed) else SetpointLimits()
        outcome = await self._commander.do(robot, action, values, limits)
        return answer(outcome.as_dict(), 200 if outcome.confirmed else 409)

    async def watch(self, websocket: Any) -> None:
        """A page's connection: states and pictures out, acknowledgements in."""
        await websocket.accept()
        feed = self._hub.find(websocket.query_params.get("robot", ""))
        if feed is None:
            await websocket.close(NO_SUCH_ROBOT)
            return
        if self._open >= MAX_PAGES:
            await websocket.close(TOO_MANY)
            return
        self._open += 1
        watcher = Watcher(feed, websocket.send_text, websocket.send_bytes, {"server": self._instance})
        sending = asyncio.create_task(watcher.run())
        receiving = asyncio.create_task(self._receive(websocket, watcher, feed.name))
        try:
            await asyncio.wait((sending, receiving), return_when=asyncio.FIRST_COMPLETED)
        finally:
            self._open -= 1
            for task in (sending, receiving):
                task.cancel()
            for result in await asyncio.gather(sending, receiving, return_exceptions=True):
                if isinstance(result, Exception) and not _is_gone(result):
                    raise result

    async def _receive(self, websocket: Any, watcher: Watcher, robot: str) -> None:
        """What a page says: acknowledgements, and STOP, for which it then needs no new connection."""
        stopping: asyncio.Task[None] | None = None
        while True:
            message = await websocket.receive()
            if message["type"] == "websocket.disconnect":
                return  # a stop that is being sent is sent to its end
            text = message.get("text") or ""
            if not text.startswith("{"):
                watcher.acknowledge(text)
            elif self._asks_stop(text) and (stopping is None or stopping.done()):  # one at a time for each page
                stopping = asyncio.create_task(self._stop_and_tell(websocket, robot))
                self._stops.add(stopping)
                stopping.add_done_callback(self._stops.discard)

    def _asks_stop(self, text: str) -> bool:
        try:
            given = json.loads(text).get("stop")
            return self._commander is not None and isinstance(given, str) and self._access.token_is_right(given)
        except (ValueError, RecursionError):  # also of half a surrogate pair
            return False

    async def _stop_and_tell(self, websocket: Any, robot: str) -> None:
        assert self._commander is not None
        outcome = await self._commander.do(robot, "stop", {})
        try:
            await websocket.send_text(json.dumps({"kind": "outcome"} | outcome.as_dict()))
        except Exception as error:
            if not _is_gone(error):
                raise


def _is_gone(error: BaseException) -> bool:
    """Whether this is how a page that has closed shows: starlette's, websockets' and the system's ways to say it."""
    gone = ("WebSocketDisconnect", "ConnectionClosed", "ConnectionClosedOK", "ConnectionClosedError")
    return type(error).__name__ in gone or isinstance(error, (RuntimeError, ConnectionError, KeyError))

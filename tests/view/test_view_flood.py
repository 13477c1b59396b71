"""Whoever opens many connections, or half of one, keeps nobody from STOP."""

from __future__ import annotations

import json
import re
import resource
import socket
import sys
import time
from contextlib import ExitStack, contextmanager

import pytest
import websockets.sync.client as websocket
from view_server import serving

from scripted_coordinator import ScriptedCoordinator

DESCRIPTORS = 256
IDLE = 300  # more than the server has descriptors
STOPPED_WITHIN_S = 5.0  # a stop is given up after 3 s; a waiting connection is closed after 5 s
CLOSED_WITHIN_S = 20.0
FEW_DESCRIPTORS = (  # the parent's limit stays as it is: 300 sockets are opened there
    sys.executable,
    "-c",
    "import os, resource, sys\n"
    f"resource.setrlimit(resource.RLIMIT_NOFILE, ({DESCRIPTORS}, {DESCRIPTORS}))\n"
    "os.execv(sys.argv[1], sys.argv[1:])",
)


@contextmanager
def besieged(folder, url, *, says=b"", sockets=IDLE):
    """A robot, and a server with few descriptors, an open page and many connections that say ``says``."""
    with ExitStack() as stack:
        robot = stack.enter_context(ScriptedCoordinator(url))
        server = stack.enter_context(serving(folder, "robot1", "--lcm-url", url, prefix=FEW_DESCRIPTORS))
        token = server.token()
        page = stack.enter_context(
            websocket.connect(f"ws://{server.host}/ws?robot=robot1", origin=f"http://{server.host}")
        )
        idle = [stack.enter_context(connected(server)) for _ in range(sockets)]
        for one in idle:
            if says:
                sent_if_open(one, says)
        yield robot, server, page, token, idle


def connected(server):
    """A connection, made as soon as there is room in the listening socket's queue."""
    host, port = server.host.rsplit(":", 1)
    return socket.create_connection((host, int(port)), timeout=5.0)


def sent_if_open(one, data):
    try:
        one.sendall(data)
    except OSError:
        pass  # the server has closed it


def is_closed(one):
    one.setblocking(False)
    try:
        while one.recv(4096):
            pass
    except BlockingIOError:
        return False
    except OSError:
        return True
    return True


def post_stop(server, token):
    headers = {"Origin": f"http://{server.host}", "X_Pilotfish_Token": token}
    code, text = server.get("/api/robots/robot1/stop", "POST", b"{}", **headers)
    return code, json.loads(text)


def stop_through(page, token):
    """As the page does it: asks, goes on acknowledging, and waits for the outcome."""
    page.send(json.dumps({"stop": token}))
    deadline = time.monotonic() + STOPPED_WITHIN_S
    while (left_s := deadline - time.monotonic()) > 0:
        message = page.recv(timeout=left_s)
        message = json.loads(message) if isinstance(message, str) else {"kind": "picture"}
        if message["kind"] == "outcome":
            return message
        page.send(message["kind"])
    raise AssertionError("no outcome of the stop")


def run_again(robot):
    robot.setpoint.run = True


@pytest.mark.parametrize("says", [b"", b"POST /api/robots/robot1/stop HTTP/1.1\r\nHost: 127", b"GET / HTTP/1.1\r\n"])
def test_a_stop_goes_through_while_more_connections_wait_than_there_are_descriptors(tmp_path, url, says):
    assert resource.getrlimit(resource.RLIMIT_NOFILE)[0] > IDLE + 100  # here, where they are opened
    with besieged(tmp_path, url, says=says) as (robot, server, page, token, idle):
        started_s = time.monotonic()
        code, answer = post_stop(server, token)
        assert (code, answer["confirmed"], robot.setpoint.run) == (200, True, False)
        run_again(robot)
        assert stop_through(page, token)["confirmed"]
        assert not robot.setpoint.run
        assert time.monotonic() - started_s < 2 * STOPPED_WITHIN_S  # not the 8 s of a page that gives up
        deadline = time.monotonic() + CLOSED_WITHIN_S
        while (waiting := [one for one in idle if not is_closed(one)]) and time.monotonic() < deadline:
            time.sleep(0.05)  # polls, bounded
        assert len(waiting) == 0
        assert stop_through(page, token)["confirmed"]  # an open page is none of them
        assert len(server.child.stderr()) < 20_000

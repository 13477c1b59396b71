"""Whoever opens many connections, or half of one, keeps nobody from STOP."""

from __future__ import annotations

import json
import re
import resource
import socket
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager, suppress

import lcm
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
    with suppress(OSError):  # the server has closed it
        one.sendall(data)


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


def test_the_page_stops_through_its_open_connection_when_a_new_one_is_not_to_be_had(tmp_path, url, browser):
    with (
        ScriptedCoordinator(url) as robot,
        serving(tmp_path, "robot1", "--lcm-url", url) as server,
    ):
        page = browser.open(server.address)
        page.route("**/api/robots/*/stop", lambda route: None)  # never answered
        page.click("#stop")
        page.wait_for_selector("#outcome[data-state=confirmed]")
        assert not robot.setpoint.run


def test_a_stop_through_a_page_needs_its_token(shared):
    with ScriptedCoordinator(shared.url, "tokened") as robot:
        address = f"ws://{shared.host}/ws?robot=tokened"
        shared.get("/?robot=tokened")
        deadline = time.monotonic() + STOPPED_WITHIN_S
        while "tokened" not in shared.get("/api/robots")[1]:
            assert time.monotonic() < deadline, "the robot is not discovered"
        with websocket.connect(address, origin=f"http://{shared.host}") as page:
            for wrong in ("", "x" * 32, shared.token()[:-1], "\ud800", None, 1, ["x"]):
                page.send(json.dumps({"stop": wrong}))
            for wrong in ("{", "{}", '{"stop":'):
                page.send(wrong)
            deadline = time.monotonic() + 1.0  # a stop that was accepted is confirmed within 0.1 s
            while (left_s := deadline - time.monotonic()) > 0:
                message = page.recv(timeout=left_s + STOPPED_WITHIN_S)
                if isinstance(message, str):
                    assert json.loads(message)["kind"] != "outcome"
                    page.send(json.loads(message)["kind"])
            assert robot.setpoint.run
            assert stop_through(page, shared.token())["confirmed"]
            assert not robot.setpoint.run


def test_a_server_with_too_few_descriptors_says_how_many_it_needs(tmp_path, url):
    few = [*FEW_DESCRIPTORS[:2], FEW_DESCRIPTORS[2].replace(str(DESCRIPTORS), "40")]
    command = [*few, sys.executable, "-m", "pilotfish", "view", "robot1", "--lcm-url", url, "--port", "0"]
    ended = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert ended.returncode == 69
    assert re.search(r"only 40 open files are allowed here: ulimit -n \d+, or more", ended.stderr)
    assert "Traceback" not in ended.stderr


def test_what_is_being_answered_does_not_make_the_end_loud(tmp_path, url):
    """A stop of a robot that is silent is sent for 3 s; SIGTERM comes before."""
    with serving(tmp_path, "robot1", "--lcm-url", url) as server:
        token, asked = server.token(), connected(server)
        asked.sendall(
            f"POST /api/robots/robot1/stop HTTP/1.1\r\nHost: {server.host}\r\nOrigin: http://{server.host}\r\n"
            f"X-Pilotfish-Token: {token}\r\nContent-Length: 2\r\n\r\n{{}}".encode()
        )
        bus = lcm.LCM(url)
        heard = []
        bus.subscribe("ROBOT1_SETPOINT", lambda channel, _: heard.append(channel))
        assert bus.handle_timeout(5000) > 0  # it is under way
        assert server.child.terminate() == 0
        assert server.child.stderr() == ""
        asked.close()

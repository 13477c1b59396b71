"""Who may look and who may command: tokens, Host, Origin, and what a page is allowed to load."""

from __future__ import annotations

import pytest
import websockets.sync.client as websocket
from view_server import serving
from websockets.exceptions import InvalidStatus

from pilotfish.view.access import Access, is_loopback
from robot_on_bus import RobotOnBus

TOKEN = "a" * 32


def refusal(access, kind="http", method="GET", query="", **headers):
    named = {"host": "127.0.0.1:8090"} | {name.replace("_", "-"): value for name, value in headers.items()}
    return access.refusal(kind, method, named, query)


LOCAL = Access(TOKEN, open_to_others=False, names=frozenset({"robot"}))
OPEN = Access(TOKEN, open_to_others=True, names=frozenset({"robot", "robot.local"}))


@pytest.mark.parametrize("host", ["127.0.0.1:8090", "localhost:8090", "[::1]:8090", "127.0.0.9"])
def test_this_host_may_look_without_a_token(host):
    assert refusal(LOCAL, host=host) is None


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8090", "192.168.1.7:8090", "", "127.0.0.1.evil.example", "["]
)
def test_a_name_that_is_not_this_hosts_is_refused(host):
    assert refusal(LOCAL, host=host) is not None


@pytest.mark.parametrize("host", ["evil.example:8090", "", "127.0.0.1.evil.example", "robot.evil.example", "["])
def test_a_rebound_name_is_refused_with_the_right_token_too(host):
    assert refusal(OPEN, host=host, query=f"token={TOKEN}") is not None


@pytest.mark.parametrize(
    "host", ["192.168.1.7:8090", "robot:8090", "robot.local:8090", "ROBOT.local", "[fe80::1]:8090"]
)
def test_others_need_the_token_in_the_address_or_in_the_cookie(host):
    assert refusal(OPEN, host=host, query=f"token={TOKEN}") is None
    assert refusal(OPEN, host=host, cookie=f"other=1; pilotfish_view={TOKEN}") is None
    for query, cookie in (
        ("", ""),
        ("token=", ""),
        (f"token={TOKEN[:-1]}b", ""),
        ("", "pilotfish_view=x"),
        ("", "\x01=;"),
    ):
        assert refusal(OPEN, host=host, query=query, cookie=cookie) is not None


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "null", "", "http://127.0.0.1:9999", "file://127.0.0.1:8090"]
)
@pytest.mark.parametrize(("kind", "method"), [("websocket", "GET"), ("http", "POST"), ("http", "DELETE")])
def test_another_site_opens_no_websocket_and_posts_nothing(kind, method, origin):
    assert refusal(LOCAL, kind, method, origin="http://127.0.0.1:8090") is None
    assert refusal(LOCAL, kind, method, origin=origin) is not None
    assert refusal(LOCAL, kind, method) is not None  # no Origin at all


def test_only_loopback_addresses_are_loopback():
    assert [is_loopback(host) for host in ("127.0.0.1", "::1", "[::1]", "localhost", "127.1.2.3")] == [True] * 5
    assert [is_loopback(host) for host in ("0.0.0.0", "::", "10.0.0.1", "robot.local", "")] == [False] * 5


def test_a_command_needs_the_token_of_the_page_also_on_this_host(shared):
    with RobotOnBus(shared.url, "guarded"):
        assert shared.get("/?robot=guarded")[0] == 200
        for token in ("", "x", shared.token()[:-1]):
            code, answer = shared.post("/api/robots/guarded/stop", {}, X_Pilotfish_Token=token)
            assert (code, answer["confirmed"]) == (403, False)
        assert shared.get("/api/robots/guarded/stop", "POST", b"{}", Origin=f"http://{shared.host}")[0] == 403
        evil = {"Origin": "http://evil.example", "X_Pilotfish_Token": shared.token()}
        assert shared.get("/api/robots/guarded/stop", "POST", b"{}", **evil)[0] == 403
        assert shared.get("/api/robots/guarded/stop", X_Pilotfish_Token=shared.token())[0] == 405  # no GET
        assert shared.get(Host="evil.example")[0] == 403


@pytest.mark.parametrize(
    ("path", "values", "code"),
    [
        ("guarded/dance", {}, 404),
        ("nobody_here/stop", {}, 404),
        ("guarded/setpoint", {}, 409),
        ("guarded/setpoint", {"distance_m": "far"}, 409),
        ("guarded/setpoint", {"distance_m": True}, 409),
        ("guarded/setpoint", {"distance_m": float("nan")}, 409),
        ("guarded/setpoint", {"distance_m": float("inf")}, 409),
        ("guarded/setpoint", [1.0], 400),
        ("guarded/setpoint", {"distance_m": 1.0, "more": "x" * 5000}, 413),
    ],
)
def test_a_malformed_command_is_answered_and_not_sent(shared, path, values, code):
    with RobotOnBus(shared.url, "guarded"):
        while "guarded" not in shared.get("/api/robots")[1]:
            pass
        answered, answer = shared.post(f"/api/robots/{path}", values)
        assert (answered, answer["confirmed"], answer.get("sent", 0)) == (code, False, 0)
        assert answer["text"]


def test_a_page_may_load_nothing_from_elsewhere_and_stands_in_no_frame(shared):
    shared.get()
    headers = {name.lower(): value for name, value in shared.headers.items()}
    policy = headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
    assert (headers["x-frame-options"], headers["referrer-policy"]) == ("DENY", "no-referrer")
    assert "access-control-allow-origin" not in headers
    assert shared.get("/static/../server.py")[0] == 404
    assert shared.get("/static/%2e%2e/server.py")[0] == 404


def test_a_websocket_of_another_site_is_refused(shared):
    address = f"ws://{shared.host}/ws"
    for origin in ("http://evil.example", None):
        with pytest.raises(InvalidStatus) as refused:
            websocket.connect(address, origin=origin)
        assert refused.value.response.status_code == 403


def test_a_server_for_others_prints_a_token_and_serves_nothing_without(tmp_path, url):
    with RobotOnBus(url), serving(tmp_path, "robot1", "--lcm-url", url, "--host", "0.0.0.0") as server:
        token = server.address.split("token=")[1]
        server.host = f"127.0.0.1:{server.host.rsplit(':', 1)[1]}"
        assert len(token) >= 32
        for path in ("/", "/static/js/main.js", "/api/robots", "/api/law", "/?token=wrong"):
            assert server.get(path)[0] == 403
        code, _ = server.get(f"/?token={token}")
        assert (code, server.headers["location"]) == (303, "/")
        cookie = server.headers["set-cookie"]
        assert "HttpOnly" in cookie
        assert "SameSite=lax" in cookie
        own = cookie.split(";")[0]
        code, page = server.get("/", Cookie=own)
        assert (code, token in page) == (200, True)
        origin = f"http://{server.host}"
        with pytest.raises(InvalidStatus):
            websocket.connect(f"ws://{server.host}/ws", origin=origin)
        with websocket.connect(f"ws://{server.host}/ws", origin=origin, additional_headers={"Cookie": own}) as socket:
            assert '"robot":"robot1"' in socket.recv(timeout=5)

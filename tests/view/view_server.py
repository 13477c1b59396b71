"""A real `pilotfish view`, and a headless Chromium that looks at it."""

from __future__ import annotations

import http.client
import json
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import urlsplit

from pilotfish import data
from pilotfish.harness.child import Child
from pilotfish.harness.ports import private_lcm_url

CHROMIUM = Path("/usr/bin/chromium")
ARGUMENTS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


class Server:
    """A running `pilotfish view`."""

    def __init__(self, child: Child) -> None:
        self.child = child
        self.address = child.stdout().split()[0]
        self.host = urlsplit(self.address).netloc

    def of(self, robot: str) -> str:
        """The address of a robot's page."""
        return f"{self.address}?robot={robot}"

    def get(self, path: str = "/", method: str = "GET", body: bytes = b"", **headers: str) -> tuple[int, str]:
        """Status and text. Names of headers with _ for -; Host and Origin are right unless they are given."""
        host, port = self.host.rsplit(":", 1)
        connection = http.client.HTTPConnection("127.0.0.1" if host == "0.0.0.0" else host, int(port), timeout=10)
        named = {"Host": self.host} | {name.replace("_", "-"): value for name, value in headers.items()}
        try:
            connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
            for name, value in named.items():
                connection.putheader(name, value)
            connection.putheader("Content-Length", str(len(body)))
            connection.endheaders(body)
            response = connection.getresponse()
            self.headers = dict(response.getheaders())
            return response.status, response.read().decode()
        finally:
            connection.close()

    def token(self) -> str:
        """As the page has it."""
        return self.get()[1].split('name="pilotfish-token" content="')[1].split('"')[0]

    def post(self, path: str, values: object, **headers: str) -> tuple[int, dict]:
        """As the page does it."""
        own = {"Origin": f"http://{self.host}", "X_Pilotfish_Token": self.token()}
        code, text = self.get(path, "POST", json.dumps(values).encode(), **(own | headers))
        return code, json.loads(text)


@contextmanager
def serving(
    folder: Path, *options: str | Path, name: str = "view", prefix: Sequence[str | Path] = ()
) -> Iterator[Server]:
    """Until the end of the block."""
    command = [*prefix, sys.executable, "-m", "pilotfish", "view", *options]
    if "--port" not in options:
        command += ["--port", "0"]
    with Child(command, folder, name) as child:
        child.wait_until(lambda: "Ctrl-C" in child.stdout(), 20.0, "being ready")
        yield Server(child)
        if child.process.poll() is None:
            assert child.terminate() == 0, child.error("SIGTERM is not its ordinary end")
        assert "Traceback" not in child.stderr(), child.stderr()


@contextmanager
def serving_a_bus(folder: Path) -> Iterator[Server]:
    """A server for many robots, on a bus of its own (`url`)."""
    url = private_lcm_url()
    with serving(folder, "--lcm-url", url, "--config", data.path("config/line.yaml")) as server:
        server.url = url
        yield server

"""Hosts on one virtual network: a namespace each, a cable from it to the hub, and in the hub a switch."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path

import lcm
from disturbances import DISTURBANCES, netem_words
from namespaces import Namespace, run_ip

from pilotfish.harness.child import Child

HERE = Path(__file__).parent
_ROUTES = ("route replace 224.0.0.0/4 dev eth0",)


class Host(Namespace):
    """Multicast goes out on eth0; LCM's default group stays inside."""

    def __init__(self, name: str, number: int) -> None:
        super().__init__()
        self.name, self.port = name, f"port{number}"
        self.run(
            f"link add eth0 type veth peer name {self.port} netns {os.getpid()}",
            "link set lo up multicast on",
            f"address add 10.77.0.{number}/24 dev eth0",
            "link set eth0 up",
            *_ROUTES,
            "route replace 239.255.76.67/32 dev lo src 127.0.0.1",
        )

    def set_down(self, what: str, down: bool) -> None:
        """The far end of its cable, or its own interface: with that its routes go, and come back only when something (a
        network manager) sets them again."""
        state = "down" if down else "up"
        if what == "link":
            run_ip(f"link set {self.port} {state}")
        else:
            self.run(f"link set eth0 {state}", *(() if down else _ROUTES))

    def shape(self, words: Sequence[str]) -> None:
        """A queueing discipline for what it sends."""
        subprocess.run(self.command(["tc", "qdisc", "add", "dev", "eth0", "root", *words]), check=True)


@contextmanager
def hosts(names: Sequence[str], disturbance: str, *, seed: int, switch: str) -> Iterator[dict[str, Host]]:
    """All connected. The switch is this kernel's bridge ("bridge"), the bridge with netem ("netem") or our relay
    ("relay"): only the last two lose and delay. To be called in a network namespace of the caller's own."""
    chosen = DISTURBANCES[disturbance]
    with ExitStack() as stack:
        made = {name: Host(name, number) for number, name in enumerate(names, 1)}
        for host in made.values():
            stack.callback(host.close)
            stack.callback(run_ip, f"link delete {host.port}")
            run_ip(f"link set {host.port} up")
        if switch == "relay":
            ports = [host.port for host in made.values()]
            words = [
                "setpriv",
                "--pdeathsig",
                "KILL",
                sys.executable,
                HERE / "relay.py",
                disturbance,
                str(seed),
                *ports,
            ]
            relay = stack.enter_context(Child(words, Path(stack.enter_context(_folder())), "relay"))
            relay.wait_until(lambda: "ready" in relay.stdout(), 10.0, "being ready")
        else:
            run_ip("link add lan type bridge mcast_snooping 0", "link set lan up")
            stack.callback(run_ip, "link delete lan")
            for host in made.values():
                run_ip(f"link set {host.port} master lan")
                if words := netem_words(chosen) if switch == "netem" else []:
                    host.shape(words)
        if chosen.rate_mbit:
            for host in made.values():
                host.shape(["tbf", "rate", f"{chosen.rate_mbit:g}mbit", "burst", "32kb", "latency", "400ms"])
        yield made
        if switch == "relay" and relay.process.poll() is not None:
            raise relay.error("the relay ended in the middle")


@contextmanager
def _folder() -> Iterator[str]:
    with tempfile.TemporaryDirectory(prefix="pilotfish-network-") as folder:
        yield folder


class Listener:
    """Somebody who watches: what reaches a host on the shared bus, by channel."""

    def __init__(self, host: Host, url: str, channels: str = ".*") -> None:
        self.count: dict[str, int] = {}
        self.bytes = 0
        self.longest_gap_s: dict[str, float] = {}
        self._last_s: dict[str, float] = {}
        with host.entered():
            self._bus = lcm.LCM(url)
            self._bus.subscribe(channels, self._heard)

    def listen(self, seconds: float) -> None:
        """Handles what comes in that time."""
        end_s = time.monotonic() + seconds
        while (left_s := end_s - time.monotonic()) > 0:
            self._bus.handle_timeout(max(int(left_s * 1e3), 1))

    def _heard(self, channel: str, data: bytes) -> None:
        now_s = time.monotonic()
        self.count[channel] = self.count.get(channel, 0) + 1
        self.bytes += len(data)
        if channel in self._last_s:
            self.longest_gap_s[channel] = max(self.longest_gap_s.get(channel, 0.0), now_s - self._last_s[channel])
        self._last_s[channel] = now_s

"""Run inside a fresh network namespace (unshare --net): this host, and another one at the end of a cable. Prints as
JSON whose messages were received on LCM's port with and without our firewall rule, and what the rule counted.

    unshare --net python two_hosts.py pilotfish.nft
"""

import json
import socket
import struct
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

GROUP, PORT = "239.255.76.67", 7667
HERE, THERE = "192.0.2.1", "192.0.2.2"
SENDS = 5


def ip(*words, namespace=()):
    subprocess.run([*namespace, "ip", *words], check=True)


def is_up(device):
    shown = subprocess.run(["ip", "-j", "link", "show", device], capture_output=True, check=True).stdout
    return json.loads(shown)[0]["operstate"] == "UP"


def network_of(pid):
    return Path(f"/proc/{pid}/ns/net").readlink()


def wait_for(condition, what):
    deadline = time.monotonic() + 10.0
    while not condition():
        if time.monotonic() > deadline:
            raise SystemExit(f"{what}: not within 10 s")
        time.sleep(0.01)


def send(namespace, text, address):
    program = f"import socket; socket.socket(2, 2).sendto({text.encode()!r}, {(address, PORT)!r})"
    subprocess.run([*namespace, sys.executable, "-c", program], check=True)


def dropped():
    listed = subprocess.run(["nft", "-j", "list", "table", "inet", "pilotfish"], capture_output=True, check=True).stdout
    rules = [entry["rule"] for entry in json.loads(listed)["nftables"] if "rule" in entry]
    return sum(part["counter"]["packets"] for rule in rules for part in rule["expr"] if "counter" in part)


def main(ruleset):
    own_network = network_of("self")
    with subprocess.Popen(["unshare", "--net", "sleep", "60"]) as other:
        try:
            wait_for(lambda: network_of(other.pid) != own_network, "another host")
            there = ["nsenter", "--target", str(other.pid), "--net"]
            ip("link", "set", "lo", "up", "multicast", "on")
            ip("link", "add", "here", "type", "veth", "peer", "name", "there", "netns", str(other.pid))
            ip("address", "add", f"{HERE}/24", "dev", "here")
            ip("link", "set", "here", "up")
            ip("route", "add", f"{GROUP}/32", "dev", "lo", "src", "127.0.0.1")
            ip("address", "add", f"{THERE}/24", "dev", "there", namespace=there)
            ip("link", "set", "there", "up", namespace=there)
            ip("route", "add", f"{GROUP}/32", "dev", "there", namespace=there)
            # That the cable is up takes a moment; packets sent before it are lost, with and without a rule.
            wait_for(lambda: is_up("here"), "the cable")
            print(json.dumps(play(ruleset, there)))
        finally:
            other.kill()


def play(ruleset, there):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listening:
        listening.bind(("0.0.0.0", PORT))  # as LCM does
        for interface in ("lo", "here"):
            member = struct.pack("4s4si", socket.inet_aton(GROUP), bytes(4), socket.if_nametoindex(interface))
            listening.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        received = set()

        def hear(expected):
            wait_for(lambda: received_all(listening, received, expected), f"receiving {expected}, received {received}")

        send([], "inside", GROUP)
        send(there, "outside", GROUP)
        send(there, "outside, to us alone", HERE)
        hear({"inside", "outside", "outside, to us alone"})
        open_to_all = sorted(received)

        subprocess.run(["nft", "-f", ruleset], check=True)
        subprocess.run(["nft", "-f", ruleset], check=True)  # a second time changes nothing
        received.clear()
        for _ in range(SENDS):
            send(there, "outside", GROUP)
            send(there, "outside, to us alone", HERE)
        wait_for(lambda: dropped() == 2 * SENDS, "dropping what comes from outside")
        send([], "inside", GROUP)
        hear({"inside"})
        return {"open": open_to_all, "guarded": sorted(received), "dropped": dropped()}


def received_all(listening, received, expected):
    listening.settimeout(0.05)
    with suppress(TimeoutError):
        received.add(listening.recv(100).decode())
    return received >= expected


if __name__ == "__main__":
    main(sys.argv[1])

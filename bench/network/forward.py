"""Forwards chosen channels between the bus of a robot's own host and the bus between the hosts, byte for byte.

python bench/network/forward.py --out 'ROBOT1_(STATUS|POSE|BASE)' --in 'LEADER_MOTION|ROBOT1_SETPOINT'

A channel must not be in both, in no host: what was forwarded once would be forwarded back.
"""

from __future__ import annotations

import argparse
import select
import sys

import lcm

LOCAL_URL = "udpm://239.255.76.67:7667?ttl=0"
SHARED_URL = "udpm://239.255.76.68:7668?ttl=1"
BUFFER = "&recv_buf_size=4194304"


def forward(source: lcm.LCM, target: lcm.LCM, channels: str) -> None:
    """What `source` receives on the channels (a regular expression for whole names) goes out on `target`."""

    def send(channel: str, data: bytes) -> None:
        try:
            target.publish(channel, data)
        except OSError:
            return  # no route just now: the link is down, and a message is lost as if on the air

    if channels:
        source.subscribe(channels, send)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", default="", help="channels from the local bus to the shared one; a regular expression")
    parser.add_argument("--in", dest="inside", default="", help="channels from the shared bus to the local one")
    parser.add_argument("--local-url", default=LOCAL_URL + BUFFER, help=f"default: {LOCAL_URL}")
    parser.add_argument("--shared-url", default=SHARED_URL + BUFFER, help=f"default: {SHARED_URL}")
    chosen = parser.parse_args()
    local, shared = lcm.LCM(chosen.local_url), lcm.LCM(chosen.shared_url)
    forward(local, shared, chosen.out)
    forward(shared, local, chosen.inside)
    print("ready", flush=True)
    receiving = [bus for bus, channels in ((local, chosen.out), (shared, chosen.inside)) if channels]
    while True:
        for bus in select.select(receiving, [], [])[0]:
            bus.handle_timeout(0)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit(130)

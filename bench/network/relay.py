"""A switch that loses, delays and reorders: what tc-netem(8) does, for kernels without it; seeded.

A process of its own, between the hub's ends of the virtual cables: every frame that comes in on one goes out on all
others, each copy with a fate of its own. PACKET_VNET_HDR hands on what the sender's kernel left to the network card
(checksums).
"""

from __future__ import annotations

import argparse
import heapq
import itertools
import random
import select
import socket
import time

from disturbances import DISTURBANCES, Disturbance

_SOL_PACKET, _PACKET_VNET_HDR, _PACKET_IGNORE_OUTGOING, _ETH_P_ALL = 263, 15, 23, 0x0003  # linux/if_packet.h


def delay_s(disturbance: Disturbance, rng: random.Random) -> float | None:
    """How long a packet is under way; None: for ever."""
    if rng.random() < disturbance.loss:
        return None
    if disturbance.reorder and rng.random() < disturbance.reorder:
        return 0.0
    return max(rng.gauss(disturbance.delay_ms, disturbance.jitter_ms), 0.0) * 1e-3


def relay(ports: list[str], disturbance: Disturbance, seed: int) -> None:
    """For ever."""
    rng = random.Random(seed)
    sockets = [_open(port) for port in ports]
    under_way: list[tuple[float, int, socket.socket, bytes]] = []
    order = itertools.count()
    print("ready", flush=True)
    while True:
        wait_s = max(under_way[0][0] - time.monotonic(), 0.0) if under_way else None
        for came_in in select.select(sockets, [], [], wait_s)[0]:
            try:
                frame, now_s = came_in.recv(65536 + 64), time.monotonic()
            except OSError:
                continue  # its link went down, which is said once; the socket remains, for when the link is up again
            for out in sockets:
                if out is not came_in and (later_s := delay_s(disturbance, rng)) is not None:
                    heapq.heappush(under_way, (now_s + later_s, next(order), out, frame))
        while under_way and under_way[0][0] <= time.monotonic():
            _, _, out, frame = heapq.heappop(under_way)
            try:
                out.send(frame)
            except OSError:
                continue  # its link is down, or its queue is full: a packet is lost, as on any switch


def _open(port: str) -> socket.socket:
    opened = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(_ETH_P_ALL))
    opened.setsockopt(_SOL_PACKET, _PACKET_VNET_HDR, 1)
    opened.setsockopt(_SOL_PACKET, _PACKET_IGNORE_OUTGOING, 1)
    opened.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
    opened.bind((port, 0))
    while True:  # a link that is taken down leaves an error to be read once
        try:
            opened.recv(65536, socket.MSG_DONTWAIT)
        except BlockingIOError:
            opened.setblocking(True)
            return opened


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("disturbance", choices=DISTURBANCES)
    parser.add_argument("seed", type=int)
    parser.add_argument("ports", nargs="+")
    chosen = parser.parse_args()
    relay(chosen.ports, DISTURBANCES[chosen.disturbance], chosen.seed)

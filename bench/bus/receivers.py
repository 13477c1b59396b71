"""The receivers that are compared, each in a process of its own on a bus of its own."""

from __future__ import annotations

import multiprocessing as mp
import struct
import time
from collections.abc import Callable
from multiprocessing.connection import Connection

import lcm

from pilotfish import bus, core
from pilotfish.harness.ports import private_lcm_url

CHANNEL = "ROBOT1_IMAGE"
UTIME_AT = 8  # bytes of fingerprint before it


def _liblcm(url: str, came: Callable[[int], None]) -> Callable[[], object]:
    receiver = lcm.LCM(url)
    receiver.subscribe(CHANNEL, lambda _, data: came(struct.unpack_from(">q", data, UTIME_AT)[0]))
    return lambda: receiver.handle_timeout(20)


def _encoded(url: str, came: Callable[[int], None]) -> Callable[[], object]:
    receiver = bus.Bus(url)
    receiver.on_encoded_image(CHANNEL, lambda image: came(image.utime))
    return lambda: receiver.handle(20)


def _decoded(url: str, came: Callable[[int], None]) -> Callable[[], object]:
    receiver = bus.Bus(url)
    receiver.on_image(CHANNEL, lambda frame: came(frame.utime))
    return lambda: receiver.handle(20)


RECEIVERS = {"liblcm alone": _liblcm, "Bus, encoded": _encoded, "Bus, decoded": _decoded}


def _run(name: str, url: str, link: Connection) -> None:
    delays_us: list[int] = []
    handle = RECEIVERS[name](url, lambda utime: delays_us.append(core.monotonic_now_us() - utime))
    handle()
    link.send("listens")
    while not link.poll():
        handle()
    link.recv()
    link.send((delays_us, time.process_time()))


class Receiver:
    """Sends to a receiver, and in the end asks it how long each picture took."""

    def __init__(self, name: str) -> None:
        self.name, self.url = name, private_lcm_url()
        self.sender = lcm.LCM(self.url)
        self.link, theirs = mp.Pipe()
        self.process = mp.get_context("spawn").Process(target=_run, args=(name, self.url, theirs), daemon=True)
        self.process.start()
        assert self.link.recv() == "listens"

    def finish(self) -> tuple[list[int], float]:
        """Delays [us], and the CPU time of the whole process [s]."""
        self.link.send("enough")
        answer = self.link.recv()
        self.process.join()
        return answer

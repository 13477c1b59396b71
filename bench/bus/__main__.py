"""Our receiver beside liblcm's own: the same pictures from the same sender.

Takes: 2 minutes.
Needs, for raw pictures, a kernel that grants a receive buffer of 4 MiB (``sysctl net.core.rmem_max``).
"""

from __future__ import annotations

import json
import platform
import sys
import time
from pathlib import Path
from typing import Annotated

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import numpy as np
import typer
from receivers import CHANNEL, RECEIVERS, Receiver
from rich.console import Console
from rich.table import Table

from bench.common import wire
from pilotfish import core

FRAME_RATE_HZ = 30.0
FLOOD_DATAGRAMS, FLOOD_BYTES = 20_000, 1000
console = Console()


def transport_us(frames: int, jpeg: bool) -> dict[str, np.ndarray]:
    """How long each picture took from before publish() into the handler. The receivers get theirs in turn, so what
    disturbs the machine disturbs all of them."""
    v, u = np.mgrid[0:480, 0:640]
    picture = (128 + 60 * np.sin(u / 9) + 60 * np.cos(v / 7)).astype(np.uint8)
    picture += np.random.default_rng(1).integers(0, 8, picture.shape, dtype=np.uint8)
    message = bytearray(wire.encode_image(picture, utime=0, jpeg=jpeg))
    receivers = [Receiver(name) for name in RECEIVERS]
    period_s = 1.0 / FRAME_RATE_HZ / len(receivers)
    due = time.monotonic()
    for _ in range(frames + 10):
        for receiver in receivers:
            due += period_s
            time.sleep(max(0.0, due - time.monotonic()))
            message[8:16] = core.monotonic_now_us().to_bytes(8, "big")
            receiver.sender.publish(CHANNEL, bytes(message))
    time.sleep(0.2)
    return {receiver.name: np.array(receiver.finish()[0][10:]) for receiver in receivers}


def flood_us() -> dict[str, float]:
    """CPU time of a receiver's process per datagram on a channel without a subscriber."""
    cost = {}
    for name in RECEIVERS:
        idle = Receiver(name)
        time.sleep(0.5)
        _, idle_s = idle.finish()
        flooded = Receiver(name)
        for k in range(FLOOD_DATAGRAMS):
            flooded.sender.publish("SOMEBODY_ELSE", bytes(FLOOD_BYTES))
            if k % 100 == 0:
                time.sleep(0.002)
        time.sleep(0.2)
        _, flooded_s = flooded.finish()
        cost[name] = max(0.0, flooded_s - idle_s) / FLOOD_DATAGRAMS * 1e6
    return cost


def main(
    frames: Annotated[int, typer.Option(help="Pictures a receiver.")] = 1500,
    out: Annotated[Path, typer.Option(help="Folder for bus.json.")] = Path("out/bench"),
) -> None:
    """Time 640x480 pictures at 30 Hz from publish() into the handler."""
    flood = flood_us()
    result: dict[str, object] = {"machine": f"{platform.machine()}, {platform.system()} {platform.release()}"}
    for kind, jpeg in (("raw", False), ("JPEG", True)):
        delays = transport_us(frames, jpeg)
        table = Table(title=f"640x480 {kind}, {FRAME_RATE_HZ:.0f} Hz, publish() to handler", title_justify="left")
        table.add_column("receiver")
        headings = ["arrived", "p50 [ms]", "p99 [ms]", "p99.9 [ms]", "p50, ratio to liblcm", "flood [us CPU/datagram]"]
        for heading in headings:
            table.add_column(heading, justify="right")
        baseline = float(np.median(delays["liblcm alone"]))
        for name, delay in delays.items():
            p50, p99, p999 = (float(np.percentile(delay, q)) / 1e3 for q in (50, 99, 99.9))
            row = [len(delay) / frames, p50, p99, p999, p50 * 1e3 / baseline, flood[name]]
            result[f"{kind}, {name}"] = dict(zip(headings, row, strict=True))
            table.add_row(name, f"{row[0]:.1%}", *(f"{value:.3f}" for value in row[1:4]), f"{row[4]:.2f}",
                          f"{row[5]:.1f}")  # fmt: skip
        console.print(table)
    out.mkdir(parents=True, exist_ok=True)
    (out / "bus.json").write_text(json.dumps(result, indent=2) + "\n")
    console.print(f"wrote {out / 'bus.json'}")


if __name__ == "__main__":
    typer.run(main)

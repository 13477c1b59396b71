"""What is done to the link between the hosts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Disturbance:
    """Of every packet that crosses; loss, delay and reordering as tc-netem(8) defines them."""

    words: str
    loss: float = 0.0  # probability that a packet is lost
    delay_ms: float = 0.0  # mean of a normal distribution, never below 0
    jitter_ms: float = 0.0  # its standard deviation
    reorder: float = 0.0  # probability that a packet is not delayed at all, and so overtakes others
    rate_mbit: float = 0.0  # of every host's sending, by tc-tbf(8); 0: not limited
    down: Literal["", "link", "interface"] = ""  # for half of the drive: far end, or own interface


FROM = 0.4  # of a drive: settled before (after 3.9 s at the latest), and from then on it counts
DOWN = 0.5  # of a drive: so long the link is down, from FROM on

DISTURBANCES = {
    "none": Disturbance("ideal link"),
    "loss-5": Disturbance("5 % lost", loss=0.05),
    "loss-20": Disturbance("20 % lost", loss=0.2),
    "loss-50": Disturbance("50 % lost", loss=0.5),
    "delay-20": Disturbance("20 ± 5 ms", delay_ms=20.0, jitter_ms=5.0),
    "delay-100": Disturbance("100 ± 25 ms", delay_ms=100.0, jitter_ms=25.0),
    "delay-300": Disturbance("300 ± 75 ms", delay_ms=300.0, jitter_ms=75.0),
    "reorder": Disturbance("a quarter 50 ms early", delay_ms=50.0, reorder=0.25),
    "rate-20": Disturbance("20 Mbit/s", rate_mbit=20.0),
    "link-down": Disturbance("link down", down="link"),
    "interface-down": Disturbance("interface down", down="interface"),
}


def netem_words(disturbance: Disturbance) -> list[str]:
    """What stands behind `tc qdisc add dev eth0 root`; empty where nothing is to be done."""
    words = []
    if disturbance.loss:
        words += ["loss", f"{100 * disturbance.loss:g}%"]
    if disturbance.delay_ms:
        words += ["delay", f"{disturbance.delay_ms:g}ms"]
        if disturbance.jitter_ms:
            words += [f"{disturbance.jitter_ms:g}ms", "distribution", "normal"]
    if disturbance.reorder:
        words += ["reorder", f"{100 * disturbance.reorder:g}%"]
    return ["netem", *words] if words else []

"""The loop around a ``CommandGate``: from the bus to a publisher of /cmd_vel."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable
from pathlib import Path

from pilotfish import core
from pilotfish.bus import Bus, BusError, channel, load_key
from pilotfish.errors import ConfigError, SilentRobotError, UsageError
from pilotfish.ros.command_gate import CommandGate, GatedCommand

REAL_TIME_PRIORITY = 20  # as pilotfish-base
_LAST_ZEROS = 3  # a datagram may be lost


def open_link(robot: str, lcm_url: str = "", key_file: Path | None = None) -> Bus:
    """The bus that ``robot`` is commanded on. UsageError for a name that is none, ConfigError for a URL or key that is
    none; SilentRobotError if the bus cannot be opened."""
    try:
        channel(robot, "BASE")
    except ValueError as error:
        raise UsageError(str(error)) from error
    try:
        link = Bus(lcm_url)
        if key_file is not None:
            link.set_key(load_key(str(key_file)))
    except BusError as error:
        raise SilentRobotError(str(error)) from error
    except ValueError as error:
        raise ConfigError(str(error)) from error
    return link


def request_real_time() -> bool:
    """SCHED_FIFO for this thread and those that it starts, so that a busy computer delays no zero; whether it was
    granted (root, or ``ulimit -r``)."""
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(REAL_TIME_PRIORITY))
    except PermissionError:
        return False
    return True


def stop_on_signals() -> threading.Event:
    """Set by SIGINT, SIGTERM and SIGHUP, which then end nothing by themselves."""
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda *_: stop.set())
    return stop


def forward_commands(
    link: Bus,
    robot: str,
    publish: Callable[[GatedCommand], None],
    *,
    stop: threading.Event,
    rate_hz: float = 50.0,
    on_reason: Callable[[str], None] = lambda reason: None,
) -> None:
    """Publishes what ``robot``'s wheels are to do, until ``stop`` is set: at every change, at the moment it becomes
    invalid, and ``rate_hz`` times a second in any case, zeros included. Leaves, also by an exception, with zeros.

    ``on_reason`` gets why the wheels stand still, whenever that changes; an empty text while they are driven.
    """
    gate = CommandGate()
    link.on_command(robot, lambda report: gate.on_command(report, link.arrival_us))
    link.on_base(robot, lambda report: gate.on_base(report, link.arrival_us, time.time_ns() // 1000))
    period_us = round(1e6 / rate_hz)
    due_us, wake_us, last, reason = 0, 0, None, None
    try:
        while not stop.is_set():
            # Rounded up: a wait that ends before the moment would spin until it has come.
            link.handle(max(0, -((core.monotonic_now_us() - wake_us) // 1000)))
            command = gate.at(now_us := core.monotonic_now_us())
            if command.twist != last or now_us >= due_us:
                publish(command)
                last, due_us = command.twist, now_us + period_us
            if command.reason != reason:
                on_reason(reason := command.reason)
            wake_us = min(due_us, command.until_us or due_us)
    finally:
        for _ in range(_LAST_ZEROS):
            publish(GatedCommand(core.Twist(), 0, 0, "this bridge ends"))

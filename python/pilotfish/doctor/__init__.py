"""Looks at the machine for ``pilotfish doctor``: each check is a function of a Host, and says what is to be done.

from pilotfish import doctor
for finding in doctor.examine():
    print(finding.check, finding.verdict.value, finding.seen, finding.advice)
"""

from __future__ import annotations

from collections.abc import Callable

from pilotfish.doctor import (
    bus_checks,
    camera,
    devices,
    network,
    ports,
    programs,
    robot_files,
    system,
    tools,
    wheel_limits,
)
from pilotfish.doctor.finding import Finding, Verdict, note
from pilotfish.doctor.following.setup import Setup
from pilotfish.doctor.host import Host

__all__ = ["Finding", "Host", "Verdict", "examine"]


def examine(
    host: Host | None = None,
    *,
    lcm_url: str = network.DEFAULT_URL,
    listen_s: float = 1.0,
    black_box: str = system.BLACK_BOX,
    setup: Setup | None = None,
) -> list[Finding]:
    """Every check, one after the other. Nothing raises: what cannot be looked at becomes a note.

    With the ``setup`` of a coordinator its camera is opened and measured, and its name is looked for on the bus.
    """
    host = host or Host()
    found: list[Finding] = []

    def look(name: str, check: Callable[[], Finding | list[Finding]]) -> None:
        try:
            result = check()
        except Exception as error:  # a bare or strange machine is what this is for
            result = note(name, f"could not be looked at: {type(error).__name__}: {error}")
        found.extend(result if isinstance(result, list) else [result])

    for name, needed in programs.PROGRAMS.items():
        look(name, lambda name=name, needed=needed: programs.check_program(host, name, needed))
    look("versions", lambda: tools.check_versions(host))
    look("liblcm", lambda: system.check_liblcm(host))
    look("lcm tools", lambda: tools.check_lcm_tools(host))
    look("java", lambda: tools.check_java(host))
    group = network.group_of(lcm_url)
    if group:
        look("multicast route", lambda: network.check_route(host, group))
        look("multicast", lambda: network.check_multicast(group))
        look("receive buffer", lambda: network.check_receive_buffer(host))
        look("port", lambda: ports.check_port(host, group.port))
    if any(finding.check == "multicast" and finding.verdict is Verdict.wrong for finding in found):
        found.append(note("bus", "not listened to: it receives nothing"))
    else:
        name = setup.name if setup else None
        look("bus", lambda: bus_checks.check_bus(lcm_url, listen_s, name))
    look("firewall", lambda: system.check_firewall(host))
    look("camera", lambda: devices.check_cameras(host))
    if setup:
        look("robot's files", lambda: robot_files.check_robot_files(setup))
        look(wheel_limits.CHECK, lambda: wheel_limits.check_wheel_limits(setup.file))
        look("camera of the robot", lambda: camera.check_camera(host, setup))
    look("serial line", lambda: devices.check_serial_lines(host))
    look("real time", lambda: system.check_real_time(host))
    look("CPU governor", lambda: system.check_governor(host))
    look("clock source", lambda: system.check_clock(host))
    look("time of day", lambda: system.check_time(host))
    look("disk", lambda: system.check_disk(host, black_box))
    return found

"""Why there is no coordinator on the bus: what runs on this host, what the service says, who else speaks."""

from __future__ import annotations

import difflib

from pilotfish.doctor.following.cause import Cause
from pilotfish.doctor.following.setup import Process
from pilotfish.doctor.following.watch import Watched
from pilotfish.doctor.host import Host


def no_coordinator(watched: Watched, url: str, processes: list[Process], host: Host) -> list[Cause]:
    """The causes, the most likely one first."""
    robot = watched.robot
    if watched.unreadable:
        listed = ", ".join(f"{channel} ({count})" for channel, count in watched.unreadable.items())
        return [
            Cause(
                "other_version",
                f"messages of {robot} cannot be read by this version: {listed}",
                "install programs and package of one version: pilotfish doctor shows the versions",
            )
        ]
    head = f"no coordinator of {robot} on the bus {url} within {watched.seconds:g} s"
    if watched.others:
        near = difflib.get_close_matches(robot, sorted(watched.others), 1)
        meant = f"; do you mean {near[0]}?" if near else ""
        other = near[0] if near else sorted(watched.others)[0]
        return [
            Cause(
                "another_name",
                f"{head}, but of {', '.join(sorted(watched.others))}{meant}",
                f"pilotfish doctor --following {other}, or start one for {robot}",
            )
        ]
    if processes:
        listed = "; ".join(map(str, processes))
        return [
            Cause(
                "another_bus",
                f"{head}; on this host there runs {listed}",
                "has it another --lcm-url or --name? Give the same to this command; "
                "pilotfish doctor says whether multicast works",
            )
        ]
    return [Cause("no_coordinator", f"{head}, and none runs on this host{_service(host, robot)}", _start(robot))]


def _start(robot: str) -> str:
    return (
        f"systemctl start pilotfish-coordinator@{robot}, or: pilotfish-coordinator --config FILE --source camera:0; "
        "exit code 69 is a camera that cannot be opened, 78 a wrong configuration. Does it run on another computer? "
        "Then both need ttl=1 in --lcm-url"
    )


def _service(host: Host, robot: str) -> str:
    """Of the Debian package, or of `pilotfish init`."""
    for unit in (f"pilotfish-coordinator@{robot}", f"pilotfish-{robot}-coordinator"):
        shown = host.run(["systemctl", "show", unit, "--property=LoadState,ActiveState,ExecMainStatus"])
        if shown is None or shown.returncode != 0:
            continue
        values = dict(line.partition("=")[::2] for line in shown.stdout.splitlines())
        active, code = values.get("ActiveState", "unknown"), values.get("ExecMainStatus", "0")
        if values.get("LoadState") == "loaded" and (active != "inactive" or code != "0" or "@" not in unit):
            return f"; its service {unit} is {active}, last exit code {code}"
    return ""

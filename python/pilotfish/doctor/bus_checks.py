"""Other senders on the bus: receives on all channels for a moment."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

from pilotfish.doctor.finding import Finding, note, ok, wrong

_SHOWN = 12


@dataclass
class Channel:
    """What was received on one channel."""

    messages: int = 0
    payload_bytes: int = 0
    sessions: set[int] = field(default_factory=set)  # of the senders, where the channel carries commands
    unreadable: int = 0

    def receive(self, channel: str, data: bytes) -> None:
        """Counts a message, and whose command it is if it is one."""
        from pilotfish.lcmtypes.pilotfish import command_t

        self.messages += 1
        self.payload_bytes += len(data)
        if not channel.endswith("_COMMAND"):
            return
        try:
            self.sessions.add(command_t.decode(data).session)
        except Exception:  # lcm-gen's decoders raise whatever the bytes lead to
            self.unreadable += 1


def listen(url: str, seconds: float) -> dict[str, Channel]:
    """Everything that is sent on the bus within `seconds`. Raises whatever LCM raises where there is no bus."""
    import lcm

    received: dict[str, Channel] = {}
    bus = lcm.LCM(url)
    bus.subscribe(".*", lambda channel, data: received.setdefault(channel, Channel()).receive(channel, data))
    until = time.monotonic() + seconds
    while (left_s := until - time.monotonic()) > 0:
        bus.handle_timeout(max(1, int(left_s * 1000)))
    return received


def findings_of(received: dict[str, Channel], seconds: float) -> list[Finding]:
    """Pure: what the channels mean. One sender of commands a robot, or something is wrong."""
    findings = []
    for name, channel in sorted(received.items()):
        if len(channel.sessions) > 1:
            sessions = ", ".join(f"{session & (2**64 - 1):016x}" for session in sorted(channel.sessions))
            findings.append(
                wrong(
                    "senders",
                    f"{len(channel.sessions)} send on {name} (sessions {sessions})",
                    "one robot, one coordinator: end all but one, or give each a name (--name)",
                )
            )
        if channel.unreadable:
            findings.append(
                wrong(
                    "senders",
                    f"{channel.unreadable} of {channel.messages} messages on {name} are no commands of this version",
                    "use programs of one version; pilotfish-spy shows what is sent",
                )
            )
    return [_summary(received, seconds), *findings]


def _summary(received: dict[str, Channel], seconds: float) -> Finding:
    if not received:
        return ok("bus", f"quiet for {seconds:g} s")
    lines = [
        f"{name} {channel.messages / seconds:.1f} Hz {channel.payload_bytes / seconds / 1000:.1f} kB/s"
        for name, channel in sorted(received.items())
    ]
    more = [f"and {len(lines) - _SHOWN} more channels"] if len(lines) > _SHOWN else []
    return ok("bus", "\n".join(lines[:_SHOWN] + more))


def name_taken(received: dict[str, Channel], robot: str) -> Finding:
    """Pure: whether a coordinator of this name speaks already; a second one does not start."""
    channel = received.get(f"{robot.upper()}_COMMAND")
    if channel is None:
        return ok("name", f"{robot} is free: nobody sends its commands")
    return note(
        "name",
        f"a coordinator of {robot} is on the bus: a second one of this name does not start",
        f"pilotfish doctor --following {robot} says how it does; another robot needs another --name",
    )


def check_bus(url: str, seconds: float, robot: str | None = None) -> list[Finding]:
    """What goes over the bus at ``url`` within ``seconds`` [s]; a note if it cannot be listened to. With a ``robot``
    also whether its name is taken."""
    try:
        received = listen(url, seconds)
        return [*findings_of(received, seconds), *([name_taken(received, robot)] if robot else [])]
    except ImportError:
        return [note("bus", "not listened to: the Python package lcm is missing", "pip install lcm")]
    except RuntimeError as error:
        return [wrong("bus", f"{url} cannot be opened: {error}", "see the multicast checks above")]

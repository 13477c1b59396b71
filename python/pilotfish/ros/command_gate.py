"""Which command may leave for wheels that are not pilotfish-base's own.

``pilotfish-base --driver dry_run`` has applied every rule of a wheel driver (one session, rising counters, validity,
limits, a latched stop) and says on NAME_BASE what the wheels should do. Three things are left to whoever passes it on:

- NAME_BASE can end, because that process was stopped or killed. Its last command is then valid for ``hold_us`` longer.
- When it ends, its last command can be ``hold_us`` old already. So the coordinator's own commands are watched, too, and
  the wheels' command is valid no longer than the newest of the accepted session: ``hold_us`` after its arrival, and not
  beyond its ``valid_until_us``.
- Wheels that are not real may execute a simulator's commands, and ``dry_run`` does. Those that this gate lets pass are
  for real ones.

All times are CLOCK_BOOTTIME of one computer: the bridge must run on that of pilotfish-base; the coordinator need not.
States of a base on another computer, and recorded ones, do not fit this clock and are refused.
"""

from __future__ import annotations

from dataclasses import dataclass

from pilotfish.bus import BaseReport, CommandReport
from pilotfish.core import SequenceGuard, SequenceVerdict, Twist

HOLD_US = 95_000  # as commands.max_command_age_s of pilotfish-base: 5 ms are left for the way to the wheels
TAKEOVER_US = 500_000  # a process that is silent for longer has ended, and another one may follow
CLOCK_TOLERANCE_US = 5_000  # between a stamp and an arrival on the same clock
WALL_TOLERANCE_US = 1_000_000  # a recording of before a reboot could fit the monotonic clock by chance
MAX_SESSIONS = 8


@dataclass(frozen=True)
class GatedCommand:
    """What the wheels are to do now, and why they stand still, if they do."""

    twist: Twist
    """Base frame: forward speed [m/s], turn rate to the left [rad/s]."""
    until_us: int
    """It is zero from then on, if nothing more arrives (CLOCK_BOOTTIME); of a zero: 0."""
    utime: int
    """Wall clock at which pilotfish-base gave it [us]; of a zero: 0."""
    reason: str
    """Empty while it drives."""


@dataclass
class _Sender:
    counter: int
    until_us: int
    simulated: bool


class CommandGate:
    """Give it every NAME_BASE and NAME_COMMAND; ``at(now_us)`` is the command for the wheels. Holds no clock."""

    def __init__(self, hold_us: int = HOLD_US) -> None:
        self._hold_us = hold_us
        self._guard: SequenceGuard | None = None
        self._heard_us = 0
        self._base: BaseReport | None = None
        self._base_until_us = 0
        self._refusal = "no message of pilotfish-base yet"
        self._senders: dict[int, _Sender] = {}

    def on_command(self, report: CommandReport, arrival_us: int) -> None:
        """A coordinator's command. ``arrival_us``: when it reached this computer (``Bus.arrival_us``)."""
        sender = self._senders.get(report.session)
        if report.session == 0 or (sender and report.counter <= sender.counter):
            return
        moves = report.command != Twist()
        until_us = min(arrival_us + self._hold_us, report.valid_until_us) if moves else 0
        self._senders.pop(report.session, None)
        self._senders[report.session] = _Sender(report.counter, until_us, report.simulated)
        if len(self._senders) > MAX_SESSIONS:  # the one not heard for the longest time
            del self._senders[next(iter(self._senders))]

    def on_base(self, report: BaseReport, arrival_us: int, wall_us: int) -> None:
        """The state of pilotfish-base. ``wall_us``: now, by the wall clock."""
        age_us = arrival_us - report.monotonic_us
        if not -CLOCK_TOLERANCE_US <= age_us <= self._hold_us or abs(wall_us - report.utime) > WALL_TOLERANCE_US:
            self._refusal = "pilotfish-base's clock is not this computer's, or its messages are late or recorded"
            return
        if self._guard is None or (report.session != self._guard.session and arrival_us > self._heard_us + TAKEOVER_US):
            self._guard = SequenceGuard(report.session)
        if self._guard.accept(report.session, report.counter) != SequenceVerdict.accepted:
            self._refusal = "two pilotfish-base of this name, or recorded messages of one"
            return
        self._refusal = "no message of pilotfish-base"
        self._heard_us = arrival_us
        self._base = report
        self._base_until_us = min(report.monotonic_us, arrival_us) + self._hold_us

    def at(self, now_us: int) -> GatedCommand:
        """The command for the wheels at ``now_us`` (CLOCK_BOOTTIME)."""
        base = self._base
        if base is None or self._base_until_us <= now_us:
            return _zero(self._refusal)
        if base.state != BaseReport.State.driving or base.stopped or base.command == Twist():
            return _zero(f"pilotfish-base: {base.text or base.state.name}")
        sender = self._senders.get(base.accepted_session)
        if sender is None:
            return _zero("no command of the session that pilotfish-base accepts has arrived here")
        if sender.simulated:
            return _zero("the commands are a simulator's or a recording's: not for real wheels")
        if sender.until_us <= now_us:
            return _zero("the coordinator's last command is too old, or zero")
        until_us = min(self._base_until_us, sender.until_us)
        return GatedCommand(base.command, until_us, base.utime, "")


def _zero(reason: str) -> GatedCommand:
    return GatedCommand(Twist(), 0, 0, reason)

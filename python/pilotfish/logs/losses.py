"""What a damaged file has cost: how many bytes of it cannot be read, and how long that was."""

from __future__ import annotations

from dataclasses import dataclass

from pilotfish.black_box.log import Damage


@dataclass
class Loss:
    """A damaged place, with the wall clock of the event before it and of the one after it [us]; None: there is none."""

    damage: Damage
    after_utime: int | None
    before_utime: int | None = None

    def text(self, start_utime: int) -> str:
        """For people; times count from ``start_utime``, when the recording began [us of the wall clock]."""
        file, size = self.damage.file.name, self.damage.size
        after = None if self.after_utime is None else (self.after_utime - start_utime) * 1e-6
        if self.before_utime is None:
            when = "" if after is None else f", {after:.2f} s after the recording began"
            what = f"{file} ends in the middle of an event{when}" if self.damage.at_end else f"{file} is damaged{when}"
            return f"{what}: its last {size} bytes cannot be read, and what was to follow them is not there"
        before = (self.before_utime - start_utime) * 1e-6
        what = f"{file}: {size} bytes at byte {self.damage.offset} are no events"
        if after is None:
            return f"{what}: the recording is read from what comes behind them"
        return f"{what}: up to {max(0.0, before - after):.2f} s are lost, between {after:.2f} and {before:.2f} s"

"""The time axis of a run, from stamps that may be set and clocks that may be another computer's."""

from __future__ import annotations

from dataclasses import dataclass

_DISAGREE_S = 1.0  # stamps and the recording's clock that part by more: the stamps' clock was set


@dataclass
class RunClock:
    """Seconds since ``start_utime``, the wall clock at the beginning of the recording [us].

    Between two frames the time of their stamps passes, because that is the time the law uses, and in lock-step the only
    one. Where the stamps do not advance, or jump, the recording's own clock bridges. Sums of differences would collect
    rounding errors, so time is counted from the last jump.
    """

    start_utime: int
    _anchor: tuple[float, int] | None = None  # t_s and utime of the first frame behind the last jump
    _latest_s: float = 0.0  # what is recorded later is not earlier, also where stamps run slower than the wall clock
    _last: tuple[float, int, int, int] | None = None  # t_s, utime, log_utime, arrival_us of the last frame

    def of_frame(self, utime: int, log_utime: int, arrival_us: int, *, simulated: bool) -> float:
        """The time of a frame [s]. ``arrival_us``: on the coordinator's monotonic clock, -1 if not known."""
        if self._last is None or self._anchor is None:
            t_s = max(0.0, (log_utime - self.start_utime) * 1e-6)
            self._anchor = (t_s, utime)
        else:
            last_s, last_utime, last_log, last_arrival = self._last
            known = arrival_us >= 0 and last_arrival >= 0 and arrival_us >= last_arrival
            elapsed_s = (arrival_us - last_arrival if known else max(0, log_utime - last_log)) * 1e-6
            stamps_s = (utime - last_utime) * 1e-6
            if stamps_s > 0 and (simulated or abs(stamps_s - elapsed_s) <= _DISAGREE_S):
                t_s = self._anchor[0] + (utime - self._anchor[1]) * 1e-6
            else:
                t_s = last_s + elapsed_s
                self._anchor = (t_s, utime)
        self._last = (t_s, utime, log_utime, arrival_us)
        return t_s

    def at(self, log_utime: int) -> float:
        """The time of anything else, by when it was recorded [s]."""
        if self._last is None:
            t_s = max(0.0, (log_utime - self.start_utime) * 1e-6)
        else:
            t_s = self._last[0] + max(0, log_utime - self._last[2]) * 1e-6
        self._latest_s = max(self._latest_s, t_s)
        return self._latest_s

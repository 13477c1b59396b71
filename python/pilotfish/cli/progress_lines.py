"""Progress where no bar can be drawn: in a pipe, a file or a service's log a line every few seconds."""

from __future__ import annotations

from collections.abc import Callable

EVERY_S = 5.0
BRIEF_S = 1.0  # work that ends sooner is not worth a line


def progress_lines(
    label: str,
    say: Callable[[str], None],
    now_s: Callable[[], float],
    every_s: float = EVERY_S,
    *,
    in_bytes: bool = False,
) -> Callable[[int, int | None], None]:
    """A function of (done, total) that says a line, at most every ``every_s``, and one at the end (done = total).

    ``now_s``: a monotonic clock. ``in_bytes``: what is counted are bytes, said as MB. Work that ends within BRIEF_S
    says nothing.
    """
    began_s = last_s = now_s()
    ended = False

    def step(done: int, total: int | None) -> None:
        nonlocal last_s, ended
        time_s = now_s()
        at_end = total is not None and done >= total
        if time_s - last_s >= every_s or (at_end and not ended and time_s - began_s >= BRIEF_S):
            say(progress_line(label, done, total, time_s - began_s, in_bytes=in_bytes))
            last_s, ended = time_s, at_end

    return step


def progress_line(label: str, done: int, total: int | None, elapsed_s: float, *, in_bytes: bool = False) -> str:
    """``label`` with the share that is done and how long it takes: so far, and still at this pace."""
    shown, whole = (f"{done / 1e6:.1f}", f"{(total or 0) / 1e6:.1f} MB") if in_bytes else (str(done), str(total))
    if not total:
        return f"{label}: {shown}{' MB' if in_bytes else ''}, {clock_text(elapsed_s)} so far"
    said = f"{label}: {done / total:.0%} ({shown} of {whole}), {clock_text(elapsed_s)} so far"
    left_s = remaining_s(done, total, elapsed_s)
    return said if left_s is None else f"{said}, {clock_text(left_s)} left"


def remaining_s(done: int, total: int, elapsed_s: float) -> float | None:
    """How long the rest takes if it goes on as it went on average; None before the first step."""
    return elapsed_s * max(0, total - done) / done if done > 0 else None


def clock_text(seconds: float) -> str:
    """Hours (where there are any), minutes and seconds: 0:07, 12:30, 1:02:03."""
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"

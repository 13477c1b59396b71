"""Simulates what is left of a campaign, and keeps every row."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pilotfish.sweep import store, workers
from pilotfish.sweep.campaign import Campaign
from pilotfish.sweep.play import Row
from pilotfish.sweep.workers import Stopping, Where

OnProgress = Callable[[int, int], None]
OnStarted = Callable[[str | None], None]
HERE = Where()
_FLUSH_S, _FLUSH_ROWS = 3.0, 5000


@dataclass(frozen=True)
class Summary:
    """What one call did."""

    total: int
    before: int  # runs that were done already
    outcomes: dict[str, int]  # of those that this call did
    cpu_s: float
    wall_s: float

    @property
    def done(self) -> int:
        """Runs that have a row now."""
        return self.before + sum(self.outcomes.values())


def run_campaign(
    campaign: Campaign,
    out: Path,
    where: Where = HERE,
    *,
    on_started: OnStarted | None = None,
    on_progress: OnProgress | None = None,
    on_warning: store.Say | None = None,
    stopping: Stopping = lambda: False,
    clock: Callable[[], float] = time.monotonic,
) -> Summary:
    """Every run that has no row in ``out`` yet. ``on_started`` gets the dashboard's address, or None; ``on_warning``
    that a part there is damaged, so that its runs are simulated again.

    The rows depend on the campaign alone: not on where they are made, by how many and in which order. Rows are on the
    disk at the latest some seconds after they were made."""
    schema = store.schema_of(campaign)
    with store.opened(out, campaign):
        done = store.take_stock(out, campaign.count, on_warning)
        left = np.setdiff1d(np.arange(campaign.count), done)
        outcomes: Counter[str] = Counter()
        cpu_s, began_s = 0.0, clock()
        if left.size:
            specs = [campaign.run(int(index)) for index in left]
            with workers.opened(where) as (client, dashboard):
                if on_started:
                    on_started(dashboard)
                began_s = clock()
                flushed_s = began_s - _FLUSH_S  # the first rows at once
                rows: list[Row] = []
                try:
                    for played in workers.played(client, campaign.job, specs, stopping):
                        rows += played.rows
                        outcomes.update(row["outcome"] for row in played.rows)
                        cpu_s += played.cpu_s
                        if on_progress:
                            on_progress(len(done) + sum(outcomes.values()), campaign.count)
                        if clock() - flushed_s >= _FLUSH_S or len(rows) >= _FLUSH_ROWS:
                            store.write_part(out, rows, schema)
                            rows, flushed_s = [], clock()
                finally:
                    if rows:
                        store.write_part(out, rows, schema)
        return Summary(campaign.count, len(done), dict(outcomes), cpu_s, clock() - began_s)

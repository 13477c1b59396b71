"""The folder of a campaign's results: ``campaign.json``, which says what they are of, and rows in parts,
``runs/part-000001.parquet``. A part is there whole or not at all; a row is in one part only."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish.errors import CampaignError, ConfigError, MissingFileError
from pilotfish.extras import require
from pilotfish.sweep.campaign import Campaign
from pilotfish.sweep.identity import differences, identity
from pilotfish.sweep.play import Row
from pilotfish.whole_files import write_whole, written_whole

CAMPAIGN, RUNS, LOCK = "campaign.json", "runs", ".lock"


@contextmanager
def opened(out: Path, campaign: Campaign) -> Iterator[None]:
    """Makes the folder, or goes on in it; nobody else writes there meanwhile. ConfigError says what differs if the
    results in it are of another campaign."""
    now = identity(campaign)
    before = read_identity(out) if (out / CAMPAIGN).exists() else None
    if before is None and out.is_dir() and any(out.iterdir()):
        raise ConfigError(f"{out} is not empty, and no folder of a campaign: choose another one")
    if before is not None and before != now:
        told = "\n  ".join(differences(before, now))
        raise ConfigError(
            f"{out} holds results of another campaign; what differs:\n  {told}\n"
            "Choose another folder, or change it back to go on"
        )
    (out / RUNS).mkdir(parents=True, exist_ok=True)
    with (out / LOCK).open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise CampaignError(
                f"{out}: another `pilotfish sweep` writes there; wait for its end, or stop it"
            ) from None
        if before is None:
            write_whole(out / CAMPAIGN, json.dumps(now, indent=1) + "\n")
        yield


def read_identity(out: Path) -> dict[str, Any]:
    """What campaign.json says."""
    file = out / CAMPAIGN
    if not file.is_file():
        raise MissingFileError(
            f"{out} is no folder of a campaign (no {CAMPAIGN}): `pilotfish sweep FILE --out` makes one"
        )
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
    except ValueError as error:
        raise CampaignError(f"{file}: damaged ({error}); choose another folder") from error
    if not isinstance(said, dict) or not {"factors", "metrics", "runs"} <= said.keys():
        raise CampaignError(f"{file}: not written by `pilotfish sweep`; choose another folder")
    return said


def schema_of(campaign: Campaign) -> Any:
    """pyarrow's schema of a row: who it is, the factors' values, seeds, outcome, figures."""
    arrow = require("pyarrow", "sweep")
    columns = [("run", arrow.int64()), ("point", arrow.int64()), ("repetition", arrow.int64())]
    for factor in campaign.factors:
        values = [value for value in getattr(factor, "values", (0.0,)) if value is not None]
        kind = arrow.float64()
        if values and all(isinstance(value, bool) for value in values):
            kind = arrow.bool_()
        elif any(isinstance(value, str) for value in values):
            kind = arrow.string()
        columns.append((factor.name, kind))
    columns += [("world_seed", arrow.int64()), ("noise_seed", arrow.int64())]
    columns += [("outcome", arrow.string()), ("reason", arrow.string())]
    return arrow.schema(columns + [(name, arrow.float64()) for name in campaign.job.metrics])


def parts(out: Path) -> list[Path]:
    """The parts there are, in the order in which they were written."""
    return sorted((out / RUNS).glob("part-*.parquet"))


def write_part(out: Path, rows: Sequence[Row], schema: Any) -> Path:
    """The rows as the next part; on the disk when this returns."""
    arrow, parquet = require("pyarrow", "sweep"), require("pyarrow.parquet", "sweep")
    there = parts(out)
    number = int(there[-1].stem.removeprefix("part-")) + 1 if there else 1
    file = out / RUNS / f"part-{number:06d}.parquet"
    ordered = sorted(rows, key=lambda row: row["run"])
    with written_whole(file) as partial:
        parquet.write_table(arrow.Table.from_pylist(ordered, schema=schema), partial)
        with partial.open("rb") as stream:
            os.fsync(stream.fileno())
    return file


def read_rows(out: Path, columns: Sequence[str] | None = None) -> Any:
    """pyarrow's table of all rows so far, in the order of the runs. CampaignError names a damaged part."""
    arrow, parquet = require("pyarrow", "sweep"), require("pyarrow.parquet", "sweep")
    read_identity(out)
    tables = []
    for part in parts(out):
        try:
            tables.append(parquet.read_table(part, columns=None if columns is None else list(columns)))
        except (arrow.ArrowException, OSError, KeyError) as error:
            raise CampaignError(
                f"{part}: damaged ({str(error).splitlines()[0]}). Delete it and call `pilotfish sweep FILE` again: "
                "its runs are simulated once more"
            ) from error
    if not tables:
        raise MissingFileError(f"{out}: no run is done yet")
    table = arrow.concat_tables(tables)
    return table.sort_by("run") if "run" in table.column_names else table


def done_runs(out: Path) -> np.ndarray:
    """The numbers of the runs that have a row, in order."""
    if not parts(out):
        return np.zeros(0, dtype=np.int64)
    return read_rows(out, ["run"])["run"].to_numpy()

"""The folder of a campaign's results: ``campaign.json``, which says what they are of, and rows in parts (parts.py). A
row is in one part only."""

from __future__ import annotations

import fcntl
import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish.errors import CampaignError, ConfigError, MissingFileError
from pilotfish.extras import require
from pilotfish.sweep.campaign import Campaign
from pilotfish.sweep.identity import differences, identity
from pilotfish.sweep.parts import DamagedPartError, part_name, part_number, read_part
from pilotfish.sweep.play import Row
from pilotfish.whole_files import write_whole, written_whole

CAMPAIGN, RUNS, DAMAGED, LOCK = "campaign.json", "runs", "damaged", ".lock"

Say = Callable[[str], None]


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
        for abandoned in (out / RUNS).glob(".part-*.part"):  # of a process that was killed: nobody else writes here
            abandoned.unlink()
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
    ordered = sorted(rows, key=lambda row: row["run"])
    stream = arrow.BufferOutputStream()
    parquet.write_table(arrow.Table.from_pylist(ordered, schema=schema), stream)
    content = stream.getvalue().to_pybytes()
    number = 1 + max((part_number(part) for part in parts(out)), default=0)
    file = out / RUNS / part_name(number, read_identity(out), content)
    with written_whole(file) as partial, partial.open("wb") as written:
        written.write(content)
        written.flush()
        os.fsync(written.fileno())
    return file


def read_rows(out: Path, say: Say | None = None) -> Any:
    """pyarrow's table of all rows so far, in the order of the runs. CampaignError names a damaged part, or two that say
    different things of a run; ``say`` gets a warning where two say the same."""
    identity = read_identity(out)
    tables = {}
    for part in parts(out):
        try:
            tables[part] = read_part(part, identity)
        except DamagedPartError as error:
            raise CampaignError(
                f"{part}: {error}. Call `pilotfish sweep FILE --out {out}` again: its runs are simulated once more"
            ) from error
    if not tables:
        raise MissingFileError(f"{out}: no run is done yet")
    return _joined(tables, say)


def take_stock(out: Path, count: int, say: Say | None = None) -> np.ndarray:
    """The numbers of the runs that have a row, in order, of ``count`` runs. Only for who has ``opened`` the folder: a
    damaged part is moved to ``damaged``, so that its runs count as not done, and ``say`` is told so."""
    identity = read_identity(out)
    tables = {}
    for part in parts(out):
        try:
            table = read_part(part, identity)
            if max(table["run"].to_pylist(), default=0) >= count:
                raise DamagedPartError(f"damaged (it has runs beyond {count - 1}, the last of the campaign)")
            tables[part] = table
        except DamagedPartError as error:
            kept = out / DAMAGED / part.name
            kept.parent.mkdir(exist_ok=True)
            part.replace(kept)
            if say:
                say(f"{part}: {error}. Its runs count as not done, and are simulated again; it is kept as {kept}")
    return _joined(tables, say)["run"].to_numpy() if tables else np.zeros(0, dtype=np.int64)


def _joined(tables: dict[Path, Any], say: Say | None) -> Any:
    """All rows in the order of the runs, each once. A part that was copied has its runs a second time: the same bits
    are dropped with a warning, others are an error that names both files."""
    arrow = require("pyarrow", "sweep")
    first: dict[int, tuple[Path, int]] = {}  # by run: where it stands
    kept: list[Any] = []
    for part, table in tables.items():
        if kept and not table.schema.equals(kept[0].schema):
            raise CampaignError(f"{part}: its columns are of other kinds than those of {next(iter(tables))}; delete it")
        new, twice = [], []
        for row, run in enumerate(table["run"].to_pylist()):
            (twice if run in first else new).append(row)
            if run in first:
                other, there = first[run]
                if _bits(table, row) != _bits(tables[other], there):
                    raise CampaignError(
                        f"run {run} is in two parts that say different things of it: {other} and {part}. Delete the "
                        "one that does not belong there"
                    )
            else:
                first[run] = (part, row)
        if twice and say:
            others = ", ".join(sorted({str(first[run][0]) for run in table["run"].take(twice).to_pylist()}))
            say(f"{part}: {len(twice)} of its {len(table)} runs are also in {others}, with the same rows: counted once")
        kept.append(table.take(arrow.array(new, arrow.int64())) if twice else table)
    return arrow.concat_tables(kept).sort_by("run")


def _bits(table: Any, row: int) -> list[Any]:
    """A row as values that are equal only if their bits are: NaN is itself, and 0 is not -0."""
    (values,) = table.slice(row, 1).to_pylist()
    return [(name, value.hex() if isinstance(value, float) else value) for name, value in values.items()]

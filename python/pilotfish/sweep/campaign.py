"""A campaign: a scenario, what is varied in it, how often it is run and what is kept. Read from a file and checked."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import yaml

from pilotfish.data import did_you_mean
from pilotfish.errors import ConfigError, PilotfishError
from pilotfish.experiments import experiment_of
from pilotfish.harness.scenario import Scenario
from pilotfish.sweep import design
from pilotfish.sweep.design import METHODS, Sampling
from pilotfish.sweep.documents import Documents, read_documents, yaml_text
from pilotfish.sweep.factors import Distributed, Factor, Levels, Value, read_factor
from pilotfish.sweep.keys import check_key, file_key, resolve_file
from pilotfish.sweep.metrics import METRICS
from pilotfish.sweep.play import Job, RunSpec, check_settings

OBSERVATIONS = ("drawn", "rendered")
SEEDS = ("own", "common")


@dataclass(frozen=True)
class Key:
    """A number at the top of a campaign's file."""

    default: float
    low: float
    high: float
    whole: bool
    text: str


NUMBERS = {
    "duration_s": Key(math.nan, 0.5, 1e5, False, "of each run; default: the scenario's"),
    "runs": Key(1, 1, 100_000, True, "runs of each point, which differ by their noise"),
    "seed": Key(1, 0, 2**31 - 1, True, "of the sampling and of all noise"),
    "collision_distance_m": Key(0.3, 0.0, 20.0, False, "nearer than this is a collision"),
    "lost_after_s": Key(1.0, 0.05, 1e5, False, "a run that ends with so long without measurement has lost its leader"),
}
TEXTS = {
    "scenario": "required: a shipped scenario's name, or a file relative to this one",
    "observations": "drawn (default): measurements are drawn; rendered: pictures are, some 100 times slower",
    "robot": "whose figures are kept; default: the first that follows",
    "seeds": "own (default): every run has noise of its own; common: run k of every point has the same noise, so that "
    "differences between points are not noise",
    "sampling": "method: " + "; ".join(f"{name}: {text}" for name, text in METHODS.items()) + ". points: how many",
    "set": "mapping KEY: VALUE, for all runs",
    "factors": "required: mapping KEY: VALUES, what is varied",
    "metrics": "list of the figures that are kept; default: all",
}


@dataclass(frozen=True)
class Campaign:
    """A campaign whose keys and values have been checked."""

    name: str
    scenario: str
    documents: Documents
    job: Job
    seed: int
    runs: int
    common_seeds: bool
    sampling: Sampling
    fixed: dict[str, Value]
    factors: tuple[Factor, ...]

    @cached_property
    def points(self) -> list[dict[str, Value]]:
        """Each point's values by the factors' names."""
        return design.points(self.factors, self.sampling, self.seed)

    @property
    def distributed(self) -> list[Distributed]:
        """The factors that are sampled."""
        return [factor for factor in self.factors if isinstance(factor, Distributed)]

    @property
    def count(self) -> int:
        """Runs in all."""
        return len(self.points) * self.runs

    def settings(self, point: dict[str, Value]) -> dict[str, Any]:
        """What a point sets, by key; files by the names of their contents."""
        result: dict[str, Any] = dict(self.fixed)
        for factor in self.factors:
            value = point[factor.name]
            result.update(factor.levels[str(value)] if isinstance(factor, Levels) else {factor.key: value})
        return {key: self.job.files.get(value, value) if file_key(key) else value for key, value in result.items()}

    def run(self, index: int) -> RunSpec:
        """Run number ``index``; all runs of a point come one after the other."""
        point = index // self.runs
        return RunSpec(index, point, index % self.runs, self.points[point], self.settings(self.points[point]))


def load_campaign(file: str | Path) -> Campaign:
    """Reads and checks a campaign's file. ConfigError names the key, its value and what is allowed."""
    file = Path(file)
    try:
        said = yaml.safe_load(yaml_text(file))
    except yaml.YAMLError as error:
        raise ConfigError(f"{file}: not YAML: {' '.join(str(error).split())}") from error
    try:
        return _campaign(file, said)
    except ConfigError as error:
        raise ConfigError(f"{file}: {error}") from error


def _campaign(file: Path, said: Any) -> Campaign:
    if not isinstance(said, dict):
        raise ConfigError("not a YAML mapping (key: value); `pilotfish sweep --describe` says what a campaign is")
    known = [*TEXTS, *NUMBERS]
    for key in said:
        if key not in known:
            raise ConfigError(f"there is no key '{key}'{did_you_mean(str(key), known)}; there are: {', '.join(known)}")
    for key in ("scenario", "factors"):
        if key not in said:
            raise ConfigError(f"{key}: is missing ({TEXTS[key]})")
    numbers = {name: _number(name, said.get(name)) for name in NUMBERS}
    scenario_file, scenario = _scenario(said["scenario"], file.parent)
    documents = read_documents(scenario_file)
    rendered = _choice("observations", said.get("observations", "drawn"), OBSERVATIONS) == "rendered"
    common = _choice("seeds", said.get("seeds", "own"), SEEDS) == "common"
    try:
        robot = scenario.robot(said.get("robot")).name
    except ConfigError as error:
        raise ConfigError(f"robot: {error}") from error
    duration_s = scenario.duration_s if math.isnan(numbers["duration_s"]) else numbers["duration_s"]
    factors = tuple(
        _named(f"factors.{name}", lambda name=name, values=values: read_factor(str(name), values))
        for name, values in _mapping("factors", said["factors"]).items()
    )
    if not factors:
        raise ConfigError("factors: nothing is varied: give at least one")
    fixed = dict(_mapping("set", said.get("set") or {}))
    job = Job(
        documents=documents,
        files={},
        robot=robot,
        rendered=rendered,
        duration_s=duration_s,
        metrics=_metrics(said.get("metrics")),
        collision_distance_m=numbers["collision_distance_m"],
        lost_after_s=numbers["lost_after_s"],
        seed=int(numbers["seed"]),
        common_seeds=common,
    )
    campaign = Campaign(
        name=file.stem,
        scenario=str(said["scenario"]),
        documents=documents,
        job=job,
        seed=int(numbers["seed"]),
        runs=int(numbers["runs"]),
        common_seeds=common,
        sampling=_sampling(said.get("sampling")),
        fixed=fixed,
        factors=factors,
    )
    campaign = _with_files(campaign, file.parent)
    _check(campaign)
    return campaign


def _check(campaign: Campaign) -> None:
    """Every key, and every factor's values one by one, as the program's own readers take them."""
    design.check_sampling(campaign.sampling, campaign.distributed)
    _check_unique(campaign)
    names = [factor for factor in campaign.factors if not isinstance(factor, Distributed)]
    total = math.prod(len(factor.values) for factor in names) * campaign.runs
    total *= design.count_samples(campaign.distributed, campaign.sampling)
    if total > design.MAX_RUNS:
        raise ConfigError(f"{total} runs, at most {design.MAX_RUNS} are allowed: fewer values, points or runs")
    for key in campaign.fixed:
        _named(f"set.{key}", lambda key=key: check_key(str(key), campaign.documents, campaign.job.rendered))
    for factor in campaign.factors:
        for key in _keys(factor):
            where = f"factors.{factor.name}"
            _named(where, lambda key=key: check_key(key, campaign.documents, campaign.job.rendered))
    _named("set", lambda: _check_values(campaign, {}))
    for factor in campaign.factors:
        for value in (factor.low, factor.high) if isinstance(factor, Distributed) else factor.values:
            where = f"factors.{factor.name}: {value}"
            _named(where, lambda factor=factor, value=value: _check_values(campaign, {factor.name: value}))


def _check_values(campaign: Campaign, chosen: dict[str, Value]) -> None:
    """One factor's value, with what is set for all runs. What only goes together with another factor's values is
    found when it is run, and is a row of its own there."""
    others = tuple(factor for factor in campaign.factors if factor.name in chosen)
    check_settings(campaign.job, replace(campaign, factors=others).settings(chosen))


def _check_unique(campaign: Campaign) -> None:
    from pilotfish.sweep.play import ROW_COLUMNS

    seen: dict[str, str] = {}
    for factor in campaign.factors:
        if factor.name in (*ROW_COLUMNS, *METRICS):
            raise ConfigError(f"factors.{factor.name}: this is a column of the results; choose another name")
        for key in _keys(factor):
            if key in seen:
                raise ConfigError(f"factors.{factor.name}: {key} is varied by {seen[key]} as well")
        seen.update(dict.fromkeys(_keys(factor), f"factors.{factor.name}"))


def _keys(factor: Factor) -> list[str]:
    if isinstance(factor, Levels):
        return list(dict.fromkeys(str(key) for keys in factor.levels.values() for key in keys))
    return [str(factor.key)]


def _with_files(campaign: Campaign, folder: Path) -> Campaign:
    """The contents of all files that settings name, which go with the campaign."""
    files: dict[str, str] = {}
    said = [(f"set.{key}", key, value) for key, value in campaign.fixed.items()]
    for factor in campaign.factors:
        pairs = [(factor.key, value) for value in getattr(factor, "values", ()) if factor.key]
        if isinstance(factor, Levels):
            pairs = [pair for keys in factor.levels.values() for pair in keys.items()]
        said += [(f"factors.{factor.name}", key, value) for key, value in pairs]
    for where, key, value in said:
        if file_key(str(key)) and value is not None:
            name = _named(where, lambda value=value: campaign.documents.add_file(resolve_file(str(value), folder)))
            files[value] = name
    return replace(campaign, job=replace(campaign.job, files=files))


def _named(where: str, do: Callable[[], Any]) -> Any:
    try:
        return do()
    except PilotfishError as error:
        raise ConfigError(f"{where}: {error}") from error


def _mapping(key: str, said: Any) -> dict[Any, Any]:
    if not isinstance(said, dict):
        raise ConfigError(f"{key}: {said!r} is not a mapping ({TEXTS[key]})")
    return said


def _choice(key: str, said: Any, allowed: tuple[str, ...]) -> str:
    if said not in allowed:
        raise ConfigError(f"{key}: {said!r} is not one of {', '.join(allowed)}{did_you_mean(str(said), allowed)}")
    return str(said)


def _number(name: str, said: Any) -> float:
    key = NUMBERS[name]
    if said is None:
        return key.default
    kind = int if key.whole else int | float
    if isinstance(said, bool) or not isinstance(said, kind) or not key.low <= said <= key.high:
        what = "a whole number" if key.whole else "a number"
        raise ConfigError(f"{name}: {said!r} is not {what} from {key.low:g} to {key.high:.10g} ({key.text})")
    return float(said)


def _scenario(said: Any, folder: Path) -> tuple[Path, Scenario]:
    try:
        own = folder / str(said)
        file = own if own.is_file() else Path(experiment_of(str(said)).scenario().file)
        return file, Scenario.load(file)
    except PilotfishError as error:
        raise ConfigError(f"scenario: {error}") from error


def _metrics(said: Any) -> tuple[str, ...]:
    if said is None:
        return tuple(METRICS)
    if not isinstance(said, list) or not said:
        raise ConfigError(f"metrics: {said!r} is not a list; there are: {', '.join(METRICS)}")
    for name in said:
        if name not in METRICS:
            near = did_you_mean(str(name), METRICS)
            raise ConfigError(f"metrics: there is no '{name}'{near}; there are: {', '.join(METRICS)}")
    return tuple(dict.fromkeys(said))


def _sampling(said: Any) -> Sampling:
    if said is None:
        return Sampling()
    if not isinstance(said, dict):
        raise ConfigError("sampling: {method: ..., points: ...} is wanted")
    for key in said:
        if key not in ("method", "points"):
            raise ConfigError(f"sampling: there is no key '{key}'; there are: method, points")
    method = _choice("sampling.method", said.get("method", Sampling.method), tuple(METHODS))
    points = said.get("points", 0)
    if isinstance(points, bool) or not isinstance(points, int) or not 1 <= points <= 1_000_000:
        raise ConfigError(f"sampling.points: {points!r} is not a whole number from 1 to 1000000")
    return Sampling(method, points)

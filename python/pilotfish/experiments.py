"""The source paper's two experiments, and every other shipped scenario: as data, as a run, as a table."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rich import box
from rich.table import Table

from pilotfish import data
from pilotfish.errors import MissingFileError
from pilotfish.harness.run import OnProgress, Run
from pilotfish.harness.scenario import Scenario
from pilotfish.law_names import law_name
from pilotfish.metrics import Metrics, evaluate
from pilotfish.number_text import millimetres, signed
from pilotfish.recording import Recording

TRANSPORTS = ("lcm", "in-process")


@dataclass(frozen=True)
class Experiment:
    """A scenario to be played, and what the paper says of it if it is one of its own."""

    name: str
    title: str
    figure: str  # of the paper; empty: none
    scenario_file: str  # below data/, or a path of one's own
    initial_distance_m: float | None = None
    distance_setpoint_m: float | None = None
    bearing_setpoint_deg: float | None = None

    @property
    def label(self) -> str:
        """Title, and figure where there is one: "Leader on a line (Fig. 6)"."""
        return f"{self.title} ({self.figure})" if self.figure else self.title

    def scenario(self) -> Scenario:
        """The Scenario, read anew. ValueError names the key at fault."""
        file = Path(self.scenario_file)
        return Scenario.load(file if file.is_absolute() else data.path(self.scenario_file))

    def on_nonideal_robot(self) -> Experiment:
        """The same with a non-ideal robot and camera (data/hardware/nonideal.yaml), whose errors are not in the
        coordinator's configuration."""
        name = f"{self.name}_nonideal"
        if name not in data.scenarios():
            have = [known for known in data.scenarios() if f"{known}_nonideal" in data.scenarios()]
            raise MissingFileError(
                f"there is no {self.name} with a non-ideal robot; there are: {', '.join(have)}. For one of your own: "
                "a copy of the scenario with `hardware: ../hardware/nonideal.yaml` at its robot (see line_nonideal)"
            )
        return replace(self, name=name, title=f"{self.title}, non-ideal robot", scenario_file=f"scenarios/{name}.yaml")


LINE = Experiment("line", "Leader on a line", "Fig. 6", "scenarios/line.yaml", 2.44, 1.10, -10.0)
CIRCLE = Experiment("circle", "Leader on a circle", "Fig. 7", "scenarios/circle.yaml", 1.96, 0.65, 0.0)
EXPERIMENTS = {experiment.name: experiment for experiment in (LINE, CIRCLE)}


def experiment_of(name: str | Path) -> Experiment:
    """The experiment of a shipped scenario's name, or of a scenario file. MissingFileError lists the names."""
    if str(name) in EXPERIMENTS:
        return EXPERIMENTS[str(name)]
    own = Path(name)
    file = own.resolve() if own.is_file() or len(own.parts) > 1 else data.scenario(str(name))
    return Experiment(file.stem, file.stem.replace("_", " ").capitalize(), "", str(file))


@dataclass(frozen=True)
class Result:
    """One experiment, run once."""

    experiment: Experiment
    scenario: Scenario
    profile: str
    run: Run
    recording: Recording
    metrics: Metrics


def run_experiment(
    experiment: Experiment,
    profile: str = "anticipate",
    transport: str = "lcm",
    *,
    tuning: Path | None = None,
    duration_s: float | None = None,
    on_progress: OnProgress | None = None,
) -> Result:
    """Plays it over LCM with the real programs, or in this process (same law, same pictures, no bus). The result is the
    first robot's; run_all_robots() has all of them."""
    return run_all_robots(
        experiment, profile, transport, tuning=tuning, duration_s=duration_s, on_progress=on_progress
    )[0]


def run_all_robots(
    experiment: Experiment,
    profile: str = "anticipate",
    transport: str = "lcm",
    *,
    tuning: Path | None = None,
    duration_s: float | None = None,
    on_progress: OnProgress | None = None,
) -> list[Result]:
    """The same run; a result for each robot that follows, whose titles name the robot if there are several."""
    scenario = experiment.scenario()
    run = _runner(transport)(scenario, profile=profile, tuning=tuning, duration_s=duration_s, on_progress=on_progress)
    results = []
    for robot in scenario.robots:
        recording = run.recordings[robot.name]
        named = experiment
        if len(scenario.robots) > 1:
            name, title = f"{experiment.name}_{robot.name}", f"{experiment.title}, {robot.name}"
            named = replace(experiment, name=name, title=title)
        results.append(Result(named, scenario, profile, run, recording, evaluate(recording)))
    return results


def _runner(transport: str) -> Callable[..., Run]:
    if transport == "lcm":
        from pilotfish.harness.over_lcm import run_over_lcm

        return run_over_lcm
    if transport == "in-process":
        from pilotfish.harness.in_process import run_in_process

        return run_in_process
    raise ValueError(f"transport '{transport}' is not one of {', '.join(TRANSPORTS)}")


NOTE = "e = d_p - d, positive: too close. Steady state, RMS and bearing: over the last quarter of the run."
COLUMNS_IN_80 = 4  # as many runs as a table of 80 characters shows unwrapped


def metrics_tables(results: Sequence[Result], title: str = "Following by sight") -> list[Table]:
    """One table, or one an experiment where a single one would be wider than 80 characters."""
    if len(results) <= COLUMNS_IN_80:
        return [metrics_table(results, title)]
    titles = list(dict.fromkeys(result.experiment.title for result in results))
    grouped = [(title, [result for result in results if result.experiment.title == title]) for title in titles]
    return [metrics_table(own, f"{title}: {name}") for name, own in grouped]


def metrics_table(results: Sequence[Result], title: str = "Following by sight") -> Table:
    """One column a run, one row a figure; pilotfish.metrics defines each. Four columns fit into 80 characters."""
    table = Table(title=title, title_justify="left", caption=NOTE, caption_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("", no_wrap=True)
    heads = [[*where, *law.split()] for *where, law in map(run_names, results)]
    height = max(map(len, heads))
    for head in heads:  # rich aligns heads at the bottom
        table.add_column("\n".join([*head, *[" "] * (height - len(head))]), justify="right")
    for label, texts in metrics_rows(results):
        markup = [f"[red]{text}[/]" if text == NOT_SETTLED else text for text in texts]
        table.add_row(label, *markup)
    return table


def run_names(result: Result) -> list[str]:
    """What tells a run from others in a table: the experiment, the figure it repeats, the law."""
    name, where = result.experiment.name, result.experiment.figure
    for suffix, meaning in (("nonideal", "non-ideal"), (result.recording.meta.robot, result.recording.meta.robot)):
        if name.endswith(f"_{suffix}"):
            name, where = name.removesuffix(f"_{suffix}"), meaning
    return [name, *filter(None, [where]), law_name(result.profile)]


def metrics_rows(results: Sequence[Result]) -> list[tuple[str, list[str]]]:
    """The table as texts: what each row says, and that for every run."""
    return [(label, [text(result) for result in results]) for label, text in _ROWS]


NOT_SETTLED = "never"


def _settling(result: Result) -> str:
    settled_s = result.metrics.settling_time_s
    return NOT_SETTLED if settled_s is None else f"{settled_s:.1f} s"


_ROWS: tuple[tuple[str, Callable[[Result], str]], ...] = (
    ("initial distance", lambda r: f"{r.metrics.initial_distance_m:.2f} m"),
    ("desired distance", lambda r: f"{r.recording.meta.distance_setpoint_m:.2f} m"),
    ("initial distance error", lambda r: millimetres(r.metrics.initial_error_m)),
    ("final distance error", lambda r: millimetres(r.metrics.final_error_m)),
    ("steady-state distance error", lambda r: millimetres(r.metrics.steady_state_error_m)),
    ("RMS distance error", lambda r: millimetres(r.metrics.rms_error_m).lstrip("+")),
    ("settling to ±50 mm", _settling),
    ("overshoot (too close)", lambda r: f"{1000.0 * r.metrics.overshoot_m:.0f} mm"),
    ("mean bearing error", lambda r: f"{signed(r.metrics.mean_bearing_error_deg, 2)}°"),
    ("RMS bearing error", lambda r: f"{r.metrics.rms_bearing_error_deg:.2f}°"),
    ("RMS jerk of the command", lambda r: f"{r.metrics.rms_jerk_mps3:.1f} m/s³"),
    ("frames detected", lambda r: f"{100.0 * r.metrics.frames_detected_ratio:.1f} %"),
)

"""``pilotfish fuzzy prove``: machine-checked facts on a fuzzy file."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from pilotfish.cli.console import console, friendly_errors, share_progress, warn
from pilotfish.cli.options import between
from pilotfish.cli.outputs import output_file
from pilotfish.errors import ConfigError, UsageError
from pilotfish.fuzzy_proof.model import RANGES, Following

if TYPE_CHECKING:
    from pilotfish import fuzzy
    from pilotfish.fuzzy_proof.proof import Proof

NOT_PROVED = 1  # exit code
_MODEL = "The model of following"

_SHIPPED = Following()


def _number(name: str, text: str) -> Any:
    unit = {"mps": "m/s", "mps2": "m/s^2", "m": "m", "s": "s"}[name.rpartition("_")[2]]
    low, high = RANGES[name]
    return typer.Option(
        f"--{name.replace('_', '-')}",
        callback=between(low, high, unit),
        help=f"{text} {low:g} to {high:g} {unit}; else {getattr(_SHIPPED, name):.4g}.",
        rich_help_panel=_MODEL,
        show_default=False,
    )


def prove(
    file: Annotated[
        Path, typer.Argument(exists=True, dir_okay=False, help="Fuzzy sets and rules: our .yaml, or fuzzylite's .fll.")
    ],
    config: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            dir_okay=False,
            help="A coordinator's configuration, for setpoint, scales, limits, delays; options below win.",
        ),
    ] = None,
    counterexample: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False, help="Write a run that breaks the invariant as a scenario, if there is one (.yaml)."
        ),
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option(callback=between(1e-6, 0.1), help="Of the bounds of u and of e, on their universes; 1e-6 to 0.1."),
    ] = 1e-4,
    sign_within: Annotated[
        float,
        typer.Option(
            callback=between(0.0, 1e9),
            help="By this |e|, on its universe, u must have the sign that increases (decreases) the distance.",
        ),
    ] = 0.5,
    as_json: Annotated[bool, typer.Option("--json", help="Print one JSON object instead.")] = False,
    setpoint_m: Annotated[float | None, _number("setpoint_m", "d_p, the distance to keep.")] = None,
    stop_distance_m: Annotated[float | None, _number("stop_distance_m", "Never nearer than this.")] = None,
    error_scale_m: Annotated[float | None, _number("error_scale_m", "Error that is 1 on the universe of e.")] = None,
    error_change_scale_m: Annotated[
        float | None, _number("error_change_scale_m", "Change per period that is 1 on that of ec.")
    ] = None,
    velocity_scale_mps: Annotated[float | None, _number("velocity_scale_mps", "Speed at u = 1.")] = None,
    speed_limit_mps: Annotated[float | None, _number("speed_limit_mps", "Top speed of the follower.")] = None,
    reverse_limit_mps: Annotated[float | None, _number("reverse_limit_mps", "Its top speed backwards.")] = None,
    acceleration_mps2: Annotated[float | None, _number("acceleration_mps2", "Speeding up and braking.")] = None,
    latency_s: Annotated[float | None, _number("latency_s", "From the exposure until its command acts.")] = None,
    lag_s: Annotated[float | None, _number("lag_s", "Time constant of the wheels.")] = None,
    period_s: Annotated[float | None, _number("period_s", "Between two pictures.")] = None,
    noise_m: Annotated[float | None, _number("noise_m", "Greatest error of a measured distance.")] = None,
    leader_speed_mps: Annotated[float | None, _number("leader_speed_mps", "Top speed of the leader.")] = None,
    leader_deceleration_mps2: Annotated[
        float | None, _number("leader_deceleration_mps2", "How hard it can brake; 1000: it stops dead.")
    ] = None,
) -> None:
    """Prove bounds of the law u(e, ec), its steepness and sign, and that following never comes too near.

    What is printed as proved holds for every input, not for samples: interval branch and bound over the exact centroid,
    outward rounded. The invariant is that of a follower on a straight line, profile `paper`, behind a leader that may
    stop dead at any time. Its numbers are the shipped configuration's unless --config or an option says otherwise. The
    model, and what is not proved: docs/proof.md. Exit code 0 if all is proved, 1 if not.

    \b
    Examples
      pilotfish fuzzy prove data/fuzzy/coordination.yaml
      pilotfish fuzzy prove law.yaml --config data/config/line.yaml
      pilotfish fuzzy prove law.yaml --setpoint-m 0.65 --noise-m 0.002
      pilotfish fuzzy prove law.yaml --json | jq .statements
      pilotfish fuzzy prove law.yaml --counterexample out/crash.yaml
      pilotfish experiment out/crash.yaml --profile paper
    """
    given = {name: value for name, value in locals().items() if name in RANGES and value is not None}

    from pilotfish.cli.fuzzy_proof_tables import print_proof
    from pilotfish.fuzzy_proof.proof import prove as prove_all
    from pilotfish.fuzzy_report import load

    with friendly_errors():
        controller = load(file)
        model = _model(config, given)
        if counterexample is not None:
            _check_counterexample(counterexample, file, config)
        with share_progress("the law") as step:
            proof = prove_all(controller, model, tolerance=tolerance, sign_within=sign_within, on_stage=step)
        if not as_json:
            print_proof(proof, controller)
        written = _write(counterexample, controller, proof)
        if as_json:
            report = {"file": str(file), **proof.as_dict(), "written": [str(each) for each in written]}
            typer.echo(json.dumps(report, indent=2))
        else:
            for each in written:
                console.print(f"wrote {each}", soft_wrap=True)
            if written:
                console.print(f"replay it: pilotfish experiment {written[0]} --profile paper", soft_wrap=True)
        if not proof.holds:
            raise typer.Exit(NOT_PROVED)


def _model(config: Path | None, given: dict[str, float]) -> Following:
    read = _from_configuration(config) if config is not None else {}
    try:
        return replace(Following(), **{**read, **given})
    except ConfigError as error:
        if config is None or any(name in str(error) for name in given):  # an option's fault, or also one's
            raise UsageError(str(error)) from error
        raise ConfigError(f"{config}: {error}") from error


def _from_configuration(file: Path) -> dict[str, float]:
    """The model's numbers in a coordinator's configuration.

    The model's ec is a change per picture; the law's one per control period T: ec_law = change x T / (time between
    pictures), so the scale is taken with the inverse of that.
    """
    from pilotfish import coordinator

    try:
        loaded = coordinator.load_coordinator(file)
    except ValueError as error:
        raise ConfigError(str(error) if str(file) in str(error) else f"{file}: {error}") from error
    law = loaded.coordinator.control
    if law.velocity.input_sigmas > 0.0:
        raise ConfigError(
            f"{file}: control.velocity.input_sigmas is {law.velocity.input_sigmas:g}; the proof is of singleton "
            "inputs: set it to 0"
        )
    if law.spacing.headway_s > 0.0:
        raise ConfigError(
            f"{file}: control.spacing.headway_s is {law.spacing.headway_s:g}; the proof is of a setpoint that does not "
            "change: set it to 0"
        )
    if law.profile.name != "paper":
        warn(f"{file} says profile {law.profile.name}; what is proved of following is proved of profile paper")
    period_s = 1.0 / loaded.frame_rate_hz
    return {
        "setpoint_m": loaded.coordinator.setpoint.distance_m,
        "stop_distance_m": loaded.coordinator.safety.stop_distance_m,
        "error_scale_m": law.velocity.error_scale_m,
        "error_change_scale_m": law.velocity.error_change_scale_m * period_s / law.velocity.control_period_s,
        "velocity_scale_mps": law.velocity.velocity_scale_mps,
        "speed_limit_mps": law.limits.max_linear_mps,
        "reverse_limit_mps": law.limits.max_reverse_mps,
        "acceleration_mps2": law.limits.max_linear_acceleration_mps2,
        "latency_s": law.drive.latency_s,
        "lag_s": law.drive.actuator_lag_s,
        "period_s": period_s,
    }


def _check_counterexample(file: Path, law: Path, config: Path | None) -> None:
    """Before the work: a name that a scenario can have, in a place that can be written, and not that of an input."""
    if file.suffix not in (".yaml", ".yml"):
        raise typer.BadParameter(f"'{file.name}' does not end in .yaml", param_hint="--counterexample")
    output_file(file, [law, *([config] if config else [])])


def _write(file: Path | None, controller: fuzzy.Controller, proof: Proof) -> list[Path]:
    from pilotfish.fuzzy_proof.replay_files import replay_files, write_replay

    if file is None:
        return []
    if proof.counterexample is None:
        why = "the invariant is proved" if proof.invariant.holds else "no run was found that breaks it"
        warn(f"{file} is not written: {why}")
        return []
    files = replay_files(file, controller, proof.following, proof.counterexample)
    write_replay(files)
    return list(files)

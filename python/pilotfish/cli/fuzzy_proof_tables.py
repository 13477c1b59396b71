"""What ``pilotfish fuzzy prove`` prints."""

from __future__ import annotations

import math
from dataclasses import fields

from rich.markup import escape
from rich.table import Table

from pilotfish import fuzzy
from pilotfish.cli.console import console
from pilotfish.fuzzy_proof.branch import Optimum
from pilotfish.fuzzy_proof.proof import Proof, highest_tried_m

_UNITS = {"mps": "m/s", "mps2": "m/s²", "m": "m", "s": "s"}


def print_proof(proof: Proof, controller: fuzzy.Controller) -> None:
    """Tables, then one line for each statement."""
    console.print(surface_table(proof, controller))
    console.print(model_table(proof))
    for line in verdicts(proof, controller):
        console.print(line, soft_wrap=True)


def surface_table(proof: Proof, controller: fuzzy.Controller) -> Table:
    """The bounds that hold for every input, and how near to them samples come."""
    e, ec, u = (v.name for v in (controller.error, controller.error_change, controller.output))
    table = Table(title=f"Proved for every input of '{escape(proof.name)}'", title_justify="left")
    table.add_column("statement")
    table.add_column("proved", justify="right")
    table.add_column("reached", justify="right")
    table.add_column(f"at {e}, {ec}", justify="right")

    def row(text: str, optimum: Optimum, form: str = ".5f") -> None:
        bound, reached = (
            format(x, form) if math.isfinite(x) else "everywhere" if x < 0 else "nothing"
            for x in (optimum.bound, optimum.reached)
        )
        table.add_row(text, bound, reached, _place(optimum))

    row(f"{u} is at least", proof.range.low, "+.5f")
    row(f"{u} is at most", proof.range.high, "+.5f")
    away = "" if proof.continuity.proved else ", away from jumps,"
    row(f"|d{u}/d{e}|{away} is at most", proof.steepest_e, ".4g")
    row(f"|d{u}/d{ec}|{away} is at most", proof.steepest_ec, ".4g")
    row(f"d{u}/d{e}{away} is at most", proof.steepest_rise, "+.3g")
    if proof.greatest_rise is not None:
        row(f"{u} rises along {e} by at most", proof.greatest_rise, ".3g")
    row(f"{u} <= 0 from {e} = x on, x =", proof.too_close)
    row(f"{u} >= 0 up to {e} = -x, x =", proof.too_far)
    return table


def _place(optimum: Optimum) -> str:
    return "" if any(math.isnan(x) for x in optimum.at) else "{:.4g}, {:.4g}".format(*optimum.at)


def model_table(proof: Proof) -> Table:
    """The numbers that the invariant is about, by the options that change them."""
    table = Table(title="Following, profile paper, on a straight line", title_justify="left", show_header=False)
    for _ in range(2):
        table.add_column()
        table.add_column(justify="right")
    cells = []
    for each in fields(proof.following):
        unit = _UNITS[each.name.rpartition("_")[2]]
        cells.append((f"--{each.name.replace('_', '-')}", f"{getattr(proof.following, each.name):.4g} {unit}"))
    half = (len(cells) + 1) // 2
    for left, right in zip(cells[:half], [*cells[half:], ("", "")][:half], strict=True):
        table.add_row(*left, *right)
    return table


def verdicts(proof: Proof, controller: fuzzy.Controller) -> list[str]:
    """One line for each statement, and what is known where it is not proved."""
    lines = [*_continuity(proof, controller), *_signs(proof, controller), *_monotony(proof, controller)]
    return [*lines, *_invariant(proof)]


def _verdict(proved: bool, text: str) -> str:
    return f"[bold green]proved[/] {text}" if proved else f"[bold red]not proved[/] {text}"


def _continuity(proof: Proof, controller: fuzzy.Controller) -> list[str]:
    e, ec, u = (v.name for v in (controller.error, controller.error_change, controller.output))
    if proof.continuity.proved:
        constants = f"{proof.steepest_e.bound:.4g} in {e} and {proof.steepest_ec.bound:.4g} in {ec}"
        return [_verdict(True, f"{u} is continuous, with the Lipschitz constants {constants}")]
    lines = [
        _verdict(
            False, f"{u} is continuous: a set of an input has a vertical side, so there may be no Lipschitz constant"
        )
    ]
    for jump in proof.continuity.jumps:
        one, other = ("({!r}, {!r})".format(*point) for point in (jump.one, jump.other))
        lines.append(f"  {u} changes by {jump.change:+.3g} from ({e}, {ec}) = {one} to {other}")
    return lines


def _signs(proof: Proof, controller: fuzzy.Controller) -> list[str]:
    e, ec, u = (v.name for v in (controller.error, controller.error_change, controller.output))
    lines = []
    sides = (
        ("sign_when_too_close", proof.too_close, "never towards a leader", "too close", "<=", ">="),
        ("sign_when_too_far", proof.too_far, "never away from a leader", "too far", ">=", "<="),
    )
    for name, optimum, what, side, sign, order in sides:
        proved = proof.statements[name]
        if not proved:
            at = (
                f"; {u} has the other sign at ({e}, {ec}) = ({_place(optimum)})"
                if math.isfinite(optimum.reached)
                else ""
            )
            limit = f"{'' if side == 'too close' else '-'}{proof.sign_within:g}"
            lines.append(
                _verdict(False, f"{what} that is {side}: {u} {sign} 0 for all {ec} once {e} {order} {limit}{at}")
            )
            continue
        x = max(optimum.bound, 0.0) if math.isfinite(optimum.bound) else 0.0
        metres = x * proof.following.error_scale_m
        lines.append(_verdict(True, f"{what} that is {side} by more than {metres:.4f} m ({x:.5f} of the universe)"))
    return lines


def _monotony(proof: Proof, controller: fuzzy.Controller) -> list[str]:
    e, u = controller.error.name, controller.output.name
    rise = proof.greatest_rise
    if rise is None:
        return []
    if rise.bound <= 1e-6:
        return [f"{u} never rises along {e}"]
    speed_mps = proof.following.velocity_scale_mps
    return [
        f"{u} is not shown to fall all the way along {e}: it rises again by {rise.reached:.3g} to {rise.bound:.3g} "
        f"({1000 * speed_mps * rise.reached:.3g} to {1000 * speed_mps * rise.bound:.3g} mm/s)"
    ]


def _invariant(proof: Proof) -> list[str]:
    model = proof.following
    stops = (
        "may stop dead"
        if model.leader_deceleration_mps2 >= 1000.0
        else f"brakes with at most {model.leader_deceleration_mps2:g} m/s²"
    )
    lines = [
        _verdict(
            proof.invariant.holds,
            f"the distance never falls below {model.stop_distance_m:g} m: from rest at any such distance, behind a "
            f"leader that drives at 0 to {model.leader_speed_mps:g} m/s and {stops} at any time",
        )
    ]
    if proof.invariant.holds:
        if proof.least_setpoint_m is not None:
            lines.append(f"  also for a setpoint of {proof.least_setpoint_m:.3f} m instead of {model.setpoint_m:g} m")
        return lines
    if proof.counterexample is None:
        lines.append("  no run was found that breaks it either: what is open lies between")
    else:
        run = proof.counterexample
        leader = (
            "that stands"
            if run.leader_speed_mps == 0
            else f"that drives at {run.leader_speed_mps:g} m/s for {run.leader_brakes_at_s:g} s"
        )
        bias = f", measuring {1000 * run.bias_m:g} mm too much" if run.bias_m else ""
        lines.append(
            f"  counterexample: from rest at {run.initial_distance_m:.2f} m behind a leader {leader}{bias}: "
            f"{run.least_distance_m:.3f} m after {run.at_s:.1f} s"
        )
    speed = proof.largest_speed_mps
    lines.append(
        f"  proved for a top speed of {speed:.3f} m/s"
        if speed is not None
        else "  nor for any top speed that was tried, down to 0.01 m/s"
    )
    setpoint = proof.least_setpoint_m
    lines.append(
        f"  proved for a setpoint of {setpoint:.3f} m"
        if setpoint is not None
        else f"  nor for any setpoint that was tried, up to {highest_tried_m(model):g} m"
    )
    return lines

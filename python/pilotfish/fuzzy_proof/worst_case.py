"""Runs of the model of following.py in which the distance falls below the stop distance: found by trying, not
proved."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pilotfish import fuzzy
from pilotfish.fuzzy_proof.interval import FloatArray
from pilotfish.fuzzy_proof.model import Following

DURATION_S = 12.0
_SUBSTEP_S = 0.002
CONTACT = 0.6  # of the stop distance: nearer than that a run is over
_CLEAR_M = 1e-3  # so far below the stop distance that the steps of this simulation do not matter
_BRAKES_AT_S = (0.5, 1.0, 2.0, 4.0)


@dataclass(frozen=True)
class Counterexample:
    """A run that begins at rest. The measured distance is the true one plus ``bias_m`` all the time."""

    initial_distance_m: float
    leader_speed_mps: float  # from the start on
    leader_brakes_at_s: float
    bias_m: float
    least_distance_m: float
    at_s: float


def find_counterexample(controller: fuzzy.Controller, model: Following) -> Counterexample | None:
    """Of a few hundred runs one with the least distance, if that is below the stop distance: the one that begins
    nearest to the setpoint, if several come as near."""
    reach_m = max(1.5 * model.setpoint_m, model.stop_distance_m + 0.5)
    starts = np.linspace(model.stop_distance_m + 0.02, reach_m, 24)
    speeds = sorted({0.0, 0.5 * model.leader_speed_mps, model.leader_speed_mps})
    # Before it brakes, a leader has driven: a run that begins behind one that stands needs no time of braking.
    leaders = [(v, t) for v in speeds for t in (_BRAKES_AT_S if v > 0.0 else (0.0,))]
    biases = sorted({0.0, model.noise_m})
    table = np.array([(d, *leader, bias) for bias in biases for leader in leaders for d in starts])
    least, at = least_distances(controller, model, *table.T)
    as_near = least <= least.min() + _CLEAR_M
    best = int(np.argmin(np.where(as_near, np.abs(table[:, 0] - model.setpoint_m), np.inf)))
    if least[best] > model.stop_distance_m - _CLEAR_M:
        return None
    return Counterexample(*(float(x) for x in table[best]), float(least[best]), float(at[best]))


def least_distances(
    controller: fuzzy.Controller,
    model: Following,
    initial_distance_m: FloatArray,
    leader_speed_mps: FloatArray,
    leader_brakes_at_s: FloatArray,
    bias_m: FloatArray,
    duration_s: float = DURATION_S,
) -> tuple[FloatArray, FloatArray]:
    """(least distance, its time) of every run, each (N,); of what is nearer than CONTACT, when it came there. The
    leader's speeding up and braking are the model's deceleration."""
    distance = np.array(initial_distance_m, dtype=float)
    speed, set_value, command = np.zeros_like(distance), np.zeros_like(distance), np.zeros_like(distance)
    leader = np.zeros_like(distance)
    error_before: FloatArray | None = None
    least, least_at = distance.copy(), np.zeros_like(distance)
    contact_m = CONTACT * model.stop_distance_m
    substeps = max(1, math.ceil(model.period_s / _SUBSTEP_S))
    dt = model.period_s / substeps
    delay = round(model.latency_s / dt)
    acting = [command.copy() for _ in range(delay + 1)]  # the command of each substep until it acts
    follows = 1.0 if model.lag_s == 0.0 else -math.expm1(-dt / model.lag_s)
    change = model.acceleration_mps2 * model.period_s
    for tick in range(math.ceil(duration_s / model.period_s)):
        error = model.setpoint_m - distance - bias_m
        error_change = np.zeros_like(error) if error_before is None else error - error_before
        error_before = error
        u = fuzzy.infer_outputs(controller, error / model.error_scale_m, error_change / model.error_change_scale_m)
        command = np.clip(model.velocity_scale_mps * u, command - change, command + change)
        command = np.clip(command, -model.reverse_limit_mps, model.speed_limit_mps)
        for k in range(substeps):
            time_s = (tick * substeps + k) * dt
            acting.append(command)
            target = acting.pop(0)
            ramp = model.acceleration_mps2 * dt
            before = set_value
            set_value = np.clip(target, set_value - ramp, set_value + ramp)
            speed_before = speed
            speed = speed + (0.5 * (before + set_value) - speed) * follows
            leader_before = leader
            wanted = np.where(time_s < leader_brakes_at_s, leader_speed_mps, 0.0)
            leader_ramp = model.leader_deceleration_mps2 * dt
            leader = np.clip(wanted, leader - leader_ramp, leader + leader_ramp)
            distance = distance + 0.5 * dt * (leader + leader_before - speed - speed_before)
            lower = (distance < least) & (least > contact_m)
            least, least_at = np.where(lower, distance, least), np.where(lower, time_s + dt, least_at)
    return least, least_at

"""String stability of the laws: whether a disturbance of the leader's speed grows from robot to robot of a chain.

A chain is string stable at a frequency if |G| = |V_(i+1) / V_i| <= 1, with V_i the phasor of the speed of robot i; then
no chain, however long, amplifies there. For a linear law Bode's integral says what is possible. The gap is the integral
of the difference of the speeds, D = (1 - G) / s V_i, so behind a leader at constant speed it grows by h = -G'(0)
seconds times the speed, and

    int_0^inf ln|G(jw)| / w^2 dw  >=  (pi / 2) G'(0)  =  -(pi / 2) h,

more by pi/2 times the delay of the loop. A law without a steady-state error that keeps a constant distance has h = 0:
what it gains below 1 at high frequencies it pays above 1 at lower ones, whatever its parameters. A time headway h buys
area, and so does a steady-state error that grows with the speed, such as that of the law as published.
(Seiler, Pant, Hedrick, "Disturbance propagation in vehicle strings", 2004; Freudenberg, Looze, 1985.)
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish.deaf_children import deaf_children
from pilotfish.end_with_parent import end_with_parent
from pilotfish.errors import ConfigError, UsageError
from pilotfish.formation.chain import chain_of, drive_chain
from pilotfish.formation.relay import Network
from pilotfish.formation.response import StepResponse, fit_sine, step_response
from pilotfish.harness.run import OnProgress
from pilotfish.held_interrupts import HeldInterrupts
from pilotfish.recording import FloatArray

LAWS = ("paper", "anticipate", "pid", "pbvs")
FREQUENCIES_HZ = (0.02, 0.03, 0.05, 0.07, 0.1, 0.14, 0.2, 0.28, 0.4, 0.56, 0.8, 1.1)
SETTLE_S = 12.0  # of the leader's start and the sine's, and ...
SETTLE_PER_ROBOT_S = 2.5  # ... for each robot behind: the wave's way through the chain
MIN_WINDOW_S = 10.0
MIN_PERIODS = 2
NOISE_SHARE = 0.01  # of the leader's amplitude: what is less is no answer but noise, and has been damped
STABLE_GAIN = 1.01
RISE_MPS2 = 0.1  # with which the leader takes up its mean speed


@dataclass(frozen=True)
class Trial:
    """What the chain is tried with."""

    robots: int = 12  # with the leader
    spacing_m: float = 1.0
    speed_mps: float = 0.2  # mean of the leader's
    amplitude_mps: float = 0.02  # of the sine; the step is twice that, from speed - amplitude to speed + amplitude
    frequencies_hz: tuple[float, ...] = FREQUENCIES_HZ
    seed: int = 1
    coordinator: str | None = None  # path of a configuration; None: the shipped one
    intents: Network | None = None  # over which each robot announces what it is about to drive; None: nothing is said


@dataclass(frozen=True)
class Stability:
    """One law with one headway. F frequencies, R robots with the leader; gains of the speed."""

    law: str
    headway_s: float
    frequencies_hz: FloatArray  # (F,)
    gain: FloatArray  # (F, R - 1): |V_i / V_(i-1)| of the follower i = 1 ... R - 1; nan: lost, or |V_(i-1)| is noise
    from_leader: FloatArray  # (F, R - 1): |V_i / V_0|; nan: lost
    error_gain: FloatArray  # (F, R - 2): |E_(i+1) / E_i| of the spacing error; nan as in gain
    lost: np.ndarray  # (F, R - 1) bool: the robot, or one before it, did not see its leader in 1 % of the pictures
    residual_mps: FloatArray  # (F, R): RMS of the speed beside the sine
    step: StepResponse
    seen_ratio: FloatArray  # (R - 1,): least share of pictures in which the robot saw its leader, of all runs

    @property
    def peak_gain(self) -> float:
        """The greatest gain from one robot to the next, of all frequencies and robots; nan: none is known."""
        return _greatest(self.gain)

    @property
    def peak_at_hz(self) -> float:
        """Where that is; nan: nowhere."""
        known = [_greatest(row) for row in self.gain]
        return next((float(f) for f, g in zip(self.frequencies_hz, known, strict=True) if g == self.peak_gain), np.nan)

    @property
    def peak_from_leader(self) -> FloatArray:
        """(R - 1,): for chains of 2 to R robots the greatest gain from the leader to the last robot."""
        return np.array([_greatest(column) for column in self.from_leader.T])

    @property
    def string_stable(self) -> bool:
        """Whether no robot amplifies by more than 1 % at any of the frequencies."""
        return bool(self.peak_gain <= STABLE_GAIN and not self.lost.any())


def _greatest(values: FloatArray) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else float("nan")


def measure(
    laws: Sequence[str],
    headways_s: Sequence[float] = (0.0,),
    trial: Trial = Trial(),
    *,
    jobs: int | None = None,
    on_progress: OnProgress | None = None,
) -> list[Stability]:
    """Every law with every headway. ``jobs`` processes (None: one a processor; 1: none but this)."""
    check(trial)
    tasks = [(law, h, f) for h in headways_s for law in laws for f in (*trial.frequencies_hz, None)]
    answers = dict(_answers(tasks, trial, jobs, on_progress))
    results = []
    for headway_s in headways_s:
        for law in laws:
            sines = [answers[law, headway_s, frequency] for frequency in trial.frequencies_hz]
            results.append(_gathered(law, headway_s, trial, sines, answers[law, headway_s, None]))
    return results


def check(trial: Trial) -> None:
    """UsageError if the sine asks for more than the robots can do or for a leader that stops."""
    if not 0.0 < trial.amplitude_mps < trial.speed_mps:
        raise UsageError(
            f"amplitude_mps: {trial.amplitude_mps:g} is not allowed: more than 0 and less than the speed "
            f"({trial.speed_mps:g}), so that the leader never stops"
        )
    try:
        chain_of(trial.robots, trial.spacing_m, _content(trial))
    except ConfigError as error:
        if trial.coordinator is not None:  # its limits may be what forbids it
            raise
        raise UsageError(str(error)) from error


def window_s(trial: Trial, frequency_hz: float) -> tuple[float, float]:
    """(from, to) [s] of the samples that are used: whole periods after the transient."""
    settled_s = SETTLE_S + SETTLE_PER_ROBOT_S * (trial.robots - 1)
    periods = max(MIN_PERIODS, int(np.ceil(MIN_WINDOW_S * frequency_hz)))
    return settled_s, settled_s + periods / frequency_hz


def sine_speed_mps(trial: Trial, frequency_hz: float, time_s: float) -> float:
    """The leader's speed: from rest with RISE_MPS2, then the sine, which begins at its mean."""
    start_s = trial.speed_mps / RISE_MPS2
    if time_s < start_s:
        return RISE_MPS2 * time_s
    return trial.speed_mps + trial.amplitude_mps * float(np.sin(2.0 * np.pi * frequency_hz * (time_s - start_s)))


def _content(trial: Trial) -> dict[str, Any]:
    return {"coordinator": str(Path(trial.coordinator).resolve())} if trial.coordinator else {}


def _run(task: tuple[str, float, float | None], trial: Trial) -> Any:
    """One run: at a frequency (SineAnswer) or of the step (StepResponse and what was seen)."""
    law, headway_s, frequency_hz = task
    formation = chain_of(trial.robots, trial.spacing_m, _content(trial))
    how = {"headway_s": headway_s, "seed": trial.seed, "intents": trial.intents}
    if frequency_hz is None:
        return _step(law, formation, trial, how)
    start_s, end_s = window_s(trial, frequency_hz)
    speed = lambda time_s: sine_speed_mps(trial, frequency_hz, time_s)  # noqa: E731
    run = drive_chain(formation, law, speed, end_s, **how)
    late = run.time_s >= start_s - 1e-9
    of_speed = fit_sine(run.time_s[late], run.speed_mps[:, late], frequency_hz)
    of_error = fit_sine(run.time_s[late], run.spacing_error_m[:, late], frequency_hz)
    return np.abs(of_speed.phasor), np.abs(of_error.phasor), of_speed.residual_rms, run.seen_ratio


def _step(law: str, formation, trial: Trial, how: dict[str, Any]) -> tuple[StepResponse, FloatArray]:
    low, high = trial.speed_mps - trial.amplitude_mps, trial.speed_mps + trial.amplitude_mps
    step_at_s = window_s(trial, 1.0)[0]
    speed = lambda time_s: min(RISE_MPS2 * time_s, low) if time_s < step_at_s else high  # noqa: E731
    run = drive_chain(formation, law, speed, 2.0 * step_at_s, **how)
    step = {"step_at_s": step_at_s, "before_mps": low, "after_mps": high}
    return step_response(run.time_s, run.speed_mps, run.spacing_error_m, **step), run.seen_ratio


def _answers(tasks, trial: Trial, jobs: int | None, on_progress: OnProgress | None) -> Iterable[tuple[Any, Any]]:
    count = jobs or len(os.sched_getaffinity(0))
    report = on_progress or (lambda done, total: None)
    report(0, len(tasks))
    if count == 1:
        for done, task in enumerate(tasks, 1):
            yield task, _run(task, trial)
            report(done, len(tasks))
        return
    # The longest first; "spawn", because threads of the parent do not survive a fork.
    ordered = sorted(tasks, key=lambda task: task[2] or 1.0)
    here = {"initializer": end_with_parent, "initargs": (os.getpid(),)}
    with ProcessPoolExecutor(min(count, len(tasks)), mp_context=get_context("spawn"), **here) as pool:  # type: ignore[arg-type]
        try:
            with deaf_children():  # an interrupt that came meanwhile is raised on leaving it
                futures: dict[Future, Any] = {pool.submit(_run, task, trial): task for task in ordered}
            for done, future in enumerate(as_completed(futures), 1):
                yield futures[future], future.result()
                report(done, len(tasks))
        except BaseException:
            with HeldInterrupts():  # else one more leaves workers at work, and the pool waits for them
                workers = list((pool._processes or {}).values())  # pool.terminate_workers() from Python 3.14 on
                pool.shutdown(wait=False, cancel_futures=True)
                for worker in workers:  # what they are in the middle of would take seconds, and nobody wants it
                    worker.terminate()
            raise


def _gathered(law: str, headway_s: float, trial: Trial, sines, stepped) -> Stability:
    speed, error = np.array([sine[0] for sine in sines]), np.array([sine[1] for sine in sines])
    seen = np.array([*(sine[3] for sine in sines), stepped[1]]).min(axis=0)
    lost = np.array([sine[3] for sine in sines]) < 0.99
    lost = np.logical_or.accumulate(lost, axis=1)  # who follows one that is lost says nothing about the law
    unknown = lost | (speed[:, :-1] < NOISE_SHARE * speed[:, :1])
    gain = np.where(unknown, np.nan, speed[:, 1:] / speed[:, :-1])
    return Stability(
        law=law,
        headway_s=headway_s,
        frequencies_hz=np.array(trial.frequencies_hz),
        gain=gain,
        from_leader=np.where(lost, np.nan, speed[:, 1:] / speed[:, :1]),
        error_gain=np.where(unknown[:, 1:], np.nan, error[:, 1:] / error[:, :-1]),
        lost=lost,
        residual_mps=np.array([sine[2] for sine in sines]),
        step=stepped[0],
        seen_ratio=seen,
    )


def to_json(results: Sequence[Stability], trial: Trial) -> dict[str, Any]:
    """Everything as lists and numbers; what is not known is null."""
    return {"trial": asdict(trial), "results": [_plain({**vars(r), **_derived(r)}) for r in results]}


def _derived(result: Stability) -> dict[str, Any]:
    names = ("peak_gain", "peak_at_hz", "peak_from_leader", "string_stable")
    return {name: getattr(result, name) for name in names}


def _plain(value: Any) -> Any:
    if isinstance(value, StepResponse):
        return _plain(vars(value))
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    if isinstance(value, np.ndarray | list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, np.bool_):
        return bool(value)
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return str(value) if isinstance(value, Path) else value

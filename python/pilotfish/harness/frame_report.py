"""What a coordinator says about one frame: a line of ``pilotfish-coordinator --json``, or a StepResult in
this process."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pilotfish.coordinator import StepResult
from pilotfish.errors import HarnessError


@dataclass(frozen=True, eq=False)
class FrameReport:
    """None where nothing was measured in this frame, or the law did not run in it."""

    utime: int  # exposure of the frame [us]
    status: str
    reason: str
    detected: bool
    distance_m: float | None
    bearing_rad: float | None
    heading_rad: float | None
    reprojection_error_px: float | None
    ambiguity_ratio: float | None
    heading_ambiguity: float | None  # probability that the heading is of the wrong one of the two solutions
    found_by: str | None  # track, region, frame: where the tags were found
    tag_ids: tuple[int, ...]
    decision_margins: tuple[float, ...]  # one a tag
    corners_px: NDArray[np.float64]  # (tags, 4, 2)
    linear_mps: float
    angular_radps: float
    error_m: float | None
    error_change_m: float | None
    output: float | None  # u of the fuzzy law, normalised
    feed_forward_weight: float | None  # share of the feed-forward in the command
    leader_radial_mps: float | None  # the leader's own speed along the line of sight, as estimated
    leader_tangential_mps: float | None
    leader_turn_rate_radps: float | None
    ego_motion: str | None  # commanded, odometry
    leader_intent: str | None  # silent, probation, agrees, used, suspended
    latency_s: float | None  # to the command, median over the last frames; None in this process, which has no camera
    latency_from_exposure: bool  # else from the frame's arrival

    @classmethod
    def from_step(cls, result: StepResult) -> FrameReport:
        seen, output = result.observation, result.control
        law, leader = (output.velocity, output.leader) if output else (None, None)
        return cls(
            utime=result.utime,
            status=result.status.name,
            reason=result.reason.text,
            detected=seen is not None,
            distance_m=seen.distance_m if seen else None,
            bearing_rad=seen.bearing_rad if seen else None,
            heading_rad=seen.heading_rad if seen else None,
            reprojection_error_px=seen.reprojection_error_px if seen else None,
            ambiguity_ratio=seen.ambiguity_ratio if seen else None,
            heading_ambiguity=seen.heading_ambiguity if seen else None,
            found_by=seen.found_by.name if seen else None,
            tag_ids=tuple(tag.id for tag in seen.tags) if seen else (),
            decision_margins=tuple(tag.decision_margin for tag in seen.tags) if seen else (),
            corners_px=np.array([tag.corners_px for tag in seen.tags] if seen else []).reshape(-1, 4, 2),
            linear_mps=result.command.linear_mps,
            angular_radps=result.command.angular_radps,
            error_m=law.error_m if law else None,
            error_change_m=law.error_change_m if law else None,
            output=law.inference.output if law else None,
            feed_forward_weight=output.feed_forward_weight if output else None,
            leader_radial_mps=leader.radial_mps if leader else None,
            leader_tangential_mps=leader.tangential_mps if leader else None,
            leader_turn_rate_radps=leader.turn_rate_radps if leader else None,
            ego_motion=output.ego_motion.name if output else None,
            leader_intent=output.leader_intent.name if output else None,
            latency_s=None,
            latency_from_exposure=False,
        )

    @classmethod
    def from_json(cls, line: str) -> FrameReport:
        try:
            said: dict[str, Any] = json.loads(line)
            values = {field.name: said[field.name] for field in fields(cls)}
        except (json.JSONDecodeError, KeyError, TypeError) as error:
            raise HarnessError(f"not a frame report ({error!r}): {line[:200]}") from error
        values["tag_ids"], values["decision_margins"] = (
            tuple(values["tag_ids"]),
            tuple(values["decision_margins"]),
        )
        values["corners_px"] = np.array(values["corners_px"], dtype=float).reshape(-1, 4, 2)
        return cls(**values)


def parse_reports(lines: Iterable[str]) -> list[FrameReport]:
    """Every line that is a JSON object; a last line cut off by a signal is dropped."""
    complete = [line for line in lines if line.startswith("{")]
    if complete and not complete[-1].rstrip().endswith("}"):
        complete.pop()
    return [FrameReport.from_json(line) for line in complete]

"""What every tracker answers to one frame, and how far that is from the truth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Claim:
    """What a tracker reports of the leader, and how exact it says that is."""

    value: np.ndarray  # (3,): distance [m], bearing [rad], heading [rad]
    covariance: np.ndarray  # (3, 3)


@dataclass(frozen=True)
class Answer:
    """Of one tracker to one frame. `cMt` is None if it does not see the leader."""

    elapsed_ns: int
    cMt: np.ndarray | None = None  # (4, 4): the tag in the camera frame
    heading_rad: float | None = None  # of the leader, if the tracker knows better than cMt says
    found_by: str = "frame"
    claim: Claim | None = None


@dataclass(frozen=True)
class Errors:
    """Of one answer, all positive is too large; NaN where the leader was not seen."""

    distance_m: float
    normal_deg: float
    heading_deg: float


UNSEEN = Errors(*[float("nan")] * 3)


def normal_of(cMt: np.ndarray) -> np.ndarray:
    """(3,) unit normal of the tag, on the side the camera sees. Trackers disagree on where the tag's z axis points;
    they cannot disagree on this."""
    normal = cMt[:3, 2]
    return normal if normal @ cMt[:3, 3] < 0 else -normal


def heading_of(cMt: np.ndarray) -> float:
    """The heading [rad] of a leader that wears the tag on its rear, seen by a level camera: 0 if the normal looks
    straight back at it, positive if the leader turns to the left, which swings the normal to the right (camera x)."""
    x, _, z = normal_of(cMt)
    return float(np.arctan2(x, -z))


def errors_of(answer: Answer, truth_cMt: np.ndarray) -> Errors:
    """Distance is from the camera to the tag's centre; the normal's error is the angle between the two normals."""
    if answer.cMt is None:
        return UNSEEN
    distance_m = np.linalg.norm(answer.cMt[:3, 3]) - np.linalg.norm(truth_cMt[:3, 3])
    cosine = np.clip(normal_of(answer.cMt) @ normal_of(truth_cMt), -1.0, 1.0)
    heading_rad = heading_of(answer.cMt) if answer.heading_rad is None else answer.heading_rad
    turned = heading_rad - heading_of(truth_cMt)
    heading_deg = np.degrees(np.arctan2(np.sin(turned), np.cos(turned)))
    return Errors(float(distance_m), float(np.degrees(np.arccos(cosine))), float(heading_deg))

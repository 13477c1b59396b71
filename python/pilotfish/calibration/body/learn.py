"""The way into this module: sightings in, a leader's body out, with how well each tag's place on it is known."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from pilotfish.calibration.body.adjustment import Adjustment, adjust
from pilotfish.calibration.body.base_frame import Base, KnownTag, TurningCentre, base_from_reference
from pilotfish.calibration.body.leader_file import body_tag
from pilotfish.calibration.body.sightings import Sightings
from pilotfish.calibration.body.turning import TurningAxis, turned_rad
from pilotfish.calibration.body.uncertainty import tag_covariances
from pilotfish.core import CameraModel, LeaderBody
from pilotfish.errors import BodyLearningError

FEW_SIGHTINGS = 15  # of a tag that were used
LARGE_RMS_PX = 0.5
SMALL_TURN_RAD = math.radians(120)
LARGE_WANDER_M = 0.01
LARGE_WOBBLE_RAD = math.radians(1.0)
MANY_DROPPED = 0.2


@dataclass(frozen=True)
class LearnedTag:
    """How well one tag of the body is known."""

    id: int
    used: int  # sightings
    dropped: int  # sightings that did not fit
    covariance: np.ndarray  # (6, 6) of (v, w) [m, rad] in the tag's own frame

    @property
    def position_sigma_m(self) -> float:
        """Of the distance from where the body has it: the root of the sum over the three axes."""
        return float(np.sqrt(np.trace(self.covariance[:3, :3])))

    @property
    def rotation_sigma_rad(self) -> float:
        """Of its orientation: the root of the sum over the three axes [rad]."""
        return float(np.sqrt(np.trace(self.covariance[3:, 3:])))


@dataclass(frozen=True)
class LearnedBody:
    """A body as pictures show it, with its uncertainty and warnings."""

    body: LeaderBody
    reference_id: int
    frames_used: int
    rms_px: float  # reprojection error over all corner coordinates used
    tags: tuple[LearnedTag, ...]  # in the body's order
    turning: TurningAxis | None  # None if the reference tag's pose was known
    turned_rad: float | None  # the arc that the frames cover, likewise
    warnings: tuple[str, ...]


def learn_body(
    sightings: Sightings,
    camera: CameraModel,
    *,
    base: Base | None = None,
    reference_id: int | None = None,
    family: str = "tag36h11",
    name: str = "leader",
) -> LearnedBody:
    """The body that explains the sightings.

    ``reference_id``: the tag that the base frame hangs on; by default the KnownTag's, else the smallest id.
    Raises BodyLearningError: the message says what to film or to say instead.
    """
    base = base or TurningCentre()
    ids = sightings.ids.tolist()
    if reference_id is None:
        reference_id = base.tag.id if isinstance(base, KnownTag) else ids[0]
    if reference_id not in ids:
        raise BodyLearningError(f"the reference tag {reference_id} was not seen; seen were {ids}")
    if len(ids) == 1 and isinstance(base, KnownTag):
        raise BodyLearningError(
            f"tag {ids[0]} is the only one and its place is known: there is nothing to learn. Film the robot turning "
            "in place, without the tag's position, to learn where it sits"
        )
    adjustment = adjust(camera, sightings, reference_id)
    estimate, kept = adjustment.estimate, adjustment.sightings
    bMr, axis = base_from_reference(base, estimate.cMr, estimate.rMt, kept.ids)
    bMt = bMr @ estimate.rMt
    covariances = tag_covariances(adjustment, base, bMt)
    used = np.bincount(kept.tag, minlength=len(ids))
    tags = tuple(
        LearnedTag(*row) for row in zip(ids, used.tolist(), adjustment.dropped.tolist(), covariances, strict=True)
    )
    body = LeaderBody(
        [body_tag(i, float(size), pose) for i, size, pose in zip(ids, kept.sizes_m, bMt, strict=True)],
        family=family,
        name=name,
    )
    arc = turned_rad(axis, estimate.cMr) if axis else None
    warnings = (*adjustment.size_warnings, *_warnings(adjustment, tags, axis, arc, base))
    frames = len(estimate.cMr)
    return LearnedBody(body, reference_id, frames, adjustment.rms_px, tags, axis, arc, warnings)


def _warnings(
    adjustment: Adjustment,
    tags: tuple[LearnedTag, ...],
    axis: TurningAxis | None,
    arc_rad: float | None,
    base: Base,
) -> list[str]:
    warnings = [
        f"tag {tag.id} was used in {tag.used} frames only: film it for longer"
        for tag in tags
        if tag.used < FEW_SIGHTINGS
    ]
    warnings += [
        f"{tag.dropped} of {tag.used + tag.dropped} sightings of tag {tag.id} did not fit and were left "
        "out: is it flat, fixed, and not hidden in part?"
        for tag in tags
        if tag.dropped > MANY_DROPPED * (tag.used + tag.dropped)
    ]
    if adjustment.rms_px > LARGE_RMS_PX:
        warnings.append(
            f"the corners are off by {adjustment.rms_px:.2f} px (RMS): is the calibration this camera's, at this focus?"
        )
    if axis is not None and arc_rad is not None:
        if arc_rad < SMALL_TURN_RAD:
            warnings.append(
                f"the frames cover {math.degrees(arc_rad):.0f} degrees of turning: a full turn finds the axis better"
            )
        if axis.wander_m > LARGE_WANDER_M:
            warnings.append(
                f"the turning centre wandered by {axis.wander_m * 1e3:.0f} mm (RMS): turn more slowly, on firm "
                "ground, with the camera still"
            )
        if axis.wobble_rad > LARGE_WOBBLE_RAD:
            warnings.append(
                f"the turning axis wobbled by {math.degrees(axis.wobble_rad):.1f} degrees (RMS): is the ground "
                "flat, the camera still?"
            )
        if isinstance(base, TurningCentre) and base.height_of is None:
            warnings.append(
                f"heights are counted from tag {adjustment.sightings.ids[adjustment.reference]}'s centre: on level "
                "ground distance and bearing do not need them; give one with --height-of ID=METRES"
            )
    return warnings

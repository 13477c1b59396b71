"""Any one tag in a picture, followed: the largest one that is seen becomes the body of a LeaderObserver."""

from __future__ import annotations

import math

import numpy as np

from pilotfish import core, vision
from pilotfish.view.messages import Values

_FORGET_AFTER = 15  # pictures without the tag; then any other may be taken


class OneTag:
    """``look`` finds a tag of tag36h11 and follows it from picture to picture."""

    def __init__(self, tag_size_m: float) -> None:
        self._size_m = tag_size_m
        self._detector = vision.TagDetector("tag36h11")
        self._observer: vision.LeaderObserver | None = None
        self._size: tuple[int, int] | None = None
        self._missed = 0

    def look(self, frame: core.Frame, camera: core.CameraModel) -> Values:
        """What a page shows of this picture, as messages.decode("OBSERVATION", ...) gives it, and range_m, the straight
        line from the camera to the tag's centre. The body's frame has its origin in the tag's centre."""
        if (frame.width, frame.height) != (camera.width, camera.height):
            return _nothing(
                frame,
                "frame_size_not_calibrated",
                f"picture {frame.width} x {frame.height}, calibration {camera.width} x {camera.height}",
            )
        if self._observer is None and (found := self._largest(frame)) is not None:
            body = core.LeaderBody([core.BodyTag(id=found, size_m=self._size_m)])
            self._observer, self._missed = vision.LeaderObserver(camera=camera, body=body), 0
        if self._observer is None:
            return _nothing(frame, "no_tag_found", "no tag of the family tag36h11 in the picture")
        result = self._observer.observe(frame)
        if result.observation is None:
            self._missed += 1
            if self._missed >= _FORGET_AFTER:
                self._observer = None
            return _nothing(frame, result.reason.name, result.reason.text)
        self._missed = 0
        return _something(frame, result.observation)

    def _largest(self, frame: core.Frame) -> int | None:
        tags = self._detector.detect(frame.image).tags
        return max(tags, key=lambda tag: _area(tag.corners_px)).id if tags else None


def _area(corners_px: np.ndarray) -> float:
    """Of a quadrilateral (4, 2), by the shoelace formula."""
    x, y = corners_px[:, 0], corners_px[:, 1]
    return 0.5 * abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def _nothing(frame: core.Frame, reason: str, text: str) -> Values:
    empty = ("distance_m", "bearing_rad", "heading_rad", "reprojection_error_px", "range_m", "camera_from_leader")
    return dict.fromkeys(empty) | {
        "utime_us": frame.utime,
        "detected": False,
        "reason": reason,
        "text": text,
        "tags": [],
        "sigma": None,
    }


def _something(frame: core.Frame, seen: core.Observation) -> Values:
    cMo = np.asarray(seen.cMo)
    return {
        "utime_us": frame.utime,
        "detected": True,
        "reason": "none",
        "text": "",
        "distance_m": seen.distance_m,
        "bearing_rad": seen.bearing_rad,
        "heading_rad": seen.heading_rad,
        "reprojection_error_px": seen.reprojection_error_px,
        "ambiguity_ratio": seen.ambiguity_ratio,
        "min_decision_margin": seen.min_decision_margin,
        "range_m": float(np.linalg.norm(cMo[:3, 3])),
        "sigma": [math.sqrt(max(float(seen.covariance[k][k]), 0.0)) for k in range(3)],
        "camera_from_leader": cMo[:3].tolist(),
        "tags": [{"id": tag.id, "hamming": tag.hamming, "corners_px": tag.corners_px.tolist()} for tag in seen.tags],
    }

"""Baselines from PyPI: the newest AprilTag and OpenCV's ArUco. Runs in a process of its own (baselines.Wheels says
why) and so imports nothing of Pilotfish."""

from __future__ import annotations

import contextlib
import os
import time
from importlib.metadata import PackageNotFoundError, version
from multiprocessing.connection import Connection
from pathlib import Path

import numpy as np


class AprilTagWheel:
    """The newest libapriltag, its own pose (orthogonal iteration), full resolution, one thread."""

    def __init__(self, intrinsics: dict[str, float], distortion: list[float], tag_id: int, size_m: float):
        from apriltag import apriltag

        self._detector = apriltag("tag36h11", threads=1, decimate=1.0)
        self._intrinsics, self._tag_id, self._size_m = intrinsics, tag_id, size_m
        self._distortion = np.array(distortion)

    def track(self, image: np.ndarray) -> np.ndarray | None:
        for found in self._detector.detect(image):
            if found["id"] == self._tag_id:
                if self._distortion.size:
                    found = self._straightened(found)
                camera = [self._intrinsics[key] for key in ("fx", "fy", "cx", "cy")]
                pose = self._detector.estimate_tag_pose(found, self._size_m, *camera)
                return _pose(pose["R"], pose["t"])
        return None

    def _straightened(self, found: dict) -> dict:
        """The library knows no lens: OpenCV takes the distortion out of the corners before the pose is computed."""
        import cv2

        camera = _matrix(self._intrinsics)
        until = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 50, 1e-10)
        seen = found["lb-rb-rt-lt"].reshape(-1, 1, 2)
        straight = cv2.undistortPoints(seen, camera, self._distortion, P=camera, criteria=until).reshape(4, 2)
        tag = np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]], dtype=np.float32)
        homography = cv2.getPerspectiveTransform(tag, straight.astype(np.float32))
        return found | {"lb-rb-rt-lt": straight, "homography": homography}


class ArUco:
    """OpenCV's detector with one of its corner refinements, and the pose that OpenCV recommends for squares."""

    def __init__(
        self, refinement: str, intrinsics: dict[str, float], distortion: list[float], tag_id: int, size_m: float
    ):
        import cv2

        cv2.setNumThreads(1)
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMinAccuracy = 0.01  # the default, 0.1 px, stops early
        parameters.cornerRefinementMaxIterations = 50
        parameters.cornerRefinementMethod = getattr(cv2.aruco, f"CORNER_REFINE_{refinement}")
        dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
        self._detector = cv2.aruco.ArucoDetector(dictionary, parameters)
        self._camera, self._distortion = _matrix(intrinsics), np.array(distortion) if distortion else None
        self._tag_id = tag_id
        # IPPE_SQUARE wants this order. Which corner ArUco calls the first does not matter: the square is symmetric.
        self._square = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) * size_m / 2

    def track(self, image: np.ndarray) -> np.ndarray | None:
        import cv2

        corners, ids, _ = self._detector.detectMarkers(image)
        for found, tag_id in zip(corners, [] if ids is None else ids.ravel(), strict=True):
            if tag_id == self._tag_id:
                method = cv2.SOLVEPNP_IPPE_SQUARE
                good, turn, shift = cv2.solvePnP(self._square, found[0], self._camera, self._distortion, flags=method)
                return _pose(cv2.Rodrigues(turn)[0], shift) if good else None
        return None


TRACKERS = {
    "apriltag": AprilTagWheel,
    "aruco subpix": lambda **parts: ArUco("SUBPIX", **parts),
    "aruco apriltag": lambda **parts: ArUco("APRILTAG", **parts),
}


def _matrix(intrinsics: dict[str, float]) -> np.ndarray:
    fx, fy, cx, cy = (intrinsics[key] for key in ("fx", "fy", "cx", "cy"))
    return np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1]])


def _pose(rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    cMt = np.eye(4)
    cMt[:3, :3], cMt[:3, 3] = rotation, np.ravel(translation)
    return cMt


def serve(pipe: Connection) -> None:
    """Answers until the other end closes: ("make", key, parts) -> None; ("look", key, image) -> (elapsed_ns, cMt)."""
    with Path(os.devnull).open("w") as nowhere:  # libapriltag remarks on ambiguous poses there; errors come by the pipe
        os.dup2(nowhere.fileno(), 2)
    try:
        pipe.send({name: version(name) for name in ("apriltag-python", "opencv-python-headless")})
    except PackageNotFoundError as error:
        pipe.send(error)
        return
    trackers = {}
    with contextlib.suppress(EOFError):
        while True:
            what, key, argument = pipe.recv()
            try:
                if what == "make":
                    trackers[key] = TRACKERS[argument.pop("kind")](**argument)
                    pipe.send(None)
                else:
                    start = time.perf_counter_ns()
                    cMt = trackers[key].track(argument)
                    pipe.send((time.perf_counter_ns() - start, cMt))
            except Exception as error:  # passed to the caller, which decides
                pipe.send(error)

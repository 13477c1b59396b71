"""The baselines behind one face: `name`, and look(image, utime) -> Answer. Each is tuned as its authors would.

Pixels. ViSP's and AprilTag's corners have pixel centres at +0.5, as has OpenCV's own copy of AprilTag's corner
refinement; OpenCV's other refinements have them at whole numbers, as Pilotfish. Each baseline gets the principal point
in ITS convention (measured: the mean offset of its corners from the truth is below 0.05 px then), so no method is
handicapped.

One thread each. Where the library is C++ it is called, and timed, in C++ (baselines.cpp); the wheels are timed around
the call, in a process of their own (wheels.py).
"""

from __future__ import annotations

import multiprocessing
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from bench.vision.answers import Answer
from bench.vision.compiled import BaselinesError
from bench.vision.lens import visp_coefficients
from pilotfish import core


@dataclass(frozen=True)
class Target:
    """The tag that a baseline shall find."""

    tag_id: int
    size_m: float


def distortion_of(camera: core.CameraModel) -> list[float]:
    """OpenCV's five coefficients, or an empty list for a lens without distortion."""
    coefficients = [camera.k1, camera.k2, camera.p1, camera.p2, camera.k3]
    return coefficients if any(coefficients) else []


def intrinsics_of(camera: core.CameraModel, pixel_centre: float) -> dict[str, float]:
    """fx, fy, cx, cy where the first pixel's centre is at (pixel_centre, pixel_centre)."""
    return {"fx": camera.fx, "fy": camera.fy, "cx": camera.cx + pixel_centre, "cy": camera.cy + pixel_centre}


class _Compiled:
    """A baseline of baselines.cpp."""

    def __init__(self, name: str, detector: object, target: Target):
        self.name, self._detector, self._target = name, detector, target

    def track(self, image: np.ndarray, utime: int) -> Answer:
        look = self._detector.track(image, self._target.size_m)
        poses = [cMt for tag_id, cMt in look.tags if tag_id == self._target.tag_id]
        return Answer(look.elapsed_ns, poses[0] if poses else None)


def visp(compiled: ModuleType, camera: core.CameraModel, target: Target, decimation: int) -> _Compiled:
    """vpDetectorAprilTag with HOMOGRAPHY_VIRTUAL_VS. Through a lens that distorts, its pose gets ViSP's own model, one
    coefficient each way, fitted to the true lens over the whole frame."""
    kud, kdu = visp_coefficients(camera) if distortion_of(camera) else (0.0, 0.0)
    intrinsics = intrinsics_of(camera, 0.5)
    detector = compiled.VispDetector(decimation=decimation, kud=kud, kdu=kdu, **intrinsics)
    return _Compiled(f"ViSP, decimate {decimation}", detector, target)


def apriltag(compiled: ModuleType, camera: core.CameraModel, target: Target) -> _Compiled:
    """Debian's libapriltag with its own pose (orthogonal iteration), at full resolution."""
    intrinsics = intrinsics_of(camera, 0.5)
    detector = compiled.AprilTagDetector(decimation=1, distortion=distortion_of(camera), **intrinsics)
    return _Compiled("libapriltag 3.3.0", detector, target)


class Wheels:
    """The baselines from PyPI, in a process of their own: the AprilTag wheel brings a libapriltag.so.3 that the dynamic
    linker would otherwise merge with Debian's, whichever is loaded first, and Pilotfish or the wheel would run on the
    other's code. The process works only while it is asked."""

    def __init__(self) -> None:
        from bench.vision.wheels import serve

        context = multiprocessing.get_context("spawn")
        self._pipe, far_end = context.Pipe()
        self._process = context.Process(target=serve, args=(far_end,), daemon=True)
        self._process.start()
        far_end.close()
        self._made = 0
        versions = self._pipe.recv()
        if isinstance(versions, Exception):
            raise BaselinesError(f"{versions}; scripts/bench vision makes the environment with it")
        self.versions: dict[str, str] = versions

    def __enter__(self) -> Wheels:
        return self

    def __exit__(self, *_: object) -> None:
        self._pipe.close()
        self._process.join(5)

    def tracker(self, kind: str, name: str, camera: core.CameraModel, target: Target) -> _InWheels:
        """`kind`: a key of wheels.TRACKERS."""
        self._made += 1
        key = f"{name} {self._made}"
        centre = 0.0 if kind == "aruco subpix" else 0.5
        parts = {"kind": kind, "intrinsics": intrinsics_of(camera, centre), "distortion": distortion_of(camera)}
        self.ask(("make", key, parts | {"tag_id": target.tag_id, "size_m": target.size_m}))
        return _InWheels(name, self, key)

    def ask(self, question: tuple) -> object:
        self._pipe.send(question)
        answer = self._pipe.recv()
        if isinstance(answer, Exception):
            raise answer
        return answer


class _InWheels:
    def __init__(self, name: str, wheels: Wheels, key: str):
        self.name, self._wheels, self._key = name, wheels, key

    def track(self, image: np.ndarray, utime: int) -> Answer:
        elapsed_ns, cMt = self._wheels.ask(("look", self._key, image))
        return Answer(elapsed_ns, cMt)

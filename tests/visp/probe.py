"""Runs tests/probes/visp_probe.cpp, which renders tags and shows them to TagTracker and to vpDetectorAprilTag."""

from __future__ import annotations

import json
import subprocess

import numpy as np

from build_tree import ROOT, built

RELEASE = ROOT / "build" / "release"
# 640x480, f = 600 px, the optical axis through the middle, no distortion.
CAMERA = [640, 480, 600.0, 319.5, 239.5, 0.0]
SIZE_M = 0.16
# From vpDetectorAprilTag's tag frame (x right, y up, z towards the reader) to ours (x right, y down, z into the paper).
HALF_TURN = np.diag([1.0, -1.0, -1.0, 1.0])


def _run(command: str, request: str = "") -> list[dict]:
    program = built("visp_probe")
    if (RELEASE / "build.ninja").exists() and program.is_relative_to(RELEASE):
        subprocess.run(["cmake", "--build", RELEASE, "--target", "visp_probe"], check=True, stdout=subprocess.DEVNULL)
    done = subprocess.run([program, command], input=request, check=False, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


def conversions() -> dict:
    return _run("conversions")[0]


def refusals() -> dict:
    return _run("refusals")[0]


def show(pictures: list[list[np.ndarray | None]], ids=(0,), camera=CAMERA, noise=0.0, **request) -> list[dict]:
    """Per picture what both said. `pictures`: per picture and tag its pose cMt, (4, 4), or None."""
    listed = [[None if pose is None else np.ravel(pose).tolist() for pose in picture] for picture in pictures]
    request |= {"camera": camera, "ids": list(ids), "size_m": SIZE_M, "noise": noise, "pictures": listed}
    return _run("tags", json.dumps(request))


def pose(x_m=0.0, y_m=0.0, z_m=1.0, *, yaw_deg=0.0, pitch_deg=0.0, roll_deg=0.0) -> np.ndarray:
    """cMt of a tag: R = yaw about y, times pitch about x, times roll about z. Without angles it is seen squarely."""
    matrix = np.eye(4)
    for axis, angle_deg in ((1, yaw_deg), (0, pitch_deg), (2, roll_deg)):
        c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
        turn = np.eye(4)
        a, b = (axis + 1) % 3, (axis + 2) % 3
        turn[a, a], turn[a, b], turn[b, a], turn[b, b] = c, -s, s, c
        matrix = matrix @ turn
    matrix[:3, 3] = x_m, y_m, z_m
    return matrix


def pose_of(tag: dict) -> np.ndarray:
    return np.reshape(tag["pose"], (4, 4))


def angle_deg(a: np.ndarray, b: np.ndarray) -> float:
    """Between two rotations: |R - 1| (Frobenius) is 2 sqrt(2) sin(angle / 2)."""
    return float(np.degrees(2.0 * np.arcsin(min(1.0, np.linalg.norm(a[:3, :3] - b[:3, :3]) / np.sqrt(8.0)))))


def shift_m(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.linalg.norm(a[:3, 3] - b[:3, 3]))


def ids_of(tags: list[dict]) -> list[int]:
    return [tag["id"] for tag in tags]

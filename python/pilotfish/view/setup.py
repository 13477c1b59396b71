"""What the coordinator's configuration says and its messages do not: camera, body, scales and the fuzzy controller."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pilotfish import coordinator, core, data, fuzzy
from pilotfish.errors import ConfigError
from pilotfish.fuzzy_report import load as load_controller

AXIS_M = 0.15
_SURFACE_CELLS = 41


@dataclass(frozen=True)
class Setup:
    """Without a configuration: the shipped controller and the default scales; no camera, no body."""

    controller: fuzzy.Controller
    error_scale_m: float
    error_change_scale_m: float
    velocity_scale_mps: float
    configured: bool = False
    camera: core.CameraModel | None = None
    tag_ids: tuple[int, ...] = ()
    max_reprojection_error_px: float | None = None
    min_decision_margin: float | None = None
    stop_distance_m: float | None = None
    max_age_s: float | None = None

    @property
    def camera_size(self) -> tuple[int, int] | None:
        """Of the calibration [px]."""
        return None if self.camera is None else (self.camera.width, self.camera.height)


def default_setup(fuzzy_file: Path | None = None) -> Setup:
    """For a robot of which only the messages are known."""
    velocity = coordinator.CoordinatorConfig().control.velocity
    controller = load_controller(fuzzy_file or data.path("fuzzy/coordination.yaml"))
    return Setup(controller, velocity.error_scale_m, velocity.error_change_scale_m, velocity.velocity_scale_mps)


def load_setup(config: Path, fuzzy_file: Path | None = None) -> Setup:
    """Of a coordinator's file. Raises ConfigError."""
    try:
        loaded = coordinator.load_coordinator(config).coordinator
        bundle = coordinator.bundle_config(config)
    except ValueError as error:
        raise ConfigError(str(error)) from error
    named = next((Path(file.name) for file in bundle.files if file.role == "fuzzy"), None)
    velocity, vision = loaded.control.velocity, loaded.vision
    return Setup(
        load_controller(fuzzy_file or named or data.path("fuzzy/coordination.yaml")),
        velocity.error_scale_m,
        velocity.error_change_scale_m,
        velocity.velocity_scale_mps,
        configured=True,
        camera=loaded.camera,
        tag_ids=tuple(sorted(tag.id for tag in loaded.leader.tags)),
        max_reprojection_error_px=vision.pose.max_reprojection_error_px,
        min_decision_margin=vision.detector.min_decision_margin,
        stop_distance_m=loaded.safety.stop_distance_m,
        max_age_s=loaded.safety.max_age_s,
    )


def running_setups(url: str, fuzzy_file: Path | None = None) -> dict[str, Setup]:
    """Of the coordinators that run on this computer now, on the bus at ``url``, by the robot's name in small letters.

    Their command lines say where their files are; those that this user cannot read are left out."""
    from pilotfish.doctor.following.setup import running_coordinators, setups_here
    from pilotfish.doctor.host import Host

    found = {}
    for name, running in setups_here(url, running_coordinators(Host())).items():
        try:
            found[name] = load_setup(running.file, fuzzy_file)
        except (ConfigError, OSError):
            continue
    return found


def law_of(setup: Setup) -> dict[str, Any]:
    """Rule table and surface for the page: labels, consequents, and u on a grid over both universes."""
    controller = setup.controller
    e = np.linspace(controller.error.min, controller.error.max, _SURFACE_CELLS)
    ec = np.linspace(controller.error_change.min, controller.error_change.max, _SURFACE_CELLS)
    grid_e, grid_ec = (x.ravel() for x in np.meshgrid(e, ec, indexing="ij"))
    surface = fuzzy.infer_outputs(controller, grid_e, grid_ec).reshape(_SURFACE_CELLS, _SURFACE_CELLS)
    labels = controller.output.labels
    return {
        "name": controller.name,
        "rows": list(controller.error.labels),
        "columns": list(controller.error_change.labels),
        "cells": [[labels[int(k)] for k in row] for row in controller.rules.consequents],
        "output_labels": list(labels),
        "e_range": [controller.error.min, controller.error.max],
        "ec_range": [controller.error_change.min, controller.error_change.max],
        "u_range": [controller.output.min, controller.output.max],
        "surface": np.round(surface, 4).tolist(),
        "error_scale_m": setup.error_scale_m,
        "error_change_scale_m": setup.error_change_scale_m,
        "velocity_scale_mps": setup.velocity_scale_mps,
        "configured": setup.configured,
    }


def axes_px(camera: core.CameraModel, camera_from_leader: Any) -> list[list[float]] | None:
    """Origin and ends of the leader's x, y and z axes [px] through the lens; None if any is not in front of the camera.

    camera_from_leader: (3, 4) cMo, metres.
    """
    cMo = np.asarray(camera_from_leader, dtype=float)
    points_m = np.vstack([np.zeros(3), AXIS_M * np.eye(3)])
    in_camera = points_m @ cMo[:, :3].T + cMo[:, 3]
    if not np.isfinite(in_camera).all() or (in_camera[:, 2] <= 1e-3).any():
        return None
    pixels = np.array([camera.project(point) for point in in_camera])
    if not np.isfinite(pixels).all() or np.abs(pixels).max() > 1e5:
        return None
    return np.round(pixels, 2).tolist()

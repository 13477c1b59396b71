"""A counterexample as a scenario that ``pilotfish experiment`` and ``pilotfish-sim`` play, with all that it needs
beside it."""

from __future__ import annotations

from pathlib import Path

import yaml

from pilotfish import data, fuzzy
from pilotfish.errors import ConfigError
from pilotfish.fuzzy_proof.model import Following
from pilotfish.fuzzy_proof.worst_case import CONTACT, DURATION_S, Counterexample
from pilotfish.whole_files import write_whole

_FOCAL_PX = 600.0  # of the simulated camera
_TAG_CELLS = 10  # of a tag36h11 with its quiet zone; the black square has 8
_MIN_CELL_PX = 1.3
_PICTURE_PX = 480.0


def replay_files(file: Path, controller: fuzzy.Controller, model: Following, run: Counterexample) -> dict[Path, str]:
    """Texts by file name: the scenario, the coordinator's configuration, the leader, the camera, the law.

    The camera and the one tag sit above the turning centres at one height, so that the leader is seen as near as the
    run comes. The guard, which would keep the robot from the leader whatever the law says, is put below that: it is
    the law that is on trial. A measurement that is wrong by a constant is a setpoint that is wrong by as much.
    ConfigError if no tag can be seen both at the beginning and at the end of the run.
    """
    names = {kind: file.with_name(f"{file.stem}_{kind}.yaml") for kind in ("coordinator", "leader", "camera", "law")}
    tag_m = _tag_size(model, run)
    setpoint_m = model.setpoint_m - run.bias_m
    limits = {
        "max_linear_mps": model.speed_limit_mps,
        "max_linear_acceleration_mps2": model.acceleration_mps2,
    }
    leader = {
        "name": "leader",
        "start": {"x_m": 0.0, "y_m": 0.0, "heading_deg": 0.0},
        "trajectory": _trajectory(model, run),
        "body": {"leader": names["leader"].name},
    }
    camera = {"calibration": names["camera"].name, "mounting": {"position_m": [0.0, 0.0, 0.25]}}
    follower = {
        "name": "robot1",
        "follows": "leader",
        "start": {"x_m": -run.initial_distance_m, "y_m": 0.0, "heading_deg": 0.0},
        "drive": {**limits, "actuator_lag_s": model.lag_s},
        "camera": {**camera, "latency_s": model.latency_s},
        "coordinator": names["coordinator"].name,
        "setpoint": {"distance_m": setpoint_m, "bearing_deg": 0.0},
    }
    scenario = {
        "name": _word(file.stem),
        "description": f"counterexample of pilotfish fuzzy prove: {run.least_distance_m:.3f} m after {run.at_s:.1f} s",
        "duration_s": min(DURATION_S, max(1.0, run.at_s + 1.0)),
        "frame_rate_hz": 1.0 / model.period_s,
        "seed": 1,
        "robots": [leader, follower],
    }
    coordinator = {
        "name": "robot1",
        "source": "lcm",
        "frame_rate_hz": 1.0 / model.period_s,
        "profile": "paper",
        "camera": camera,
        "leader": names["leader"].name,
        "fuzzy": names["law"].name,
        "setpoint": {"distance_m": setpoint_m, "bearing_deg": 0.0},
        "vision": {"acquisition_range_m": max(2.0, run.initial_distance_m + 1.0), "min_distance_m": 0.01},
        "control": {
            "velocity": {
                "error_scale_m": model.error_scale_m,
                "error_change_scale_m": model.error_change_scale_m,
                "velocity_scale_mps": model.velocity_scale_mps,
                "control_period_s": model.period_s,
            },
            "limits": {**limits, "max_reverse_mps": model.reverse_limit_mps},
            "guard": {"minimum_distance_m": CONTACT * model.stop_distance_m},
            "drive": {"latency_s": model.latency_s, "actuator_lag_s": model.lag_s},
        },
        "safety": {
            "stop_distance_m": min(model.stop_distance_m, setpoint_m),
            "max_age_s": max(0.1, 1.5 * model.period_s),
        },
    }
    tag = {"id": 0, "size_m": tag_m, "position_m": [0.0, 0.0, 0.25], "facing_deg": 180.0}
    body = {"name": "small_tag", "family": "tag36h11", "tags": [tag]}
    law = names["law"].name
    return {
        file: _commented(f"Where the law of {law} comes nearer than {model.stop_distance_m:g} m.", scenario),
        names["coordinator"]: _commented(
            "The law alone: its guard does not act before the leader is too near.", coordinator
        ),
        names["leader"]: _commented("One small tag, seen from far and near.", body),
        names["camera"]: data.path("calibrations/sim_640x480.yaml").read_text(),
        names["law"]: fuzzy.to_yaml(controller),
    }


def write_replay(files: dict[Path, str]) -> None:
    """Every file whole."""
    for file, text in files.items():
        write_whole(file, text)


def _tag_size(model: Following, run: Counterexample) -> float:
    """Its cells must be seen at the beginning, and all of it at the end."""
    farthest_m = max(run.initial_distance_m, model.setpoint_m) + 0.2
    smallest = _MIN_CELL_PX * (_TAG_CELLS - 2) * farthest_m / _FOCAL_PX
    largest = 0.8 * _PICTURE_PX * CONTACT * model.stop_distance_m / _FOCAL_PX * (_TAG_CELLS - 2) / _TAG_CELLS
    if smallest > largest:
        raise ConfigError(
            f"the counterexample cannot be replayed: no tag can be seen both at {farthest_m:.2g} m and at "
            f"{CONTACT * model.stop_distance_m:.2g} m; a greater --stop-distance-m or a smaller --setpoint-m can"
        )
    return round(0.5 * (smallest + largest), 4)


def _trajectory(model: Following, run: Counterexample) -> dict[str, object]:
    if run.leader_speed_mps == 0.0:
        return {"kind": "still"}
    return {
        "kind": "line",
        "speed_mps": run.leader_speed_mps,
        "acceleration_mps2": model.leader_deceleration_mps2,
        "stop_time_s": run.leader_brakes_at_s,
    }


def _word(stem: str) -> str:
    return "".join(c if c.isalnum() or c == "_" else "_" for c in stem) or "counterexample"


def _commented(comment: str, content: dict[str, object]) -> str:
    return f"# {comment} Written by pilotfish fuzzy prove.\n" + yaml.safe_dump(content, sort_keys=False)

"""What a coordinator says about one frame: a line of ``pilotfish-coordinator --json``, or a StepResult in
this process."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import make_dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pilotfish.coordinator import StepResult, step_values, telemetry_fields
from pilotfish.errors import HarnessError

if TYPE_CHECKING:

    class _Fields:
        """Which attributes there are is known when the modules are loaded."""

        def __init__(self, **values: Any) -> None: ...
        def __getattr__(self, name: str) -> Any: ...

else:
    _Fields = make_dataclass("_Fields", [(field.name, Any) for field in telemetry_fields()], frozen=True, eq=False)


class FrameReport(_Fields):
    """An attribute for each of ``pilotfish.coordinator.telemetry_fields()``: enumerations are their names, lists are
    tuples, ``corners_px`` is an array. None where nothing was measured in this frame, or the law did not run in it, and
    for the latency of a StepResult, which has no camera."""

    @classmethod
    def from_step(cls, result: StepResult) -> FrameReport:
        """Of a frame that was answered in this process."""
        return cls._from_values(step_values(result))

    @classmethod
    def from_json(cls, line: str) -> FrameReport:
        """Of a line of pilotfish-coordinator --json. HarnessError if it is none."""
        try:
            return cls._from_values(json.loads(line))
        except (json.JSONDecodeError, KeyError, TypeError) as error:
            raise HarnessError(f"not a frame report ({error!r}): {line[:200]}") from error

    @classmethod
    def _from_values(cls, said: Mapping[str, Any]) -> FrameReport:
        values = {field.name: said[field.name] for field in telemetry_fields()}
        values["corners_px"] = np.array(values["corners_px"], dtype=float).reshape(-1, 4, 2)
        return cls(**{name: tuple(value) if isinstance(value, list) else value for name, value in values.items()})


def _describe(name: str, unit: str, text: str) -> str:
    return f"``{name}``\n    {text}" + (f" [{unit}]" if unit else "")


FrameReport.__doc__ = f"{FrameReport.__doc__}\n\n" + "\n".join(
    _describe(field.name, field.unit, field.text) for field in telemetry_fields()
)


def parse_reports(lines: Iterable[str]) -> list[FrameReport]:
    """Every line that is a JSON object; a last line cut off by a signal is dropped."""
    complete = [line for line in lines if line.startswith("{")]
    if complete and not complete[-1].rstrip().endswith("}"):
        complete.pop()
    return [FrameReport.from_json(line) for line in complete]

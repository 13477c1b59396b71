"""What a campaign is, as one mapping: by it results are known to be of this campaign and of no other."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from typing import Any

from pilotfish import __version__
from pilotfish.sweep.campaign import Campaign

_SHOWN = 6


def identity(campaign: Campaign) -> dict[str, Any]:
    """As JSON keeps it: everything that a row depends on. Files count by their content."""
    job = asdict(campaign.job)
    documents = job.pop("documents")
    documents["files"] = sorted(documents["files"])  # named by their content
    points = json.dumps(campaign.points, sort_keys=True).encode()
    said = {
        "pilotfish": __version__,
        "scenario": campaign.scenario,
        **job,
        "runs": campaign.runs,
        "sampling": asdict(campaign.sampling),
        "set": campaign.fixed,
        "factors": {factor.name: {"form": type(factor).__name__, **asdict(factor)} for factor in campaign.factors},
        "points": hashlib.sha256(points).hexdigest()[:16],
        "documents": documents,
    }
    return json.loads(json.dumps(said))


def differences(before: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """A line for each key that differs, "key: before -> now"; the first few, and how many more."""
    old, new = dict(_flat(before)), dict(_flat(now))
    keys = [key for key in [*old, *(key for key in new if key not in old)] if old.get(key) != new.get(key)]
    # The digests follow from other differences.
    told = [key for key in keys if key != "points" and not key.startswith("documents.files")] or keys
    lines = [f"{key}: {old.get(key, 'nothing')} -> {new.get(key, 'nothing')}" for key in told[:_SHOWN]]
    return lines + ([f"and {len(told) - _SHOWN} more"] if len(told) > _SHOWN else [])


def _flat(value: Any, path: str = "") -> Iterator[tuple[str, str]]:
    if isinstance(value, Mapping):
        for key, each in value.items():
            yield from _flat(each, f"{path}.{key}" if path else str(key))
    elif isinstance(value, list) and any(isinstance(each, Mapping) for each in value):
        for k, each in enumerate(value):
            yield from _flat(each, f"{path}.{each.get('name', k) if isinstance(each, Mapping) else k}")
    else:
        yield path, json.dumps(value)

"""What the wheels' process is set to, which base_t does not say: from its command line and configuration, if it runs on
this host, or from the configuration beside the coordinator's."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pilotfish.doctor.following.cause import MOVES_MPS, Cause
from pilotfish.doctor.following.evidence import Evidence
from pilotfish.doctor.following.setup import Process, Setup, same_bus
from pilotfish.errors import ConfigError, PilotfishError
from pilotfish.files import read_text

DRY_RUN = "dry_run"
_FEELS_LIMITS = ("swings", "overshoots", "distance_error")  # causes that limits that are too low explain


@dataclass(frozen=True)
class BaseHere:
    """``driver``: what turns the wheels; empty where it is not known, because it does not run here. ``too_low``: its
    limits below the coordinator's, as texts."""

    file: Path
    driver: str = ""
    too_low: tuple[str, ...] = ()
    advice: str = ""


def find_base(robot: str, url: str, processes: list[Process], setup: Setup | None) -> BaseHere | None:
    """Of the running pilotfish-base of that robot on that bus, else of the file beside the coordinator's; None if there
    is neither, or it cannot be read here."""
    from pilotfish import base, coordinator
    from pilotfish.doctor.wheel_limits import base_beside, limits_advice, too_low

    loaded, file, driver = None, None, ""
    for process in processes:
        config = process.option("--config")
        if config is None or not same_bus(process.lcm_url, url):
            continue
        try:
            candidate = base.load_base(str(process.folder / config))
        except (ConfigError, OSError, ValueError):
            continue
        if (process.option("--name") or candidate.name).lower() == robot.lower():
            loaded, file = candidate, process.folder / config
            driver = process.option("--driver") or driver_of(file)
            break
    if loaded is None and setup is not None:
        beside = base_beside(setup.file, setup.name)
        loaded, file = beside.loaded, beside.file
    if loaded is None or file is None:
        return None
    try:
        less = too_low(loaded, coordinator.load_coordinator(str(setup.file))) if setup is not None else []
    except (ConfigError, OSError, ValueError):
        less = []
    advice = limits_advice(less, setup.file.name, file.name) if less and setup is not None else ""
    return BaseHere(file, driver, tuple(less), advice)


def driver_of(file: Path) -> str:
    """``driver`` as the file says it; empty where it does not."""
    import yaml

    try:
        content = yaml.safe_load(read_text(file))
    except (PilotfishError, yaml.YAMLError):
        return ""
    return str(content.get("driver") or "") if isinstance(content, dict) else ""


def what_the_base_is_set_to(
    found: list[Cause], seen: Evidence, base_here: BaseHere | None
) -> tuple[list[Cause], list[Cause]]:
    """Causes, where they explain one that was ``found``, else notes."""
    causes: list[Cause] = []
    notes: list[Cause] = []
    names = {cause.name for cause in found}
    if base_here is None:
        return causes, notes
    if base_here.driver == DRY_RUN and seen.commanded_mps.count and seen.commanded_mps.maximum >= MOVES_MPS:
        (causes if "distance_error" in names else notes).append(
            Cause(
                "dry_run",
                "pilotfish-base runs with driver dry_run: it says that it drives, and turns no wheels",
                f"driver: serial:DEVICE in {base_here.file}, or --driver; nothing to do if another program drives them",
            )
        )
    if base_here.too_low:
        (causes if names & set(_FEELS_LIMITS) else notes).append(
            Cause(
                "base_limits",
                f"the wheels' process allows less than the coordinator counts on: {'; '.join(base_here.too_low)} "
                f"({base_here.file})",
                base_here.advice,
            )
        )
    return causes, notes

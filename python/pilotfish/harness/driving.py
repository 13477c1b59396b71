"""Which law drives the coordinators of a run, and with which parameters."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pilotfish import control, coordinator, data, fuzzy
from pilotfish.errors import ConfigError

PROFILES = ("paper", "anticipate")
BASELINES = tuple(law.name for law in control.built_in_laws())


@dataclass(frozen=True)
class Driving:
    """By name: a profile of the fuzzy law (``paper``, ``anticipate``) or a baseline (``pbvs``, ``pid``)."""

    name: str = "anticipate"
    tuning: Path | None = None  # parameters of the law, as ``pilotfish tune`` writes them; a baseline has shipped ones

    def __post_init__(self) -> None:
        if self.name not in PROFILES + BASELINES:
            raise ConfigError(f"'{self.name}' does not drive; choose {', '.join(PROFILES + BASELINES)}")
        if self.tuning:  # refused here, before anything is started
            law = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
            try:
                self._overrides(control.FollowerConfig(law=law))
            except ValueError as error:
                raise ConfigError(f"tuning: {error}") from error

    @property
    def tuning_file(self) -> Path | None:
        """What is read: the given one, or for a baseline the shipped one."""
        return self.tuning or self._shipped_tuning()

    def _shipped_tuning(self) -> Path | None:
        file = data.path("tuned") / f"{self.name}.yaml"
        return file if file.is_file() else None

    @property
    def law(self) -> str:
        """Name of the law that drives, as in --law."""
        return "fuzzy" if self.name in PROFILES else self.name

    def options(self) -> list[str | Path]:
        """For the command line of pilotfish-coordinator."""
        profile = ["--profile", self.name] if self.name in PROFILES else []
        return ["--law", self.law, *profile, *(["--tuning", self.tuning_file] if self.tuning_file else [])]

    def apply(self, config: coordinator.CoordinatorConfig) -> None:
        """The same for a configuration in this process."""
        config.control = self._overrides(config.control)

    def _overrides(self, config: control.FollowerConfig) -> control.FollowerConfig:
        profile = self.name if self.name in PROFILES else None
        return coordinator.apply_overrides(config, law=self.law, profile=profile, tuning=self.tuning_file)

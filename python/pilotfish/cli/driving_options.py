"""Choices of the commands that simulate: which robot, and by which law it drives."""

from __future__ import annotations

from enum import Enum
from pathlib import Path
from typing import Annotated

import typer

from pilotfish.harness.driving import BASELINES, PROFILES


class Robot(str, Enum):
    """The robot that an experiment is played with."""

    ideal = "ideal"
    nonideal = "nonideal"


class Profile(str, Enum):
    """How the fuzzy law drives."""

    paper = "paper"
    anticipate = "anticipate"


class Profiles(str, Enum):
    """The same, or both in turn."""

    paper = "paper"
    anticipate = "anticipate"
    both = "both"


# Whatever laws there are can be chosen: see include/pilotfish/control/law.hpp.
Law = Enum("Law", {name: name for name in ("fuzzy", *BASELINES)}, type=str)
Tunable = Enum("Tunable", {name: name for name in (*PROFILES, *BASELINES)}, type=str)


RobotOption = Annotated[
    Robot,
    typer.Option(
        help="An ideal robot, or one with slip, lag, camera misalignment and noise (data/hardware/nonideal.yaml), "
        "which are not in the coordinator's configuration."
    ),
]
ProfileOption = Annotated[
    Profile,
    typer.Option(help="The law that drives: as published, or around a feed-forward of the leader's motion."),
]
ProfilesOption = Annotated[
    Profiles,
    typer.Option(
        help="The law that drives: as published, around a feed-forward of the leader's motion, or one by one."
    ),
]
LawOption = Annotated[Law, typer.Option(help="Drive with a baseline instead, tuned as well as the fuzzy law.")]
TuningOption = Annotated[
    Path | None,
    typer.Option(exists=True, dir_okay=False, help="Parameters of the law, as `pilotfish tune` writes them."),
]
InProcessOption = Annotated[
    bool, typer.Option("--in-process", help="Without programs and LCM: the same code, called directly.")
]


def drivers_of(profiles: Profiles, law: Law) -> list[str]:
    """Who drives, one after the other."""
    if law is not Law.fuzzy:
        return [law.value]
    return ["paper", "anticipate"] if profiles is Profiles.both else [profiles.value]

"""Who a robot follows while it has lost its leader, and which robots drop out: the keys ``otherwise`` and ``dropouts``
of a formation file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from pilotfish.formation.keys import Keys
from pilotfish.formation.shapes import Place
from pilotfish.formation.sight import Outlook
from pilotfish.formation.watching import Bounds, Watch, refusal, watch_of

MAX_OTHERS = 7  # coordinator/leader_choice.hpp: kMaxLeaders, less the first
_LEAST_LOST_S, _MOST_S = 0.3, 3600.0  # its alternatives.after_lost_s


@dataclass(frozen=True)
class Otherwise:
    """Whom each robot follows while its leader is lost, in the order of trying; the setpoints keep the robot in its
    place. Times as in a coordinator's ``alternatives``."""

    watches: Mapping[str, tuple[Watch, ...]]  # by robot; those that have nobody else are missing
    after_lost_s: float
    back_after_s: float


@dataclass(frozen=True)
class Dropout:
    """A robot that nobody can see from ``at_s`` until ``until_s``: it was carried away. Its coordinator goes on."""

    robot: str
    at_s: float
    until_s: float


def read_otherwise(
    keys: Keys, places: Mapping[str, Place], leaders: Mapping[str, str], outlook: Outlook, bounds: Bounds
) -> Otherwise:
    """ConfigError names the entry and who cannot be seen, and why."""
    asked = keys.mapping("otherwise", {})
    after_lost_s = keys.number("after_lost_s", 1.0, _LEAST_LOST_S, _MOST_S)
    back_after_s = keys.number("back_after_s", 0.0, 0.0, _MOST_S)
    if 0.0 < back_after_s < after_lost_s:
        allowed = f"allowed: 0 (never), or {after_lost_s:g} (after_lost_s) to {_MOST_S:g}"
        raise keys.error("back_after_s", f"{back_after_s:g} is shorter than after_lost_s; {allowed}")
    watches = {}
    for robot, others in asked.items():
        where = f"otherwise.{robot}"
        if robot not in leaders:
            raise keys.error(where, f"'{robot}' follows nobody; these do: {', '.join(leaders)}")
        if not isinstance(others, list) or not 1 <= len(others) <= MAX_OTHERS:
            raise keys.error(where, f"{others!r} is not a list of 1 to {MAX_OTHERS} robots")
        for k, other in enumerate(others):
            entry = f"{where}[{k}]"
            if not isinstance(other, str) or other not in places:
                raise keys.error(entry, f"'{other}' is no robot here; there are: {', '.join(places)}")
            if other in (robot, leaders[robot]) or others.count(other) > 1:
                raise keys.error(entry, f"'{other}' is {_what(str(other), robot, leaders[robot])}")
            if problem := refusal(outlook, bounds, places, robot, str(other)):
                raise keys.error(entry, problem[1])
        watches[robot] = tuple(watch_of(places, robot, str(other)) for other in others)
    _check_no_circle(keys, leaders, watches)
    return Otherwise(watches, after_lost_s, back_after_s)


def read_dropouts(keys: Keys, robots: Mapping[str, Place], duration_s: float) -> tuple[Dropout, ...]:
    """In the order of the file; one a robot, because a scenario hides a robot once. A dropout that could not be seen in
    the run, because it is over when it begins or begins at the end, is refused."""
    dropouts: list[Dropout] = []
    for entry in keys.mappings("dropouts"):
        robot = entry.text("robot", choices=robots)
        if any(robot == before.robot for before in dropouts):
            raise entry.error("robot", f"'{robot}' drops out twice; allowed: once")
        at_s = entry.number("at_s", None, 0.0, duration_s)
        if at_s >= duration_s:
            raise entry.error("at_s", f"{at_s:g} is the end of the run (duration_s); allowed: 0 to less than that")
        latest_s = duration_s + 1.0
        until_s = entry.number("until_s", latest_s, 0.0, latest_s)
        if until_s <= at_s:
            allowed = f"allowed: more than {at_s:g} to {latest_s:g} (duration_s and 1 s)"
            raise entry.error("until_s", f"{until_s:g} is not after at_s ({at_s:g}); {allowed}")
        entry.finish()
        dropouts.append(Dropout(robot, at_s, until_s))
    return tuple(dropouts)


def _what(other: str, robot: str, leader: str) -> str:
    if other == robot:
        return "the robot itself"
    return "its leader already" if other == leader else "there twice"


def _check_no_circle(keys: Keys, leaders: Mapping[str, str], watches: Mapping[str, tuple[Watch, ...]]) -> None:
    """Two robots that follow each other, directly or by others, would lead nowhere, whoever is lost."""
    for robot, others in watches.items():
        for k, watch in enumerate(others):
            if robot in _followed_from(watch.leader, leaders, watches):
                problem = f"'{watch.leader}' may follow {robot}, directly or by others: nobody would lead"
                raise keys.error(f"otherwise.{robot}[{k}]", problem)


def _followed_from(robot: str, leaders: Mapping[str, str], watches: Mapping[str, tuple[Watch, ...]]) -> set[str]:
    """Everybody whom the robot may follow, and so on."""
    found: set[str] = set()
    ahead = [robot]
    while ahead:
        each = ahead.pop()
        nexts = [watch.leader for watch in watches.get(each, ())] + ([leaders[each]] if each in leaders else [])
        ahead += [name for name in nexts if name not in found]
        found |= set(nexts)
    return found

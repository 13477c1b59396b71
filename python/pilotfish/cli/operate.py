"""``pilotfish stop | resume | go | setpoint | key``: an operator's requests to a robot."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import friendly_errors, tell, warn
from pilotfish.errors import ConfigError

if TYPE_CHECKING:
    from pilotfish.bus import StatusReport
    from pilotfish.operating import Operator

RobotArgument = Annotated[str, typer.Argument(help="The robot's name on the bus, e.g. robot1.")]
UrlOption = Annotated[str, typer.Option("--lcm-url", help="LCM bus. Default: $LCM_DEFAULT_URL, else this host alone.")]
KeyOption = Annotated[
    Path | None,
    typer.Option("--key", exists=True, dir_okay=False, help="The coordinator's key_file, if it has one."),
]
StopKeyOption = Annotated[
    Path | None, typer.Option("--key", help="Accepted as by the other commands; a stop does not need it.")
]
WithinOption = Annotated[float, typer.Option("--within-s", min=0.1, max=3600.0, help="How long to try.")]


def stop(
    robot: RobotArgument, lcm_url: UrlOption = "", key: StopKeyOption = None, within_s: WithinOption = 3.0
) -> None:
    """Stop a robot: it stands still until it is resumed. Works without a key, always.

    Sends at once, several times, until the robot's status confirms the stop; ends with 69 if no
    coordinator answers (the stops have been sent nevertheless).

    \b
    Example
      pilotfish stop robot1
    """
    with friendly_errors():
        try:
            operator = _operator(robot, lcm_url, key)
        except (ConfigError, OSError) as error:
            if key is None:
                raise
            warn(f"{error}. Stopping without it: a stop needs no key")
            operator = _operator(robot, lcm_url, None)
        _say(operator, operator.stop(within_s))


def resume(robot: RobotArgument, lcm_url: UrlOption = "", key: KeyOption = None, within_s: WithinOption = 3.0) -> None:
    """End a stop: the robot drives again, and keeps its previous setpoint.

    \b
    Example
      pilotfish resume robot1 --key robot1.key
    """
    with friendly_errors():
        operator = _operator(robot, lcm_url, key)
        _say(operator, operator.resume(within_s))


def go(robot: RobotArgument, lcm_url: UrlOption = "", key: KeyOption = None, within_s: WithinOption = 3.0) -> None:
    """Let a robot drive: the same as resume, under the name that people look for.

    A robot of `pilotfish init` stands still until then.

    \b
    Example
      pilotfish go robot1
    """
    resume(robot, lcm_url, key, within_s)


def setpoint(
    robot: RobotArgument,
    distance_m: Annotated[
        float | None, typer.Option("--distance-m", help="d_p: distance to keep to the leader. Default: as it is.")
    ] = None,
    bearing_deg: Annotated[
        float | None,
        typer.Option(
            "--bearing-deg", help="theta_pd: where to keep the leader, positive: to the left. Default: as it is."
        ),
    ] = None,
    lcm_url: UrlOption = "",
    key: KeyOption = None,
    within_s: WithinOption = 3.0,
) -> None:
    """Set the setpoint of a robot. One that has been stopped stays stopped.

    \b
    Example
      pilotfish setpoint robot1 --distance-m 1.1 --bearing-deg -10
    """
    with friendly_errors():
        if distance_m is None and bearing_deg is None:
            raise typer.BadParameter("nothing to change: say --distance-m, --bearing-deg or both")
        _check_distance(distance_m)
        _check_bearing(bearing_deg)
        operator = _operator(robot, lcm_url, key)
        bearing_rad = None if bearing_deg is None else math.radians(bearing_deg)
        _say(operator, operator.set_setpoint(distance_m=distance_m, bearing_rad=bearing_rad, within_s=within_s))


key_app = typer.Typer(no_args_is_help=True, help="Keys that commands and setpoints are authenticated with.")


@key_app.command("new")
def key_new(
    file: Annotated[Path, typer.Argument(dir_okay=False, help="Where to write it; must not be there yet.")],
) -> None:
    """Make a key: 64 hex digits at random, in a file that only its owner may read.

    Copy it to every computer that may send (coordinator, wheels, operators), and name it in key_file or --key.

    \b
    Example
      pilotfish key new robot1.key
    """
    from pilotfish.operating import new_key

    with friendly_errors():
        new_key(file)
        tell(f"wrote {file}")


def _check_distance(distance_m: float | None) -> None:
    """By the bounds that every coordinator has; its own stop distance it knows alone."""
    from pilotfish.core import Setpoint
    from pilotfish.errors import ConfigError

    try:
        if distance_m is not None:
            Setpoint(distance_m=distance_m)
    except ConfigError as error:
        raise typer.BadParameter(f"--distance-m: {str(error).partition(': ')[2]}") from None


def _check_bearing(bearing_deg: float | None) -> None:
    """In the unit in which it was written; the wire and its refusals are in radians."""
    from pilotfish.core import MAX_BEARING_RAD

    most = math.degrees(MAX_BEARING_RAD)
    if bearing_deg is not None and not -most <= bearing_deg <= most:
        raise typer.BadParameter(f"--bearing-deg: {bearing_deg:g} is outside [{-most:g}, {most:g}]")


def _operator(robot: str, lcm_url: str, key: Path | None) -> Operator:
    from pilotfish.bus import channel
    from pilotfish.operating import Operator

    try:
        channel(robot, "STATUS")
    except ConfigError as error:  # the command line's, not a file's
        raise typer.BadParameter(f"ROBOT: {error}") from None
    return Operator(robot, lcm_url=lcm_url, key_file=key)


def _say(operator: Operator, status: StatusReport) -> None:
    from pilotfish.operating import describe

    text = f"{operator.robot}: {describe(status)} (after {operator.sent} messages)"
    tell(text)

"""``pilotfish view``: a robot, or a camera, in a browser."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import friendly_errors, tell, warn
from pilotfish.cli.options import between

if TYPE_CHECKING:
    from pilotfish.view.hub import Hub
    from pilotfish.view.setup import Setup

DEFAULT_PORT = 8090


def view(
    robot: Annotated[
        str, typer.Argument(help="The robot's name on the bus, e.g. robot1. Default: all that are heard of.")
    ] = "",
    lcm_url: Annotated[
        str, typer.Option("--lcm-url", help="LCM bus. Default: $LCM_DEFAULT_URL, else this host alone.")
    ] = "",
    config: Annotated[
        Path | None,
        typer.Option(
            "--config",
            exists=True,
            dir_okay=False,
            help="The coordinator's configuration: its calibration draws the axes, its limits and ids are named. "
            "Default: that of the coordinator if it runs on this computer already.",
        ),
    ] = None,
    fuzzy: Annotated[
        Path | None,
        typer.Option(
            "--fuzzy",
            exists=True,
            dir_okay=False,
            help="Fuzzy controller. Default: the configuration's, else as shipped.",
        ),
    ] = None,
    key: Annotated[
        Path | None,
        typer.Option(
            "--key", exists=True, dir_okay=False, help="The coordinator's key_file, for resume and setpoints."
        ),
    ] = None,
    camera: Annotated[
        str | None,
        typer.Option(
            "--camera",
            help="Without a coordinator: a camera's number, images:DIR or video:FILE; any one tag.",
        ),
    ] = None,
    tag_size: Annotated[
        float | None,
        typer.Option(
            "--tag-size",
            callback=between(0.005, 5.0, "m"),
            help="Side of the tag's black square in metres, with --camera.",
        ),
    ] = None,
    camera_file: Annotated[
        Path | None,
        typer.Option(
            "--camera-file", exists=True, dir_okay=False, help="The camera's calibration (OpenCV YAML, ViSP XML)."
        ),
    ] = None,
    fov_deg: Annotated[
        float | None,
        typer.Option(
            "--fov-deg",
            callback=between(10.0, 150.0, "degrees"),
            help="Field of view to assume without one, left to right. Default: 60.",
        ),
    ] = None,
    size: Annotated[
        str, typer.Option("--size", metavar="WxH", help="Picture size to ask of a camera; a calibration's goes first.")
    ] = "640x480",
    host: Annotated[
        str,
        typer.Option("--host", help="Address to listen on. Any but this computer's own needs the printed token."),
    ] = "127.0.0.1",
    port: Annotated[
        int, typer.Option("--port", min=0, max=65535, help="TCP port; 0: any that is free.")
    ] = DEFAULT_PORT,
) -> None:
    """Watch and stop a robot in a browser: picture, tags, errors, commands, rules, timings, counters.

    The page has a STOP button (also the space bar or Escape), resume and setpoint; each is sent until the robot
    confirms it. It listens on this computer alone unless --host says otherwise, and works without internet. While no
    page is open, nothing is decoded.

    \b
    Examples
      pilotfish view                                whatever robot is on the bus
      pilotfish view robot1 --config data/config/line.yaml
      pilotfish view robot1 --host 0.0.0.0 --key robot1.key    from a phone
      pilotfish view --camera 0 --tag-size 0.16     one printed tag, uncalibrated
      pilotfish view --camera 0 --tag-size 0.16 --camera-file camera.yaml
    """
    with friendly_errors():
        _check_combination(robot, lcm_url, config, key, camera, tag_size, camera_file, fov_deg)
        from pilotfish.extras import require

        for module in ("starlette", "uvicorn", "websockets"):
            require(module, "view")
        from pilotfish.view import access, running
        from pilotfish.view.server import make_app

        with contextlib.closing(running.open_socket(host, port)) as listening:
            hub, setup, commander = (
                _camera_hub(camera, tag_size, camera_file, fov_deg, size)
                if camera is not None and tag_size is not None
                else _bus_hub(robot, lcm_url, config, fuzzy, key)
            )
            names = access.own_names(host)
            rules = access.Access(access.new_token(), not access.is_loopback(host), names)
            app = make_app(hub, rules, setup, commander)
            running.serve(app, listening, lambda: _say_where(host, listening.getsockname()[1], rules))


def _check_combination(
    robot: str,
    lcm_url: str,
    config: Path | None,
    key: Path | None,
    camera: str | None,
    tag_size: float | None,
    camera_file: Path | None,
    fov_deg: float | None,
) -> None:
    if camera is None:
        for given, name in ((tag_size, "--tag-size"), (camera_file, "--camera-file"), (fov_deg, "--fov-deg")):
            if given is not None:
                raise typer.BadParameter(f"{name} is of a camera: say --camera, too")
        return
    if robot or lcm_url or config or key:
        raise typer.BadParameter("--camera watches a camera alone: without a robot, --lcm-url, --config and --key")
    if tag_size is None:
        raise typer.BadParameter("--camera needs --tag-size: the side of the tag's black square in metres, e.g. 0.16")
    if camera_file is not None and fov_deg is not None:
        raise typer.BadParameter("--fov-deg is for a camera without calibration: say it or --camera-file")


def _bus_hub(
    robot: str, lcm_url: str, config: Path | None, fuzzy: Path | None, key: Path | None
) -> tuple[Hub, Setup, object]:
    from pilotfish.bus import channel, load_key
    from pilotfish.errors import ConfigError
    from pilotfish.view.commands import Commander
    from pilotfish.view.hub import BusHub
    from pilotfish.view.listener import resolve_url
    from pilotfish.view.setup import default_setup, load_setup, running_setups

    setup = default_setup(fuzzy) if config is None else load_setup(config, fuzzy)
    if key is not None:
        try:
            load_key(str(key))  # now, not when somebody presses a button
        except ValueError as error:
            raise ConfigError(str(error)) from error
    if robot:
        try:
            channel(robot, "STATUS")
        except ConfigError as error:
            raise typer.BadParameter(str(error)) from None
    url = resolve_url(lcm_url)
    setups = {} if config is not None else running_setups(url, fuzzy)
    # The page has one law: the named robot's, or that of the only one there is.
    law = setups.get(robot.lower()) if robot else next(iter(setups.values())) if len(setups) == 1 else None
    return BusHub(url, robot, setup, setups), law or setup, Commander(url, key)


def _camera_hub(
    camera: str, tag_size: float, camera_file: Path | None, fov_deg: float | None, size: str
) -> tuple[Hub, Setup, None]:
    from pilotfish.errors import PilotfishError
    from pilotfish.view.camera_feed import CameraFeed, open_source
    from pilotfish.view.camera_hub import CameraHub
    from pilotfish.view.setup import default_setup

    try:
        source = open_source(camera, camera_file=camera_file, fov_deg=fov_deg, size=size)
    except PilotfishError:
        raise
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error
    return CameraHub(CameraFeed(source, tag_size)), default_setup(), None


def _say_where(host: str, port: int, rules: object) -> None:
    from pilotfish.view.access import Access
    from pilotfish.view.addresses import reachable_addresses

    assert isinstance(rules, Access)
    if rules.open_to_others:
        for address in reachable_addresses(host):
            _print(f"http://{address}:{port}/?token={rules.token}")
        warn("whoever has this address may drive the robot; it is not encrypted: use it in a network that you trust")
    else:
        name = f"[{host}]" if ":" in host else host
        _print(f"http://{name}:{port}/")
    _print("Ctrl-C ends it")


def _print(line: str) -> None:
    tell(line)

"""``pilotfish calibrate mounting``: where the camera sits on its robot, from a turn and a straight drive."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from pilotfish.cli.console import console, friendly_errors, progress, working
from pilotfish.cli.learn_body import of_tag, tag_sizes
from pilotfish.cli.options import CalibrationOption, TagSizesOption, between, check_family
from pilotfish.cli.outputs import output_file
from pilotfish.cli.truth_report import OFF_TRUTH, TruthOfMounting, print_differences
from pilotfish.whole_files import write_whole

if TYPE_CHECKING:
    from pilotfish.calibration.body import Sightings, TagSizes
    from pilotfish.calibration.mounting import Phases
    from pilotfish.calibration.mounting.recordings import Film
    from pilotfish.core import CameraModel, Frame


def mounting(
    source: Annotated[
        str,
        typer.Argument(
            help="camera:N for a camera that runs, a folder of pictures, a video, an LCM log, or the folder of a black "
            "box."
        ),
    ],
    camera: CalibrationOption,
    tag_size: TagSizesOption,
    straight: Annotated[
        Path | None,
        typer.Option(
            exists=True, help="The straight drive, if it is a film of its own; SOURCE is the turn alone then."
        ),
    ] = None,
    turn_only: Annotated[
        bool, typer.Option("--turn-only", help="SOURCE is a turn without a drive: pan cannot be seen, see --pan-deg.")
    ] = False,
    backwards: Annotated[bool, typer.Option("--backwards", help="The straight drive was driven backwards.")] = False,
    height_m: Annotated[
        float | None,
        typer.Option(callback=between(-5.0, 5.0, "m"), help="The camera's optical centre above the ground, measured."),
    ] = None,
    height_of: Annotated[
        str | None,
        typer.Option(help="Or: a tag and the height of its centre; a tag on the floor: 5=0.", metavar="ID=METRES"),
    ] = None,
    pan_deg: Annotated[
        float | None,
        typer.Option(callback=between(-180.0, 180.0, "degrees"), help="Without a drive: the pan, measured."),
    ] = None,
    robot: Annotated[
        str, typer.Option(help="Of a log: whose pictures and odometry (NAME_IMAGE, NAME_POSE).")
    ] = "robot1",
    family: Annotated[str, typer.Option(help="Of the tags.")] = "tag36h11",
    every: Annotated[int, typer.Option(min=1, help="Look at every N-th picture only.", metavar="N")] = 1,
    rate_hz: Annotated[
        float, typer.Option(callback=between(1.0, 1000.0, "Hz"), help="Of camera:N: pictures per second.")
    ] = 30.0,
    ignore: Annotated[
        list[int] | None, typer.Option("--ignore", help="An id that does not stand still. Can be repeated.")
    ] = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", dir_okay=False, help="File for the lines; they are printed anyway.")
    ] = None,
    truth: TruthOfMounting = None,
) -> None:
    """Find where the camera sits on its robot: the lines `camera: mounting:` of its configuration.

    \b
    What to do
      Fix one or more tags upright, 1 to 2 m before the robot, on level ground;
      turn a single one by some 25 degrees out of the frontal view, which
      determines its pose better. Let the robot turn on the spot, slowly, until
      the tag has passed from one side of the picture to the other (10 seconds).
      Then let it face the tag and drive straight towards it for half a metre or
      more, slowly. Record both, in this order, in one film or log, or in two
      films (--straight). Calibrate the camera first.

    \b
    With camera:N
      The screen says what to do and where the tags are; Enter begins and ends the
      turn and the drive. The robot is driven by you: push it, or use its remote
      control. Ctrl-C gives up.

    \b
    What comes out
      Forward and left place from the turning centre, tilt and roll from the
      turning axis, pan from the straight drive, each with one standard
      deviation. The height cannot be seen in such motions: measure it
      (--height-m), or the height of a tag's centre (--height-of; a tag that
      lies on the floor has 0). On level ground distance and bearing do not
      depend on it.

    \b
    With a log
      NAME_POSE (odometry), else NAME_COMMAND, tells the turn from the drive;
      odometry's own errors of scale are reported.

    \b
    Examples
      pilotfish calibrate mounting camera:0 \\
          --camera camera.yaml --tag-size 0.16 --height-m 0.31
      pilotfish calibrate mounting turn.mp4 --straight drive.mp4 \\
          --camera camera.yaml --tag-size 0.16 --height-m 0.31
      pilotfish calibrate mounting run.lcmlog --camera camera.yaml \\
          --tag-size 0.16 --height-of 0=0.32 --out mounting.yaml

    \b
    Rehearsed without a robot
      pilotfish render mounting --out run.lcmlog
      pilotfish calibrate mounting run.lcmlog --camera run_camera.yaml \\
          --tag-size 0.16 --height-m 0.25 --truth run_truth.yaml
    """
    from pilotfish.calibration.live_camera import camera_number
    from pilotfish.calibration.mounting import HeightKnown, calibrate_mounting
    from pilotfish.calibration.mounting.recordings import ODOMETRY, open_film
    from pilotfish.calibration.mounting.yaml_lines import mounting_lines
    from pilotfish.calibration.rehearsal import mounting_differences, read_true_mounting
    from pilotfish.cli.mounting_report import print_mounting_report
    from pilotfish.coordinator import load_calibration
    from pilotfish.errors import BodyLearningError, CalibrationError, ConfigError, PilotfishError

    sizes = tag_sizes(tag_size)
    if height_m is not None and height_of is not None:
        raise typer.BadParameter("--height-m and --height-of exclude each other")
    if straight is not None and turn_only:
        raise typer.BadParameter("--straight and --turn-only exclude each other")
    if pan_deg is not None and not turn_only:
        raise typer.BadParameter("--pan-deg is for --turn-only: else the drive shows the pan")
    number = camera_number(source)
    if number is not None and straight is not None:
        raise typer.BadParameter("--straight is a film; with camera:N the drive follows the turn in the same run")
    height = HeightKnown(height_m, of_tag(height_of, "--height-of", allow_zero=True) if height_of else None)
    with friendly_errors():
        inputs = [Path(source), camera, *(each for each in (straight, truth) if each)]
        target = output_file(out, inputs) if out else None
        true = read_true_mounting(truth) if truth else None
        try:
            model = load_calibration(str(camera))
            check_family(family)  # refused here, before anything is opened
        except PilotfishError:
            raise
        except ValueError as error:
            raise ConfigError(str(error)) from error
        try:
            ignored = frozenset(ignore or ())
            if number is not None:
                how = {"turn_only": turn_only, "forward": not backwards, "family": family, "ignored_ids": ignored}
                sightings, phases = _live(number, rate_hz, every, model, sizes, **how)
                films, utime = [], np.zeros(0)
            else:
                films = [open_film(Path(source), robot)] + ([open_film(straight, robot)] if straight else [])
                sightings, utime, film_of = _sightings(films, model, sizes, family, every, ignored)
                phases = _phases(films, utime, film_of, turn_only, backwards)
        except BodyLearningError as error:
            raise CalibrationError(str(error)) from error
        with working("finding the mounting"):
            result = calibrate_mounting(
                sightings,
                model,
                phases=phases,
                height=height,
                pan_rad=None if pan_deg is None else math.radians(pan_deg),
                backwards=backwards,
            )
        scales = None
        if len(films) == 1 and films[0].motion_from == ODOMETRY:
            from pilotfish.calibration.mounting.odometry_check import odometry_scales

            scales = odometry_scales(films[0].motion, utime[result.drive.frames], result.drive)
        print_mounting_report(result, scales)
        lines = mounting_lines(result)
        console.print(lines, markup=False, highlight=False, soft_wrap=True, end="")
        if target:
            write_whole(target.file, lines)
            target.wrote()
        agrees = True
        if truth and true:
            agrees = print_differences(mounting_differences(result.mounting, result.sigma, true), truth)
    if not agrees:
        raise typer.Exit(OFF_TRUTH)


def _live(
    number: int,
    rate_hz: float,
    every: int,
    model: CameraModel,
    sizes: TagSizes,
    *,
    turn_only: bool,
    forward: bool,
    family: str,
    ignored_ids: frozenset[int],
) -> tuple[Sightings, Phases]:
    """Of a camera that runs: the sightings of a turn and a drive, with the operator pressing Enter in between."""
    from pilotfish.calibration.live_camera import camera_frames
    from pilotfish.calibration.mounting.live import collect_live
    from pilotfish.cli.live_screen import enter_key
    from pilotfish.cli.mounting_live import mounting_screen

    frames = islice(camera_frames(number, (model.width, model.height), rate_hz), 0, None, every)
    with enter_key() as advance, mounting_screen(model.width, turn_only=turn_only, backwards=not forward) as show:
        collected, phases = collect_live(
            frames,
            model,
            sizes,
            turn_only=turn_only,
            forward=forward,
            family=family,
            ignored_ids=ignored_ids,
            advance=advance,
            on_picture=show,
        )
    return collected.sightings, phases


def _sightings(films, model, sizes, family, every, ignored):
    """Sightings over all films one after the other, and of each of their frames the time [us] and the film."""
    from pilotfish.calibration.body import collect_sightings

    times: list[int] = []
    owners: list[int] = []

    def noted(number: int, frames: Iterable[Frame]) -> Iterator[Frame]:
        for frame in frames:
            times.append(frame.utime)
            owners.append(number)
            yield frame

    total = sum(film.total for film in films) if all(film.total for film in films) else None
    with progress("finding tags") as step:
        collected = collect_sightings(
            chain.from_iterable(noted(number, film.frames) for number, film in enumerate(films)),
            model,
            sizes,
            family=family,
            every=every,
            ignored_ids=ignored,
            on_frame=lambda done: step(done, total),
        )
    numbers = collected.frame_numbers
    return collected.sightings, np.array(times)[numbers], np.array(owners)[numbers]


def _phases(
    films: list[Film], utime: np.ndarray, film_of: np.ndarray, turn_only: bool, backwards: bool
) -> Phases | None:
    """Which frame is of which part, if it is told or recorded; None: to be found in the pictures."""
    from pilotfish.calibration.mounting import Phases, phases_by_odometry

    everyone = np.ones(len(utime), dtype=bool)
    if turn_only:
        return Phases(everyone, ~everyone)
    if len(films) == 2:
        return Phases(film_of == 0, film_of == 1, not backwards)
    if films[0].motion is None:
        return None
    found = phases_by_odometry(films[0].motion, utime)
    console.print(
        f"by the {films[0].motion_from}: {int(found.turning.sum())} pictures of a turn, {int(found.straight.sum())} "
        f"of a "
        f"straight drive {'forwards' if found.forward else 'backwards'}",
        soft_wrap=True,
    )
    return found

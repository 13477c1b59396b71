"""``pilotfish render mounting``: a robot that turns and drives before a tag, seen by a camera that sits askew."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.camera_choice import (
    BlurOption,
    CameraFileOption,
    ConfigFileOption,
    DistortionOption,
    FovOption,
    LensOption,
    NoiseOption,
    SeedOption,
    SizeOption,
    chosen_camera,
)
from pilotfish.cli.console import friendly_errors, tell, tell_next
from pilotfish.cli.options import between
from pilotfish.cli.outputs import output_beside
from pilotfish.cli.rendered_out import check_out, with_progress, write_pictures

if TYPE_CHECKING:
    from pilotfish.core import CameraMounting

DRIVE, OFF = "What the robot does", "What is wrong"
_MOST_OFF_MM, _MOST_OFF_DEG = 500.0, 45.0
ROBOT = "robot1"


def mounting(
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            "-o",
            help="A log as of lcm-logger, NAME.lcmlog, with odometry; or a folder of pictures, or a film, NAME.mp4.",
            metavar="LCMLOG|FOLDER|MP4",
        ),
    ],
    off_mm: Annotated[
        tuple[float, float, float],
        typer.Option(help="By how much the camera sits off: forward, left, up.", metavar="X Y Z", rich_help_panel=OFF),
    ] = (3.0, -3.0, 0.0),
    off_deg: Annotated[
        tuple[float, float, float],
        typer.Option(
            help="By how much it looks off: pan to the left, tilt up, roll clockwise.",
            metavar="PAN TILT ROLL",
            rich_help_panel=OFF,
        ),
    ] = (0.5, -0.5, 0.5),
    wander_mm: Annotated[
        float,
        typer.Option(
            callback=between(0.0, 100.0, "mm"),
            help="How far the turning centre wanders, picture by picture: standard deviation along each axis.",
            rich_help_panel=OFF,
        ),
    ] = 0.0,
    odometry_percent: Annotated[
        tuple[float, float],
        typer.Option(
            help="Of a log: by how much odometry makes turns and ways too long.",
            metavar="TURN WAY",
            rich_help_panel=OFF,
        ),
    ] = (2.0, -1.0),
    tag_size: Annotated[
        float,
        typer.Option(
            callback=between(0.02, 2.0, "m"),
            help="Side of its black square [m]; its id is 0.",
            rich_help_panel=DRIVE,
        ),
    ] = 0.16,
    tag_distance_m: Annotated[
        float,
        typer.Option(callback=between(0.3, 20.0, "m"), help="From the camera, first.", rich_help_panel=DRIVE),
    ] = 1.6,
    drive_m: Annotated[
        float, typer.Option(callback=between(0.1, 10.0, "m"), help="The straight drive.", rich_help_panel=DRIVE)
    ] = 0.6,
    rate_hz: Annotated[
        float, typer.Option(callback=between(1.0, 50.0, "Hz"), help="Pictures per second.", rich_help_panel=DRIVE)
    ] = 5.0,
    camera: CameraFileOption = None,
    config: ConfigFileOption = None,
    fov_deg: FovOption = None,
    size: SizeOption = None,
    lens: LensOption = None,
    distortion: DistortionOption = None,
    noise: NoiseOption = 2.0,
    blur_px: BlurOption = 0.7,
    seed: SeedOption = 1,
) -> None:
    """Render what a robot's camera sees while the robot turns on the spot and drives straight before a fixed tag, to
    rehearse `pilotfish calibrate mounting`.

    The camera sits a little off from where --config says (or the shipped coordinator's configuration): 3 mm and half a
    degree along each axis but the height, which no motion on level ground shows. Beside the result stand truth.yaml,
    where it really sits, and camera.yaml, its calibration; of a file NAME_truth.yaml and NAME_camera.yaml.

    \b
    Examples: render, calibrate, and compare
      pilotfish render mounting --out run.lcmlog
      pilotfish calibrate mounting run.lcmlog --camera run_camera.yaml \\
          --tag-size 0.16 --height-m 0.25 --truth run_truth.yaml

    \b
    Your robot's camera; one that sits badly, on wheels that wander
      pilotfish render mounting --config robot1/robot1.yaml --out run.lcmlog
      pilotfish render mounting --off-deg 3 -2 1 --off-mm 20 -10 0 \\
          --wander-mm 1 --out pictures
    """
    from pilotfish import data, sim
    from pilotfish.calibration import rehearsal
    from pilotfish.calibration.rehearsal import outlets
    from pilotfish.coordinator import load_coordinator

    _check_off("--off-mm", off_mm, _MOST_OFF_MM, "mm")
    _check_off("--off-deg", off_deg, _MOST_OFF_DEG, "degrees")
    _check_off("--odometry-percent", odometry_percent, 20.0, "%")
    with friendly_errors():
        model, nominal = chosen_camera(camera, config, fov_deg, size, lens, distortion)
        nominal = nominal or load_coordinator(str(data.path("config/coordinator.yaml"))).coordinator.mounting
        true = _moved(nominal, off_mm, off_deg)
        settings = rehearsal.DriveSettings(
            rate_hz=rate_hz,
            tag_size_m=tag_size,
            tag_distance_m=tag_distance_m,
            drive_m=drive_m,
            wander_m=wander_mm * 1e-3,
            odometry_turn=1.0 + odometry_percent[0] / 100.0,
            odometry_way=1.0 + odometry_percent[1] / 100.0,
            seed=seed,
        )
        drive = rehearsal.plan_drive(model, true, settings)
        count = len(drive.places)
        kind, note = check_out(out, (outlets.LOG, outlets.FOLDER, outlets.FILM), count, (model.width, model.height))
        truth, its_camera = outlets.beside(out, "truth.yaml"), outlets.beside(out, "camera.yaml")
        besides = [output_beside(each) for each in (truth, its_camera)]
        imperfections = sim.Imperfections(blur_sigma_px=blur_px, noise_sigma=noise)
        shots = rehearsal.drive_shots(model, true, drive, imperfections, seed)
        if kind == outlets.LOG:
            with_progress(
                "rendering the drive",
                lambda step: outlets.write_log(out, ROBOT, shots, drive.odometry, count, step),
            )
        else:
            write_pictures("rendering the drive", kind, out, shots, count)
        moved = f"{', '.join(f'{v:g}' for v in off_mm)} mm and {', '.join(f'{v:g}' for v in off_deg)} degrees"
        remarks = [
            f"Where the camera of {out.name} sits, rendered by `pilotfish render mounting`: what a calibration should",
            f"find. Off by {moved} (pan, tilt, roll) from the configuration.",
        ]
        rehearsal.write_true_mounting(truth, true, remarks)
        rehearsal.write_true_camera(its_camera, model, remarks=[f"The camera of {out.name}, without an error."])
        odometry = " with odometry" if kind == outlets.LOG else ""
        tell(f"wrote {count} pictures{odometry} to {out}{note}")
        for each in besides:
            each.wrote()
        command = ["pilotfish", "calibrate", "mounting", out, "--camera", its_camera, "--tag-size", f"{tag_size:g}"]
        tell_next("to calibrate and compare", *command, "--height-m", f"{true.position_m[2]:.6g}", "--truth", truth)


def _check_off(option: str, values: tuple[float, ...], most: float, unit: str) -> None:
    if not all(abs(value) <= most for value in values):
        said = " ".join(f"{value:g}" for value in values)
        raise typer.BadParameter(f"{option}: {said} are not numbers from {-most:g} to {most:g} {unit}")


def _moved(
    nominal: CameraMounting, off_mm: tuple[float, float, float], off_deg: tuple[float, float, float]
) -> CameraMounting:
    from pilotfish.core import CameraMounting

    place = [value + off * 1e-3 for value, off in zip(nominal.position_m, off_mm, strict=True)]
    names = ("pan_rad", "tilt_rad", "roll_rad")
    angles = {name: getattr(nominal, name) + math.radians(off) for name, off in zip(names, off_deg, strict=True)}
    return CameraMounting(position_m=place, **angles)

"""``pilotfish render body``: a leader that turns, its tags a little off from where its file has them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated

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
from pilotfish.cli.rendered_out import check_out, write_pictures


def body(
    out: Annotated[
        Path, typer.Option("--out", "-o", help="A folder for the pictures, or a film, NAME.mp4.", metavar="FOLDER|MP4")
    ],
    leader: Annotated[
        Path | None,
        typer.Option(exists=True, dir_okay=False, help="A leader's YAML.", show_default="the shipped three_faces.yaml"),
    ] = None,
    off_mm: Annotated[
        float, typer.Option(callback=between(0.0, 100.0, "mm"), help="By how much each tag is displaced.")
    ] = 3.0,
    off_deg: Annotated[
        float, typer.Option(callback=between(0.0, 20.0, "degrees"), help="By how much each tag is turned.")
    ] = 1.0,
    pictures: Annotated[int, typer.Option(min=8, max=2000, help="Of one turn all round.", metavar="N")] = 90,
    distance_m: Annotated[
        float, typer.Option(callback=between(0.3, 20.0, "m"), help="From the camera to the turning centre.")
    ] = 1.3,
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
    """Render a leader that turns in place before a camera that stands still, to rehearse `pilotfish learn-body`.

    Each of its tags is displaced and turned a little, in directions drawn at random, as they are when they have been
    glued on by hand; where the tag with the smallest id faces stays, since that defines forward. Beside the pictures
    stand truth.yaml, the true leader, and camera.yaml, the camera's calibration; of a film NAME_truth.yaml and
    NAME_camera.yaml.

    \b
    Examples: render, learn, and compare
      pilotfish render body --out turn
      pilotfish learn-body turn --camera turn/camera.yaml --tag-size 0.16 \\
          --height-of 0=0.251043 --output my_robot.yaml --truth turn/truth.yaml

    \b
    A leader of your own, glued badly
      pilotfish render body --leader leader.yaml --off-mm 10 --off-deg 5 \\
          --out turn.mp4

    The last line that is printed has the sizes and the height that belong to the leader.
    """
    from pilotfish import data, sim
    from pilotfish.calibration import rehearsal
    from pilotfish.calibration.body import write_leader_body
    from pilotfish.calibration.rehearsal import outlets
    from pilotfish.leader import load_leader

    with friendly_errors():
        nominal = load_leader(leader or data.path("leaders/three_faces.yaml"))
        model, _ = chosen_camera(camera, config, fov_deg, size, lens, distortion)
        true = rehearsal.with_wrong_faces(nominal, off_mm * 1e-3, math.radians(off_deg), seed)
        turning = rehearsal.plan_turn(model, true, pictures, distance_m)
        kind, note = check_out(out, (outlets.FOLDER, outlets.FILM), pictures, (model.width, model.height))
        truth, its_camera = outlets.beside(out, "truth.yaml"), outlets.beside(out, "camera.yaml")
        besides = [output_beside(each) for each in (truth, its_camera)]
        imperfections = sim.Imperfections(blur_sigma_px=blur_px, noise_sigma=noise)
        shots = rehearsal.turn_shots(model, turning, imperfections, seed)
        count = write_pictures("rendering the turn", kind, out, shots, pictures)
        remarks = [
            f"The leader of {out.name}, rendered by `pilotfish render body`: what learning should find. Each tag is",
            f"{off_mm:g} mm and {off_deg:g} degrees off from {leader or 'three_faces.yaml'}.",
        ]
        write_leader_body(truth, true, remarks)
        rehearsal.write_true_camera(its_camera, model, remarks=[f"The camera of {out.name}, without an error."])
        tell(f"wrote {count} pictures to {out}{note}")
        for each in besides:
            each.wrote()
        reference = min(true.tags, key=lambda tag: tag.id)
        sizes = [each for tag in true.tags for each in ("--tag-size", f"{tag.id}={tag.size_m:g}")]
        if len({tag.size_m for tag in true.tags}) == 1:
            sizes = ["--tag-size", f"{reference.size_m:g}"]
        facing_deg = math.degrees(math.remainder(reference.facing_rad, 2.0 * math.pi))
        facing = [] if abs(abs(facing_deg) - 180.0) < 1e-6 else ["--reference-facing-deg", f"{facing_deg:.3f}"]
        family = [] if true.family == "tag36h11" else ["--family", true.family]
        height = ["--height-of", f"{reference.id}={reference.position_m[2]:.6f}"] if reference.position_m[2] > 0 else []
        command = ["pilotfish", "learn-body", out, "--camera", its_camera, *sizes, *height, *facing, *family]
        tell_next("to learn and compare", *command, "--output", "my_robot.yaml", "--truth", truth)

"""``pilotfish learn-body``: from a video of a turning robot to its leader YAML."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pilotfish.cli.console import friendly_errors, progress, tell_next, working
from pilotfish.cli.options import CalibrationOption, TagSizesOption, between, check_family
from pilotfish.cli.outputs import output_file
from pilotfish.cli.truth_report import OFF_TRUTH, TruthOfBody, print_differences

if TYPE_CHECKING:
    from pilotfish.calibration.body import KnownTag, TagSizes, TurningCentre
    from pilotfish.capture import FrameSource

LENGTH_M = (0.005, 5.0)  # of a tag's side, as in core.BodyTag, and of its height
_ANGLE = between(-360.0, 360.0, "degrees")
TURNING, KNOWN = "The base frame from the turning", "The base frame from a tag whose place is known"


def learn_body(
    video: Annotated[Path, typer.Argument(exists=True, help="A video file, or a folder of pictures.")],
    camera: CalibrationOption,
    tag_size: TagSizesOption,
    output: Annotated[Path, typer.Option("--output", dir_okay=False, help="The leader YAML to write.")],
    name: Annotated[str | None, typer.Option(help="Of the leader; default: OUTPUT without its ending.")] = None,
    family: Annotated[str, typer.Option(help="Of the tags.")] = "tag36h11",
    every: Annotated[int, typer.Option(min=1, help="Look at every N-th frame only.", metavar="N")] = 1,
    ignore: Annotated[
        list[int] | None, typer.Option("--ignore", help="An id that is not on the robot. Can be repeated.")
    ] = None,
    reference_tag: Annotated[
        int | None, typer.Option(help="The tag that defines forward; default: the smallest id.")
    ] = None,
    facing_deg: Annotated[
        float,
        typer.Option(
            "--reference-facing-deg", callback=_ANGLE, help="Where that tag looks: 0 forward, 90 left, 180 to the rear."
        ),
    ] = 180.0,
    height_of: Annotated[
        str | None,
        typer.Option(
            help="A tag and the height of its centre above the ground, as 0=0.25.",
            metavar="ID=METRES",
            rich_help_panel=TURNING,
        ),
    ] = None,
    position_m: Annotated[
        tuple[float, float, float] | None,
        typer.Option(
            "--reference-position",
            help="The reference tag's centre in the base frame: forward, left, up in metres.",
            metavar="X Y Z",
            rich_help_panel=KNOWN,
        ),
    ] = None,
    tilt_deg: Annotated[
        float,
        typer.Option("--reference-tilt-deg", callback=_ANGLE, help="Positive: it looks up.", rich_help_panel=KNOWN),
    ] = 0.0,
    roll_deg: Annotated[
        float,
        typer.Option(
            "--reference-roll-deg", callback=_ANGLE, help="Turned clockwise, as one reads it.", rich_help_panel=KNOWN
        ),
    ] = 0.0,
    reference_leader: Annotated[
        Path | None,
        typer.Option(
            exists=True, dir_okay=False, help="A leader YAML that holds the reference tag.", rich_help_panel=KNOWN
        ),
    ] = None,
    truth: TruthOfBody = None,
) -> None:
    """Learn where the tags of a leader sit, from a video of it turning, and write its YAML.

    \b
    What to film
      Put the camera still, upright and roughly level, 1 to 2 m from the robot,
      and let the robot turn in place, slowly (20 seconds a turn), once or twice
      all round. A tag's side should span 40 pixels or more. Neighbouring tags
      must be seen together: at least two tags in one picture, and a chain of
      such pictures from any tag to any other. One to twelve tags.

    \b
    What is needed
      A calibrated camera (at the video's size and focus): without it, angles and
      distances would be bent. The sides of the black squares: all lengths are
      as right as they are. If one of them does not fit the others, it is named.

    \b
    What comes out
      The tags in the robot's base frame: the turning axis is its z axis, through
      the origin. Forward follows from where the reference tag looks, the ground
      from the height of one tag. If the robot cannot turn in place, measure
      where one tag sits and say so with --reference-position (or in a YAML, with
      --reference-leader); then move robot or camera as you like.
      The table says how well each place is known (one standard deviation).

    \b
    Examples
      pilotfish learn-body turn.mp4 --camera camera.yaml --tag-size 0.16 \\
          --height-of 0=0.25 --output my_robot.yaml
      pilotfish learn-body pictures --camera camera.yaml --tag-size 0.16 \\
          --tag-size 7=0.10 --reference-tag 0 --reference-position -0.2 0 0.25 \\
          --output my_robot.yaml

    \b
    Rehearsed without a robot
      pilotfish render body --out turn
      pilotfish learn-body turn --camera turn/camera.yaml --tag-size 0.16 \\
          --height-of 0=0.251043 --output my_robot.yaml --truth turn/truth.yaml
    """
    from pilotfish.calibration import body as body_calibration
    from pilotfish.calibration.rehearsal import body_differences
    from pilotfish.cli.body_report import print_report, remarks
    from pilotfish.coordinator import load_calibration
    from pilotfish.errors import ConfigError, PilotfishError
    from pilotfish.leader import load_leader

    sizes = tag_sizes(tag_size)
    with friendly_errors():
        target = output_file(output, [video, camera, *(each for each in (reference_leader, truth) if each)])
        true = load_leader(truth) if truth else None
        try:
            model = load_calibration(str(camera))
            check_family(family)  # refused here, before the video is opened
            base = _base(reference_tag, facing_deg, height_of, position_m, tilt_deg, roll_deg, reference_leader)
        except PilotfishError:
            raise
        except ValueError as error:
            raise ConfigError(str(error)) from error
        source, pictures = _open(video)
        with progress("finding tags") as step:
            collected = body_calibration.collect_sightings(
                source,
                model,
                sizes,
                family=family,
                every=every,
                ignored_ids=frozenset(ignore or ()),
                on_frame=lambda done: step(done, pictures),
            )
        with working("learning the layout"):
            learned = body_calibration.learn_body(
                collected.sightings,
                model,
                base=base,
                reference_id=reference_tag,
                family=family,
                name=name or output.stem,
            )
        body_calibration.write_leader_body(output, learned.body, remarks(video.name, learned))
        print_report(collected, learned)
        target.wrote()
        tell_next("to look at it", "pilotfish", "leader", "show", output)
        agrees = True
        if truth and true:
            agrees = print_differences(body_differences(learned.body, true), truth)
    if not agrees:
        raise typer.Exit(OFF_TRUTH)


def _number(text: str, option: str) -> float:
    try:
        value = float(text)
    except ValueError:
        raise typer.BadParameter(f"{option}: '{text}' is not a number of metres") from None
    low, high = LENGTH_M
    if not low <= value <= high:
        raise typer.BadParameter(f"{option}: {text} is not a length here; {low:g} to {high:g} metres are")
    return value


def of_tag(text: str, option: str, *, allow_zero: bool = False) -> tuple[int, float]:
    """'7=0.10' is (7, 0.10); with ``allow_zero`` a length of 0 is one, too."""
    tag_id, _, length = text.partition("=")
    if not tag_id.strip().isdigit():
        raise typer.BadParameter(f"{option}: '{text}' is not ID=METRES, as in 7=0.10")
    if allow_zero and length.strip() in ("0", "0.0"):
        return int(tag_id), 0.0
    return int(tag_id), _number(length, option)


def tag_sizes(texts: list[str]) -> TagSizes:
    """What ``--tag-size`` says: one for all tags, others by id."""
    from pilotfish.calibration.body import TagSizes

    default = [_number(text, "--tag-size") for text in texts if "=" not in text]
    if len(default) > 1:
        raise typer.BadParameter("--tag-size: several sizes for all tags; give those of single tags as ID=METRES")
    by_id = dict(of_tag(text, "--tag-size") for text in texts if "=" in text)
    return TagSizes(default[0] if default else None, by_id)


def _base(
    reference_tag: int | None,
    facing_deg: float,
    height_of: str | None,
    position_m: tuple[float, float, float] | None,
    tilt_deg: float,
    roll_deg: float,
    leader: Path | None,
) -> KnownTag | TurningCentre:
    from pilotfish.calibration.body import KnownTag, TurningCentre
    from pilotfish.coordinator import load_leader_body
    from pilotfish.core import BodyTag
    from pilotfish.errors import BodyLearningError

    if leader is None and position_m is None:
        height = of_tag(height_of, "--height-of") if height_of else None
        return TurningCentre(math.radians(facing_deg), height)
    if height_of or (leader and position_m):
        raise typer.BadParameter("--height-of, --reference-position and --reference-leader exclude each other")
    if leader is not None:
        known = {tag.id: tag for tag in load_leader_body(str(leader)).tags}
        tag_id = reference_tag if reference_tag is not None else min(known)
        if tag_id not in known:
            raise BodyLearningError(f"{leader} has no tag {tag_id}; it has {sorted(known)}")
        return KnownTag(known[tag_id])
    if reference_tag is None:
        raise typer.BadParameter("--reference-position needs --reference-tag ID: whose position is it?")
    angles = {"facing_rad": facing_deg, "tilt_rad": tilt_deg, "roll_rad": roll_deg}
    angles = {key: math.radians(value) for key, value in angles.items()}
    return KnownTag(BodyTag(id=reference_tag, position_m=list(position_m), **angles))


def _open(video: Path) -> tuple[FrameSource, int | None]:
    """The frames, and how many there are if that is known beforehand."""
    from pilotfish.calibration.video_length import pictures_in_video
    from pilotfish.capture import CaptureError, open_images, open_video
    from pilotfish.errors import BodyLearningError

    try:
        if not video.is_dir():
            return open_video(str(video)), pictures_in_video(video)
        pictures = sum(
            1 for file in video.iterdir() if file.suffix.lower() in {".png", ".jpg", ".jpeg", ".pgm", ".bmp"}
        )
        return open_images(str(video)), pictures or None
    except CaptureError as error:
        raise BodyLearningError(str(error)) from error

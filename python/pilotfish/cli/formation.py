"""``pilotfish formation``: several robots as one file: look at it, play it, measure whether it holds."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Annotated

import typer

from pilotfish.cli.console import console, friendly_errors, progress
from pilotfish.cli.driving_options import Tunable
from pilotfish.cli.options import DarkOption, DurationOption, FormatOption, OutOption, PictureFormat, between
from pilotfish.cli.outputs import OutputFolder, output_file, output_picture

app = typer.Typer(
    help="Formations: several robots as one file (column, wedge, diamond, star, ...); whether they hold.",
    no_args_is_help=True,
)

FormationArgument = Annotated[
    str,
    typer.Argument(metavar="FILE", help="A formation file, or a shipped one by name (pilotfish data formations)."),
]
LawsOption = Annotated[
    list[Tunable] | None,
    typer.Option("--law", help="The law that drives; can be repeated.", show_default="all four"),
]
RobotsOption = Annotated[int, typer.Option(min=2, max=25, help="Robots in the chain, with the leader.")]
SpacingOption = Annotated[
    float, typer.Option("--spacing-m", callback=between(0.1, 5.0, "m"), help="Distance that each robot keeps.")
]
SpeedOption = Annotated[
    float, typer.Option("--speed-mps", callback=between(0.01, 2.0, "m/s"), help="Mean speed of the leader.")
]
ConfigOption = Annotated[
    Path | None,
    typer.Option("--config", exists=True, dir_okay=False, help="A coordinator's configuration for every robot."),
]
JsonOption = Annotated[Path | None, typer.Option("--json", dir_okay=False, help="Write the figures there.")]


@app.command()
def show(
    file: FormationArgument,
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", dir_okay=False, help="The drawing: .png, .svg or .pdf.", show_default="NAME.png"),
    ] = None,
    dark: DarkOption = False,
) -> None:
    """Draw a formation from above, shape by shape, and say who watches whom from where.

    A robot watches the nearest robot in front of it that is in the picture as a whole tag and not hidden by another
    robot; in a chain, a star and a tree the shape says whom. What cannot be seen is refused, with what would be
    allowed.

    \b
    Examples
      pilotfish formation show wedge
      pilotfish formation show my_formation.yaml --out my_formation.svg
    """
    from pilotfish.cli.formation_tables import otherwise_table, watches_table
    from pilotfish.formation import find_formation, load_formation
    from pilotfish.plots.formation_picture import draw_formation
    from pilotfish.plots.style import DARK, LIGHT, save

    with friendly_errors():
        formation = load_formation(find_formation(file))
        picture = output_picture(out or Path(f"{formation.name}.png"))
        for table in [*watches_table(formation), otherwise_table(formation)]:
            if table:
                console.print(table)
        theme = DARK if dark else LIGHT
        save(draw_formation(formation, theme), picture.file)
        picture.wrote()


@app.command()
def expand(
    file: FormationArgument,
    out: Annotated[Path, typer.Option("--out", "-o", dir_okay=False, help="The scenario to write, a .yaml.")],
) -> None:
    """Write a formation as a scenario, with a configuration and tags of its own for each robot.

    Beside OUT.yaml comes the folder OUT_files; all paths are relative, so both can be moved together. A scenario has
    one setpoint a robot: the first shape. Changes of shape are played by `formation run`.

    \b
    Examples
      pilotfish formation expand diamond -o diamond.yaml
      pilotfish experiment ./diamond.yaml --profile anticipate
    """
    from pilotfish.cli.console import warn
    from pilotfish.formation import find_formation, load_formation
    from pilotfish.formation.expand import expand as write
    from pilotfish.formation.expand import load_expanded

    with friendly_errors():
        if out.suffix.lower() not in (".yaml", ".yml"):
            raise typer.BadParameter(f"--out: '{out.name}' ends in neither .yaml nor .yml")
        source = find_formation(file)
        target = output_file(out, [source])
        formation = load_formation(source)
        with tempfile.TemporaryDirectory(prefix="pilotfish-") as folder:
            load_expanded(formation, Path(folder))  # refused before anything is written
        write(formation, out)
        target.wrote(f"and the folder {out.with_name(f'{out.stem}_files')}")
        if len(formation.stages) > 1:
            warn(
                f"its {len(formation.stages) - 1} changes of shape are not in the scenario; `formation run` plays them"
            )


@app.command()
def run(
    file: FormationArgument,
    law: Annotated[Tunable, typer.Option(help="The law that drives.")] = Tunable.anticipate,
    rendered: Annotated[
        bool, typer.Option("--rendered", help="Render every picture and look for tags, in this process: slower.")
    ] = False,
    lcm: Annotated[
        bool, typer.Option("--lcm", help="The real programs over LCM; setpoints are changed by messages.")
    ] = False,
    duration_s: DurationOption = None,
    out: OutOption = None,
    picture_format: FormatOption = PictureFormat.png,
    dark: DarkOption = False,
) -> None:
    """Play a formation with its changes of shape; say how well each robot keeps its place, how long it takes to form
    again, and how near any two robots come to each other.

    Measurements are drawn, with the noise of rendered ones, unless --rendered or --lcm is given. A leader that leaves
    the picture or goes behind another robot is not seen in either case.

    \b
    Examples
      pilotfish formation run wedge
      pilotfish formation run column --lcm --out out
      pilotfish formation run my_formation.yaml --law paper --duration-s 20
    """
    from pilotfish.cli.formation_tables import followed_table, forming_table, keeping_table
    from pilotfish.formation import find_formation, load_formation
    from pilotfish.formation.measures import forming, keeping
    from pilotfish.formation.run import play

    if rendered and lcm:
        raise typer.BadParameter("--rendered and --lcm exclude each other: over LCM everything is rendered")
    transport = "lcm" if lcm else "in-process" if rendered else "drawn"
    with friendly_errors():
        formation = load_formation(find_formation(file))
        with progress(f"{formation.name}, {law.value}") as step:
            done = play(formation, law=law.value, transport=transport, duration_s=duration_s, on_progress=step)
        console.print(keeping_table(keeping(done), f"{formation.name}, {law.value}: each robot and its leader"))
        console.print(forming_table(forming(done), formation.tolerance_m))
        if changes := followed_table(done):
            console.print(changes)
        if out:
            from pilotfish.cli.pictures import gallery
            from pilotfish.plots.followed import draw_followed
            from pilotfish.plots.paths import draw_paths

            into, folder = gallery(out, picture_format.value, dark), OutputFolder(out)
            stem, title = f"{formation.name}_{law.value}", f"{formation.name}, {law.value}: from above"
            for robot, recording in done.recordings.items():
                folder.wrote(recording.to_csv(out / f"{stem}_{robot}.csv"))
            figure = draw_paths(list(done.recordings.values()), title, into.theme)
            folder.wrote(into.save(figure, f"{stem}_paths", title, "").file)
            for robot in formation.otherwise.watches:
                figure, title = draw_followed(done, robot, into.theme), f"{formation.name}: whom {robot} follows"
                folder.wrote(into.save(figure, f"{stem}_{robot}_followed", title, "").file)


@app.command()
def stability(
    law: LawsOption = None,
    headway_s: Annotated[
        list[float] | None,
        typer.Option("--headway-s", help="Time headway, control.spacing.headway_s; repeatable.", show_default="0"),
    ] = None,
    robots: RobotsOption = 12,
    spacing_m: SpacingOption = 1.0,
    speed_mps: SpeedOption = 0.2,
    amplitude_mps: Annotated[
        float, typer.Option("--amplitude-mps", callback=between(1e-4, 1.0, "m/s"), help="Of its sine.")
    ] = 0.02,
    frequency_hz: Annotated[
        list[float] | None,
        typer.Option("--frequency-hz", help="Can be repeated.", show_default="12 from 0.02 to 1.1 Hz"),
    ] = None,
    leader_intent: Annotated[
        bool, typer.Option("--leader-intent", help="Each robot announces what it is about to drive to the next.")
    ] = False,
    intent_delay_s: Annotated[
        float, typer.Option(callback=between(0.0, 1.0, "s"), help="With --leader-intent: until it is heard.")
    ] = 0.033,
    intent_loss: Annotated[
        float, typer.Option(callback=between(0.0, 1.0), help="With --leader-intent: share that is lost.")
    ] = 0.0,
    config: ConfigOption = None,
    seed: Annotated[int, typer.Option(min=0, max=2**31 - 1, help="Of the measurements' noise.")] = 1,
    jobs: Annotated[int | None, typer.Option(min=1, max=256, help="Processes.", show_default="one a processor")] = None,
    out: OutOption = None,
    json_file: JsonOption = None,
    picture_format: FormatOption = PictureFormat.png,
    dark: DarkOption = False,
) -> None:
    """Measure string stability: whether a disturbance of the leader's speed grows from robot to robot of a chain.

    The leader's speed is a sine at one frequency after the other, and then a step. Gains are fitted by least squares
    over whole periods, after the transient. A run with 12 robots contains every chain of 2 to 12. All four laws take
    some 3 minutes on two processors.

    \b
    Examples
      pilotfish formation stability --out out --json out/stability.json
      pilotfish formation stability --law paper --law anticipate --robots 5
      pilotfish formation stability --law anticipate --headway-s 0 --headway-s 0.3
      pilotfish formation stability --law anticipate --leader-intent --intent-loss 0.2
      pilotfish formation stability --law pid --frequency-hz 0.1 --frequency-hz 0.4
    """
    import json

    from pilotfish.cli.formation_tables import stability_tables
    from pilotfish.formation.relay import Network
    from pilotfish.formation.stability import FREQUENCIES_HZ, LAWS, Trial, measure, to_json
    from pilotfish.whole_files import write_whole

    if amplitude_mps >= speed_mps:
        limit = f"less than the speed ({speed_mps:g} m/s), so that the leader never stops"
        raise typer.BadParameter(f"--amplitude-mps: {amplitude_mps:g} is not {limit}")
    frequencies_hz = _numbers("--frequency-hz", frequency_hz, FREQUENCIES_HZ, 0.005, 5.0, "Hz")
    headways_s = _numbers("--headway-s", headway_s, (0.0,), 0.0, 3.0, "s")
    laws = list(dict.fromkeys(each.value for each in law)) if law else list(LAWS)
    own = str(config) if config else None
    intents = Network(intent_delay_s, intent_loss) if leader_intent else None
    trial = Trial(robots, spacing_m, speed_mps, amplitude_mps, frequencies_hz, seed, own, intents)
    with friendly_errors():
        figures = output_file(json_file) if json_file else None
        with progress("chains") as step:
            results = measure(laws, headways_s, trial, jobs=jobs, on_progress=step)
        for table in stability_tables(results, trial):
            console.print(table)
        if figures:
            write_whole(figures.file, json.dumps(to_json(results, trial), indent=1) + "\n")
            figures.wrote()
        if out:
            from pilotfish.cli.pictures import gallery
            from pilotfish.plots.string_stability import draw_string_stability

            into, folder = gallery(out, picture_format.value, dark), OutputFolder(out)
            for own_s in headways_s:
                chosen = [result for result in results if result.headway_s == own_s]
                said = ", with leader intents" if intents else ""
                title = f"A chain of {robots}, {spacing_m:g} m, headway {own_s:g} s{said}: leader at {speed_mps:g} m/s"
                figure = draw_string_stability(chosen, f"{title} ± {amplitude_mps:g} m/s", into.theme)
                name = "string_stability" if len(headways_s) == 1 else f"string_stability_{own_s:g}s"
                folder.wrote(into.save(figure, name, title, "").file)


@app.command()
def gaps(
    law: Annotated[Tunable, typer.Option(help="The law that drives.")] = Tunable.anticipate,
    robots: RobotsOption = 12,
    spacing_m: SpacingOption = 1.0,
    speed_mps: SpeedOption = 0.2,
    config: ConfigOption = None,
    json_file: JsonOption = None,
) -> None:
    """Measure the steady gaps of a chain behind a leader on a line, a circle and a figure of eight, robot by robot.

    Circle and eight are so large that the whole chain can follow: a robot that keeps its leader straight ahead drives
    on a smaller circle than that. The goal is 5 mm and 0.3 degrees for every robot.

    \b
    Examples
      pilotfish formation gaps
      pilotfish formation gaps --law paper --robots 4 --json gaps.json
    """
    import json
    from dataclasses import asdict

    from pilotfish.cli.formation_tables import gaps_table
    from pilotfish.formation.gaps import PATHS, steady_gaps
    from pilotfish.whole_files import write_whole

    content = {"coordinator": str(config.resolve())} if config else {}
    with friendly_errors():
        figures = output_file(json_file) if json_file else None
        results = []
        for path in PATHS:
            with progress(f"{path.replace('_', ' ')}, {law.value}") as step:
                how = {"robots": robots, "spacing_m": spacing_m, "speed_mps": speed_mps, "content": content}
                results.append(steady_gaps(path, law.value, **how, on_progress=step))
        console.print(gaps_table(results))
        if figures:
            write_whole(figures.file, json.dumps([asdict(result) for result in results], indent=1) + "\n")
            figures.wrote()


def _numbers(
    option: str, given: list[float] | None, default: tuple[float, ...], low: float, high: float, unit: str
) -> tuple[float, ...]:
    for value in given or ():
        if not low <= value <= high:
            raise typer.BadParameter(f"{option}: {value} is not a number from {low:g} to {high:g} {unit}")
    return tuple(sorted(set(given))) if given else default

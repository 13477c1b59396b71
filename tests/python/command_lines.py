"""Every command of ``pilotfish`` as a line that works, and what may be said wrongly in each of its places.

A new command is covered by a line in COMMANDS.
"""

import os
from dataclasses import dataclass
from pathlib import Path

from pilotfish import data

LAW = data.path("fuzzy/coordination.yaml")
CALIBRATION = data.path("calibrations/sim_640x480.yaml")
TUNING = data.path("tuned/pid.yaml")
LEADER = data.path("leaders/three_faces.yaml")
SCENARIO = data.path("scenarios/line.yaml")
CAMPAIGN = data.path("sweeps/laws_over_speed.yaml")
SHORT = ["--duration-s", "0.5", "--in-process", "--profile", "paper"]


@dataclass(frozen=True)
class Slot:
    """A place in a command line: behind ``option``, or without one. ``kind`` says what stands there."""

    kind: str  # "read" (a file), "write" (a file), "folder" (to write into), "number"
    good: str | Path  # {tmp} is the test's folder
    option: str = ""


def read(good, option=""):
    return Slot("read", good, option)


def write(good, option=""):
    return Slot("write", "{tmp}/" + good, option)


def folder(option="--out"):
    return Slot("folder", "{tmp}/out", option)


def number(option, good):
    return Slot("number", good, option)


COMMANDS = {
    "experiment": ["experiment", "line", *SHORT, read(TUNING, "--tuning"), folder()],
    "experiment over LCM": ["experiment", "line", number("--duration-s", "0.5"), "--in-process"],
    "demo": ["demo", number("--duration-s", "0.5"), folder()],
    "render": ["render", read(SCENARIO), number("--frames", "1"), folder()],
    "render board": [
        *("render", "board", "--size", "160x120", number("--fov-deg", "60"), "--views", "1"),
        *(number("--share", "0.5"), number("--seed", "1"), folder()),
    ],
    "render mounting": [
        *("render", "mounting", read(CALIBRATION, "--camera"), "--rate-hz", "2", number("--drive-m", "0.6")),
        *(number("--tag-size", "0.16"), write("run.lcmlog", "--out")),
    ],
    "render body": ["render", "body", read(LEADER, "--leader"), number("--off-mm", "3"), "--pictures", "12", folder()],
    "plot": [
        "plot",
        read("{run}"),
        number("--distance-setpoint-m", "1"),
        number("--bearing-setpoint-deg", "1"),
        folder(),
    ],
    "plot a log": ["plot", read("{log}"), folder()],
    "report": ["report", read("{log}"), write("report.html", "--out")],
    "report of two": ["report", "{log}", read("{log}"), write("report.html", "--out")],
    "export to CSV": ["export", read("{log}"), "--to", "csv", write("run.csv", "--out")],
    "export to Parquet": ["export", read("{log}"), "--to", "parquet", write("run.parquet", "--out")],
    "export to MCAP": ["export", read("{log}"), "--to", "mcap", write("run.mcap", "--out")],
    "export to MP4": ["export", read("{log}"), "--to", "mp4", write("run.mp4", "--out")],
    "plot fuzzy": ["plot", read(LAW), folder()],
    "tune": ["tune", "pid", number("--trials", "1"), number("--seed", "1"), write("pid.yaml", "--out")],
    "learn-body": [
        "learn-body",
        Slot("read", "{video}"),
        read(CALIBRATION, "--camera"),
        number("--tag-size", "0.16"),
        number("--every", "1"),
        number("--reference-facing-deg", "1"),
        number("--reference-tilt-deg", "1"),
        number("--reference-roll-deg", "1"),
        read(LEADER, "--reference-leader"),
        write("leader.yaml", "--output"),
    ],
    "learn-body of one size": [
        "learn-body",
        "{video}",
        *("--camera", CALIBRATION, "--output", "{tmp}/leader.yaml"),
        number("--tag-size", "0=0.16"),
        number("--height-of", "0=0.16"),
        number("--ignore", "3"),
        number("--reference-tag", "0"),
    ],
    "sweep": ["sweep", read(CAMPAIGN), "--check", folder()],
    "sweep's results": ["sweep", "report", Slot("read", "{tmp}/none")],
    "fuzzy show": ["fuzzy", "show", read(LAW)],
    "fuzzy check": ["fuzzy", "check", read(LAW)],
    "fuzzy plot": ["fuzzy", "plot", read(LAW), folder()],
    "fuzzy explain": [
        *("fuzzy", "explain", read(LAW), number("--e", "0.1"), number("--ec", "0.1")),
        *(number("--width-error", "0.1"), number("--width-error-change", "0.1"), write("why.png", "--out")),
    ],
    "fuzzy convert": ["fuzzy", "convert", read(LAW), write("law.fll")],
}

NUMBERS = ["nan", "inf", "-inf", "1e308", "-1e308", "-1", "1e9", "abc", "", "0=nan", "0=1e308", "-1=0.1", "9" * 400]


def _directory(path):
    path.mkdir()


def _pipe(path):
    os.mkfifo(path)


def _endless(path):
    path.symlink_to("/dev/zero")


def _circle(path):
    path.symlink_to(path.name)


def _missing(path):
    pass


def _empty(path):
    path.write_bytes(b"")


def _latin(path):
    path.write_bytes("# Größe\nname,Größe\n1,2\n".encode("latin-1"))


def _long_field(path):
    path.write_bytes(b"robot,leader\n" + b"a" * 200_000 + b",b\n")


def _hundred_megabytes(path):
    shared = path.parents[1] / "hundred_megabytes"  # beside the folders of the tests: written once, not for every place
    if not shared.exists():
        shared.write_bytes(b"a" * 100_000_000)
    path.hardlink_to(shared)


def _zeros(path):
    path.write_bytes(bytes(1000))


def named(*makers):
    return {make.__name__.strip("_"): make for make in makers}


READ = named(
    *(_directory, _pipe, _endless, _circle, _missing),
    *(_empty, _latin, _long_field, _hundred_megabytes, _zeros),
)


def _full(path):
    path.symlink_to("/dev/full")


def _below_a_file(path):
    path.write_bytes(b"")
    return path / "deeper" / path.name


def _where_nobody_can(path):
    return Path("/proc") / path.name


WRITE = named(_directory, _full, _circle, _below_a_file, _where_nobody_can)
FOLDER = named(_empty, _full, _circle, _below_a_file, _where_nobody_can)


def cases():
    """(command, place in its line, what is wrong there) for every place of every command."""
    wrongs = {"read": READ, "write": WRITE, "folder": FOLDER, "number": NUMBERS}
    return [
        (command, place, wrong)
        for command, words in COMMANDS.items()
        for place, word in enumerate(words)
        if isinstance(word, Slot)
        for wrong in wrongs[word.kind]
    ]


def line(command, here, tmp, place=None, wrong=None):
    """The words of a command; at ``place`` with what is ``wrong`` there. ``here``: what {video}, {run}, {log} are."""
    words = []
    for at, word in enumerate(COMMANDS[command]):
        slot = word if isinstance(word, Slot) else Slot("", word)
        good = str(slot.good).format(tmp=tmp, **here)
        words += (
            [f"{slot.option}={_at(slot, good, tmp, wrong) if at == place else good}"]
            if slot.option
            else [_at(slot, good, tmp, wrong) if at == place else good]
        )
    return words


def _at(slot, good, tmp, wrong):
    if slot.kind == "number":
        return wrong
    path = tmp / f"wrong{Path(good).suffix}"
    make = {"read": READ, "write": WRITE, "folder": FOLDER}[slot.kind][wrong]
    return str(make(path) or path)

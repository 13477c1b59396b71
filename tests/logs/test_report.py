"""The page: opened by a real browser, in the light and in the dark, without a word on its console."""

from __future__ import annotations

import html.parser
import os
import re
from pathlib import Path

import numpy as np
import pytest
from recordings import Writer

from pilotfish.lcmtypes.pilotfish import box_file_t, box_start_t
from pilotfish.logs import read_run
from pilotfish.logs.notes import Stage
from pilotfish.logs.report import ReportedRun, report_html
from pilotfish.logs.report.page import summary_section
from pilotfish.logs.report.tables import event_words, stage_table
from pilotfish.logs.run import RunEvent

CHROMIUM = os.environ.get("PILOTFISH_CHROMIUM", "/usr/bin/chromium")
FLAGS = [
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


def runs_of(*paths):
    runs = []
    for at, path in enumerate(paths):
        run = read_run(path)
        runs += [ReportedRun(f"run {at}: {robot.name}", run, robot) for robot in run.coordinators]
    return runs


def page_of(*paths):
    return report_html(runs_of(*paths))


@pytest.fixture(scope="module")
def pages(recorded, tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    for name, paths in {"one": [recorded.box], "two": [recorded.box, recorded.bus]}.items():
        (folder / f"{name}.html").write_text(page_of(*paths), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def browser():
    playwright = pytest.importorskip("playwright.sync_api")
    if not Path(CHROMIUM).is_file():
        pytest.skip(f"no browser at {CHROMIUM}; PILOTFISH_CHROMIUM says where one is")
    with playwright.sync_playwright() as driver:
        browser = driver.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield browser
        browser.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["one", "two"])
def test_a_browser_shows_it_without_complaint_and_loads_nothing_else(browser, pages, name, scheme):
    context = browser.new_context(color_scheme=scheme, viewport={"width": 1200, "height": 900})
    page, said, asked = context.new_page(), [], []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda request: asked.append(request.url))
    page.goto((pages / f"{name}.html").as_uri())
    assert said == []
    assert [url for url in asked if not url.startswith("data:")] == [(pages / f"{name}.html").as_uri()]
    for link in page.locator("nav a").all():  # every section is there and can be gone to
        assert page.locator(link.get_attribute("href")).count() == 1
    for drawing in page.locator("figure svg").all():
        box = drawing.bounding_box()
        assert box["width"] > 500 and box["height"] > 300
    # Text has the page's colour, in the drawings as well: light on dark in the dark.
    ground, ink, drawn = (
        page.evaluate(f"getComputedStyle(document.querySelector('{where}')).{what}")
        for where, what in (("body", "backgroundColor"), ("body", "color"), ("figure svg text", "fill"))
    )
    lightness = [sum(map(int, re.findall(r"\d+", colour)[:3])) for colour in (ground, ink, drawn)]
    assert lightness[1] == lightness[2]
    assert (lightness[0] > lightness[1]) == (scheme == "light")
    for width in (1200, 390):  # and on a phone nothing reaches beyond its edge
        page.set_viewport_size({"width": width, "height": 900})
        assert page.evaluate("document.documentElement.scrollWidth <= window.innerWidth")
    context.close()


def test_stages_and_reasons_are_said_in_words():
    stages = {"beats_late": Stage([1] + [0] * 10, 0.1), "new_stage": Stage([1] + [0] * 10, 0.1)}
    assert "beats_late" not in stage_table(stages)
    assert "lateness of commands" in stage_table(stages) and "new stage" in stage_table(stages)
    events = [
        RunEvent(0.0, "status", "lost: no_frame"),
        RunEvent(0.0, "status", "tracking"),
        RunEvent(0.0, "gap", "a: b"),
    ]
    assert [event_words(event) for event in events] == ["lost: no frame arrived in time", "tracking", "a: b"]


VOID = ("meta", "link", "br", "img")


class Outline(html.parser.HTMLParser):
    """Open elements, ids, and whether every element is closed in its turn."""

    def __init__(self, text):
        super().__init__()
        self.open, self.ids, self.names = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.names.append(tag)
        self.ids += [value for key, value in attributes if key == "id"]
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes):
        self.ids += [value for key, value in attributes if key == "id"]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


def test_the_page_is_well_formed_and_every_id_is_its_own(pages):
    for file in pages.glob("*.html"):
        outline = Outline(file.read_text())
        assert outline.open == []
        assert len(set(outline.ids)) == len(outline.ids)
        assert "script" not in outline.names


def test_it_shows_the_figures_that_are_computed(recorded, pages):
    from pilotfish.logs.summary import shown, summarize

    summary = summarize(read_run(recorded.box).robots["robot1"])
    text = (pages / "one.html").read_text()
    for name in ("duration_s", "rms_distance_error_mm", "latency_p99_ms", "frames"):
        assert f'<td class="number">{shown(name, getattr(summary, name))}</td>' in text


def hostile(tmp_path, word):
    """A black box whose every text wants to be an element of the page."""
    writer = Writer(tmp_path / "run.log")
    start = box_start_t()
    start.program = start.command_line = word
    start.robot, start.session = "robot1", 77
    file = box_file_t()
    file.role, file.name, file.data = word, word, f'"{word}": 1'.encode()
    file.size, start.files, start.file_count = len(file.data), [file], 1
    start.overrides, start.override_count = [f"{word}={word}"], 1
    writer.write("BOX", start)
    for _ in range(5):
        writer.frame(rejected={word[:24]: 3})
        writer.passes()
    return writer.file


def test_nothing_in_a_recording_becomes_an_element_of_the_page(tmp_path):
    word = "<script>alert(1)</script>"
    (tmp_path / "other").mkdir()
    text = page_of(hostile(tmp_path, word), hostile(tmp_path / "other", "<b>"))
    outline = Outline(text)
    assert "script" not in outline.names and "b" not in outline.names
    assert "&lt;script&gt;alert(1)" in text


def test_what_differs_between_runs_is_named_key_by_key(tmp_path):
    for name, gain in (("one", 2.0), ("two", 2.5)):
        (tmp_path / name).mkdir()
        writer = Writer(tmp_path / name / "run.log")
        start = box_start_t()
        start.program, start.robot, start.session = f"pilotfish {name}", "robot1", 77
        file = box_file_t()
        file.role, file.data = "config", f"control: {{gain: {gain}, same: 1}}".encode()
        file.size, start.files, start.file_count = len(file.data), [file], 1
        writer.write("BOX", start)
        writer.frame()
    text = page_of(tmp_path / "one" / "run.log", tmp_path / "two" / "run.log")
    differing = text[text.index("What differs</h2>") :].split("<h2")[0]
    cells = re.findall(r"<td[^>]*>([^<]*)</td>", differing)
    assert cells == ["program", "pilotfish one", "pilotfish two", "config: control.gain", "2.0", "2.5"]


def summary_of(*paths):
    """The first section, without drawing the others."""
    return summary_section(runs_of(*paths))


def test_two_recordings_of_one_run_are_told_and_what_only_one_of_them_has(tmp_path):
    """lcm-logger began two frames late and has not heard the last one."""
    writer = Writer(tmp_path / "whole.log")
    ends = [0]
    for _ in range(10):
        writer.frame()
        writer.passes()
        ends.append(writer.file.stat().st_size)
    part = tmp_path / "part.log"
    part.write_bytes(writer.file.read_bytes()[ends[2] : ends[9]])
    told = summary_of(writer.file, part)
    assert "run 0: robot1 and run 1: robot1 are recordings of the same run: 7 frames are in both" in told
    assert "3 are only in run 0: robot1, 0 only in run 1: robot1" in told
    (tmp_path / "other").mkdir()
    other = Writer(tmp_path / "other" / "run.log", session=78)
    other.frame()
    assert "the same run" not in summary_of(writer.file, other.file)


def test_a_run_that_has_not_settled_is_said_not_to_have(tmp_path):
    """It comes nearer throughout, and never rests; against one that does from its 50th frame on."""
    for name, settles in (("settles", True), ("never", False)):
        (tmp_path / name).mkdir()
        writer = Writer(tmp_path / name / "run.log")
        for k in range(300):
            writer.frame(1.1 + (max(0, 50 - k) * 0.01 if settles else 0.002 * (300 - k)))
            writer.passes()
        assert ("has not settled" in summary_of(writer.file)) == (not settles)


def test_runs_without_settings_say_so_and_a_run_without_a_leader_is_drawn(tmp_path):
    writer = Writer(tmp_path / "run.log")
    for _ in range(3):
        writer.frame(None)
        writer.passes()
    text = page_of(writer.file, writer.file)
    assert "only a black box records settings" in text
    assert text.count("<svg") == 2


def test_an_hour_makes_a_page_that_a_browser_can_show(tmp_path):
    """Curves are thinned: an hour at 30 Hz has 108 000 frames, the page less than 1.5 MB. Here twenty minutes of it,
    made in memory from a short recording; more would be thinned to the same."""
    from dataclasses import replace

    from pilotfish.logs.run import Table

    writer = Writer(tmp_path / "run.log")
    chance = np.random.default_rng(5)
    for _ in range(60):
        writer.frame(1.0 + chance.normal() * 0.01)
        writer.passes()
    run = read_run(writer.file)
    robot = run.robots["robot1"]
    times = 600

    def longer(table):
        arrays = {name: np.tile(values, times) for name, values in table.arrays.items()}
        arrays["t_s"] = np.arange(len(arrays["t_s"])) / 30.0
        return Table(table.columns, arrays)

    robot = replace(robot, frames=longer(robot.frames), commands=longer(robot.commands))
    text = report_html([ReportedRun("long", run, robot)])
    assert len(text) < 1_500_000


def followed(writer, count, distance_m=1.1):
    for k in range(count):
        writer.frame(distance_m(k) if callable(distance_m) else distance_m)
        writer.passes()


def tiles_of(file):
    """The doubts that the tiles name; and which of them are marked."""
    text = summary_of(file)
    return set(re.findall(r'<div class="why">([^<]*)</div>', text)), text.count('class="tile doubt"')


def test_the_tiles_of_a_run_that_is_not_what_it_looks_like_say_so(tmp_path):
    """10 s at the wanted distance settle; the same and then 5 s without the leader; the same and a file that ends in
    the middle of an event; and 10 s of coming nearer by 2 mm a frame."""
    for name in ("whole", "lost", "cut", "never"):
        (tmp_path / name).mkdir()
    whole, lost, cut, never = (Writer(tmp_path / name / "run.log") for name in ("whole", "lost", "cut", "never"))
    for writer in (whole, lost, cut):
        followed(writer, 300)
    followed(never, 300, lambda k: 1.1 + 0.002 * (300 - k))
    followed(lost, 150, None)
    cut.file.write_bytes(cut.file.read_bytes()[:-5])
    assert tiles_of(whole.file) == (set(), 0)
    assert tiles_of(lost.file) == ({"lost at the end"}, 3)
    assert "it followed until 10.0 s only, and was lost at the end (15.0 s)" in summary_of(lost.file)
    assert tiles_of(cut.file) == ({"the recording is cut"}, 3)
    assert tiles_of(never.file) == ({"not settled"}, 3)
    assert "<b>not settled</b>" in summary_of(never.file)
    assert "not settled" not in summary_of(lost.file)


def test_runs_that_are_compared_have_their_doubts_in_a_line_each(tmp_path):
    (tmp_path / "b").mkdir()
    whole, lost = Writer(tmp_path / "a.log"), Writer(tmp_path / "b" / "b.log")
    followed(whole, 300)
    followed(lost, 300)
    followed(lost, 150, None)
    assert summary_of(whole.file, lost.file).count("it followed until 10.0 s only") == 1

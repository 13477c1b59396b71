"""``pilotfish top`` with messages on a real bus: the screen through Textual's pilot, the table through the program."""

import fcntl
import json
import os
import pty
import re
import struct
import subprocess
import sys
import termios
import threading

import lcm
import pytest
from on_screen import on_screen, until
from robot_messages import base, command, observation, status
from textual.widgets import DataTable, Static

from pilotfish.harness.ports import private_lcm_url
from pilotfish.operating import Operator
from pilotfish.top.app import TopApp
from pilotfish.watching.columns import COLUMNS
from scripted_coordinator import ScriptedCoordinator

BY_NAME = {column.name: number for number, column in enumerate(COLUMNS)}


class Speaker:
    """Sends what it is given, 20 times a second, in a thread. Use as a context manager."""

    def __init__(self, url, **messages):
        self.bus = lcm.LCM(url)
        self.messages = messages  # channel -> message; may be changed meanwhile
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def _run(self):
        while not self._over.wait(0.05):
            for channel, message in list(self.messages.items()):
                self.bus.publish(channel, message.encode())

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()


@pytest.fixture
def url():
    return private_lcm_url()


async def until_robots(pilot, app, count):
    """As many robots are shown, and the first one is selected, whichever was heard first."""
    await until(pilot, lambda: len(rows(app)) == count, f"{count} robots")
    app.query_one(DataTable).move_cursor(row=0)
    await pilot.pause()


def rows(app):
    table = app.query_one(DataTable)
    return [[str(cell) for cell in table.get_row_at(k)] for k in range(table.row_count)]


def cell(app, robot, name):
    return next(row[BY_NAME[name]] for row in rows(app) if row[0] == robot)


def detail(app):
    return str(app.query_one("#detail", Static).render())


# --- the screen -------------------------------------------------------------------------------------------------------
def test_robots_appear_with_their_figures(url):
    app = TopApp(url)

    async def scenario(pilot):
        await until_robots(pilot, app, 2)
        await until(pilot, lambda: cell(app, "robot1", "distance_m") == "1.250", "the distance")
        assert cell(app, "robot1", "status") == "tracking"
        assert cell(app, "robot1", "error_m") == "-0.250"
        assert cell(app, "robot1", "linear_mps") == "+0.30"
        assert cell(app, "robot1", "wheels") == "driving"
        assert cell(app, "robot2", "status") == "lost"
        assert cell(app, "robot2", "reason") == "no tag in the picture"
        assert cell(app, "robot2", "wheels") == "-"

    with Speaker(
        url,
        ROBOT1_STATUS=status(),
        ROBOT1_OBSERVATION=observation(1.25),
        ROBOT1_COMMAND=command(linear_mps=0.3),
        ROBOT1_BASE=base(1),
        ROBOT2_STATUS=status("lost", "no_tag_found", session=8),
    ):
        on_screen(app, scenario)


def test_without_a_robot_it_says_what_to_look_at(url):
    app = TopApp(url)

    async def scenario(pilot):
        await pilot.pause()
        assert "pilotfish doctor" in detail(app)
        await pilot.press("s")  # nobody to stop, nothing happens
        assert rows(app) == []

    on_screen(app, scenario)


def test_the_detail_pane_has_the_events_of_the_selected_robot_with_times(url):
    app = TopApp(url)

    async def scenario(pilot):
        await until_robots(pilot, app, 2)
        speaker.messages["ROBOT1_STATUS"] = status("coasting", "no_frame")
        await until(pilot, lambda: "coasting: no frame arrived in time" in detail(app), "the event")
        await pilot.press("down")
        await until(pilot, lambda: detail(app).startswith("robot2"), "the other robot")
        assert "no frame" not in detail(app)

    with Speaker(url, ROBOT1_STATUS=status(), ROBOT2_STATUS=status(session=8)) as speaker:
        on_screen(app, scenario)


def test_a_robot_that_falls_silent_stays_in_the_table_and_its_age_rises(url):
    app = TopApp(url)

    async def scenario(pilot):
        with Speaker(url, ROBOT1_STATUS=status()):
            await until(pilot, lambda: rows(app), "the robot")
        await until(pilot, lambda: float(cell(app, "robot1", "age_s")) > 2.1, "two seconds of silence")
        app.show()
        assert app.query_one(DataTable).get_row_at(0)[0].style == "red"

    on_screen(app, scenario)


def test_the_table_is_sorted_by_keys_and_the_selected_robot_stays_selected(url):
    app = TopApp(url)

    async def scenario(pilot):
        await until_robots(pilot, app, 3)
        await pilot.press("down")
        assert app.selected == "b"
        await pilot.press("greater_than_sign")  # by status: lost, searching, tracking
        assert [row[0] for row in rows(app)] == ["c", "a", "b"]
        assert app.selected == "b"
        await pilot.press("R")
        assert [row[0] for row in rows(app)] == ["b", "a", "c"]
        assert app.selected == "b"
        await pilot.press("less_than_sign")
        assert [row[0] for row in rows(app)] == ["c", "b", "a"]  # by name, still reversed

    with Speaker(url, A_STATUS=status("searching"), B_STATUS=status("tracking"), C_STATUS=status("lost")):
        on_screen(app, scenario)


def test_a_robot_that_appears_above_the_selected_one_does_not_take_its_place(url):
    """Else `s` would stop another robot than the one that was chosen."""
    app = TopApp(url)

    async def scenario(pilot):
        await until_robots(pilot, app, 2)
        await pilot.press("down")
        assert app.selected == "c"
        speaker.messages["A_STATUS"] = status()
        await until(pilot, lambda: len(rows(app)) == 3, "the third robot")
        assert app.selected == "c"

    with Speaker(url, B_STATUS=status(), C_STATUS=status()) as speaker:
        on_screen(app, scenario)


def test_a_tick_after_the_widgets_are_gone_ends_nothing(url):
    app = TopApp(url)

    async def scenario(pilot):
        await app.query(DataTable).remove()
        app.show()

    on_screen(app, scenario)


def test_s_stops_the_selected_robot_and_no_other_and_asks_nothing(url):
    app = TopApp(url)

    async def scenario(pilot):
        await until_robots(pilot, app, 2)
        await pilot.press("down", "s")
        await until(pilot, lambda: "the stop is confirmed: stopped" in detail(app), "the confirmation")
        await until(pilot, lambda: cell(app, "robot2", "status") == "stopped", "the status")

    with ScriptedCoordinator(url) as other, ScriptedCoordinator(url, robot="robot2") as stopped:
        on_screen(app, scenario)
    assert other.setpoint.run
    assert not stopped.setpoint.run


def test_a_stop_that_nobody_confirms_is_told(url):
    """The robot ignores it; the operator gives up after a moment."""

    def impatient(robot):
        Operator(robot, lcm_url=url).stop(within_s=0.3)

    app = TopApp(url, stop=impatient)

    async def scenario(pilot):
        await until(pilot, lambda: rows(app), "the robot")
        await pilot.press("s")
        await until(pilot, lambda: "the stop was not confirmed" in detail(app), "the failure")

    with ScriptedCoordinator(url, ignores_setpoints=True):
        on_screen(app, scenario)


def test_the_help_names_every_key_and_column_and_closes(url):
    app = TopApp(url)

    async def scenario(pilot):
        await pilot.press("question_mark")
        await until(pilot, lambda: len(app.screen_stack) == 2, "the help")
        shown = str(app.screen.query_one(Static).render())
        for column in COLUMNS:
            assert column.title in shown and column.help in shown
        await pilot.press("escape")
        await until(pilot, lambda: len(app.screen_stack) == 1, "the table")
        await pilot.press("q")
        await until(pilot, lambda: not app.is_running, "the end")

    on_screen(app, scenario)


def test_it_works_in_80_columns(url):
    app = TopApp(url)

    async def scenario(pilot):
        await until(pilot, lambda: rows(app), "the robot")
        assert "tracking" in detail(app)

    with Speaker(url, ROBOT1_STATUS=status()):
        on_screen(app, scenario, size=(80, 24))


# --- for scripts ------------------------------------------------------------------------------------------------------
def top(url, *arguments):
    words = [sys.executable, "-m", "pilotfish", "top", "--lcm-url", url, *arguments]
    return subprocess.run(words, capture_output=True, text=True, timeout=60, env={**ENVIRONMENT, "COLUMNS": "200"})


ENVIRONMENT = dict(os.environ)


def test_once_prints_one_table_without_textual(url, tmp_path):
    """A package `textual` that cannot be imported stands before the real one."""
    (tmp_path / "textual.py").write_text("raise ImportError('not to be imported')")
    path = f"{tmp_path}:{ENVIRONMENT.get('PYTHONPATH', '')}"
    with Speaker(url, ROBOT1_STATUS=status(), ROBOT1_OBSERVATION=observation(1.25)):
        words = [sys.executable, "-m", "pilotfish", "top", "--lcm-url", url, "--once"]
        environment = {**ENVIRONMENT, "COLUMNS": "200", "PYTHONPATH": path}
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, env=environment)
    assert done.returncode == 0, done.stderr
    head, line = done.stdout.splitlines()
    assert head.split()[:3] == ["robot", "status", "age"]
    assert line.split()[:2] == ["robot1", "tracking"] and "1.250" in line


def printed_on_a_terminal(url, columns):
    """What `top --once` prints on a terminal of that width; lines without colours."""
    main, terminal = pty.openpty()
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    words = [sys.executable, "-m", "pilotfish", "top", "--lcm-url", url, "--once"]
    environment = {name: value for name, value in ENVIRONMENT.items() if name not in ("COLUMNS", "NO_COLOR")}
    with subprocess.Popen(
        words, stdin=terminal, stdout=terminal, stderr=subprocess.PIPE, env=environment | {"TERM": "xterm"}
    ) as running:
        os.close(terminal)
        text = b""
        try:
            while part := os.read(main, 4096):
                text += part
        except OSError:  # EIO: the other end is closed
            pass
        assert running.wait(20) == 0, running.stderr.read()
    os.close(main)
    return [line.rstrip() for line in re.sub(r"\x1b\[[0-9;]*m", "", text.decode()).splitlines()]


@pytest.mark.parametrize("columns", [60, 80, 120, 200])
def test_a_terminal_gets_the_columns_that_fit_with_no_word_broken(url, columns):
    long_name = "R" * 20
    with Speaker(
        url,
        ROBOT1_STATUS=status(),
        ROBOT1_OBSERVATION=observation(1.25),
        **{f"{long_name}_STATUS": status("lost", "no_tag_found")},
    ):
        lines = printed_on_a_terminal(url, columns)
    assert len(lines) == 3  # a heading, and a line for each robot
    assert max(map(len, lines)) <= columns
    titles = {column.title for column in COLUMNS}
    assert set(re.split(r"\s{1,}(?!\[)", lines[0])) <= titles  # "e [m]" is one word
    assert lines[0].split()[:2] == ["robot", "status"]
    assert {line.split()[0] for line in lines[1:]} == {"robot1", long_name.lower()}
    assert ("d [m]" in lines[0]) and (columns < 200 or all(title in lines[0] for title in titles))


def test_a_pipe_gets_every_column_whole_however_narrow_the_terminal(url):
    with Speaker(url, ROBOT1_STATUS=status("lost", "no_tag_found")):
        words = [sys.executable, "-m", "pilotfish", "top", "--lcm-url", url, "--once"]
        done = subprocess.run(words, capture_output=True, text=True, timeout=60, env=ENVIRONMENT | {"COLUMNS": "40"})
    head, line = done.stdout.splitlines()
    assert all(column.title in head for column in COLUMNS)
    assert "no tag in the picture" in line


NO_NAMES = ("../..", "<b>", "a b", "A" * 33, "\x1b]0;owned\x07\x1b[31mred", "robot1", "")


def test_what_can_be_no_robots_name_is_counted_and_not_shown(url):
    with Speaker(url, ROBOT1_STATUS=status(), **{f"{name}_STATUS": status() for name in NO_NAMES}):
        done = top(url, "--once")
        as_json = top(url, "--json")
    assert [line.split()[0] for line in done.stdout.splitlines()] == ["robot", "robot1"]
    assert [robot["robot"] for robot in json.loads(as_json.stdout)] == ["robot1"]
    for each in (done, as_json):
        assert f"heard and not shown: {len(NO_NAMES)} other channels" in each.stderr
        assert "\x1b" not in each.stdout + each.stderr


def test_a_counter_with_control_characters_does_not_reach_the_terminal(url):
    evil = "\x1b]0;owned\x07\x9b31m"
    message = status(**{evil: 1})
    with Speaker(url, ROBOT1_STATUS=message) as speaker:
        counting = threading.Thread(target=count_up, args=(speaker, message))
        counting.start()
        done, as_json = top(url, "--once"), top(url, "--json")
    counting.join()
    assert "\\x1b]0;owned\\x07\\x9b31m" in done.stdout
    assert not set("\x1b\x07\x9b") & set(done.stdout + as_json.stdout)


def count_up(speaker, message):
    """The counter rises as long as it is looked at."""
    for _ in range(200):
        message.rejected[0].count += 1
        if speaker._over.wait(0.05):
            return


def test_json_is_an_array_of_robots_in_si_units(url):
    with Speaker(url, ROBOT1_STATUS=status(), ROBOT1_OBSERVATION=observation(1.25, -0.5), ROBOT2_STATUS=status()):
        done = top(url, "--json")
    assert done.returncode == 0, done.stderr
    first, second = json.loads(done.stdout)
    assert (first["robot"], first["distance_m"], first["bearing_rad"]) == ("robot1", 1.25, -0.5)
    assert (second["robot"], second["distance_m"]) == ("robot2", None)


def test_robots_that_were_asked_for_are_the_only_ones(url):
    with Speaker(url, ROBOT1_STATUS=status(), ROBOT2_STATUS=status()):
        done = top(url, "--json", "robot2")
    assert [robot["robot"] for robot in json.loads(done.stdout)] == ["robot2"]


def test_a_quiet_bus_ends_with_69(url):
    for how in ("--once", "--json"):
        done = top(url, how, "--seconds", "0.2")
        assert done.returncode == 69
        assert "no robot is heard" in done.stderr and "pilotfish doctor" in done.stderr
    assert json.loads(done.stdout) == []


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ([], 64, "no terminal: --once"),
        (["--once", "--seconds", "nan"], 64, "0.1 to 60 s"),
        (["--once", "a b"], 64, "1 to 32 letters"),
        (["--once", "--lcm-url", "nonsense"], 69, "cannot be opened"),
    ],
)
def test_a_wrong_command_line_ends_in_words(url, arguments, code, words):
    done = top(url, *arguments)
    assert done.returncode == code, done.stderr
    assert words in " ".join(done.stderr.replace("│", " ").split())
    assert "Traceback" not in done.stderr


def test_without_textual_the_extra_is_named(url, tmp_path):
    script = "import sys; sys.modules['textual'] = None; sys.argv = ['pilotfish', 'top']\n"
    script += "from pilotfish.cli import main; main()"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60)
    assert done.returncode == 69
    assert "pip install 'pilotfish[top]'" in done.stderr

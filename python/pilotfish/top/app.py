"""The screen of ``pilotfish top``: a table of robots, and below it the events of the selected one."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from itertools import accumulate
from pathlib import Path
from typing import ClassVar

from rich.text import Text
from textual import work
from textual.app import App, ComposeResult
from textual.binding import Binding
from textual.containers import VerticalScroll
from textual.widgets import DataTable, Footer, Header, Static

from pilotfish.errors import PilotfishError
from pilotfish.operating import Operator, describe
from pilotfish.top import CHANNELS
from pilotfish.top.screens import HelpScreen
from pilotfish.watching.columns import COLUMNS, NOT_KNOWN, Column, ordered, style
from pilotfish.watching.feed import Feed, Message
from pilotfish.watching.robots import Robots, RobotState, Row

_REFRESH_S = 0.25
_AT_ONCE = 200  # messages between two looks at the keyboard

Stop = Callable[[str], str]


def stop_robot(url: str, key: Path | None = None) -> Stop:
    """Stops a robot through the operator; the answer is what its status says then."""

    def stop(robot: str) -> str:
        return describe(Operator(robot, lcm_url=url, key_file=key).stop())

    return stop


class TopApp(App[None]):
    """Receives, and sends nothing but the stops that are asked for. ``wall_offset_s``: wall clock less the clock of the
    arrivals, for the times of events."""

    TITLE = "pilotfish top"
    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar = [
        ("q", "quit", "Quit"),
        Binding("ctrl+c", "quit", show=False, priority=True),  # on a terminal whose keys are read it is no signal
        ("s", "stop", "Stop robot"),
        ("less_than_sign,comma", "sort(-1)", "Sort <"),
        ("greater_than_sign,full_stop", "sort(1)", "Sort >"),
        ("R", "reverse", "Reverse"),
        ("question_mark", "help", "Help"),
    ]
    CSS = """
    DataTable { height: 1fr; min-height: 4; }
    DataTable > .datatable--cursor { background: $primary-muted; }
    #events { height: 40%; border-top: solid $accent; padding: 0 1; }
    """

    def __init__(
        self, url: str = "", *, robots: tuple[str, ...] = (), stop: Stop | None = None, wall_offset_s: float = 0.0
    ) -> None:
        super().__init__()
        self.robots = Robots(robots)
        self.feed = Feed(url, self._receive, CHANNELS)
        self._stop = stop or stop_robot(self.feed.url)
        self._wall_offset_s = wall_offset_s
        self.sort_column = 0
        self.reversed = False
        self.sub_title = self.feed.url
        self._shown: list[str] = []

    def compose(self) -> ComposeResult:
        """Robots above, events below."""
        yield Header(icon="")
        yield DataTable(cursor_type="row", zebra_stripes=True, cursor_foreground_priority="renderable")
        with VerticalScroll(id="events"):
            yield Static(id="detail")
        yield Footer()

    def on_mount(self) -> None:
        """Begins to receive."""
        self._name_columns()
        asyncio.get_running_loop().add_reader(self.feed.fileno(), self._read)
        self.set_interval(_REFRESH_S, self.show)
        self.show()

    def on_unmount(self) -> None:
        """The descriptor is the feed's; nobody may wait for it any more."""
        asyncio.get_running_loop().remove_reader(self.feed.fileno())

    # --- the bus
    def _receive(self, message: Message) -> None:
        self.robots.receive(message)

    def _read(self) -> None:
        """The descriptor becomes readable for one message; more may wait behind it."""
        self.feed.handle(0.001)

    # --- the table
    def show(self) -> None:
        """Brings the table and the events up to the moment."""
        if not self.query(DataTable):
            return  # a last tick while the program ends, after its widgets
        now_s = time.monotonic()
        not_shown = self.robots.left_out()
        self.sub_title = f"{self.feed.url}; not shown: {not_shown}" if not_shown else self.feed.url
        rows = ordered(self.robots.rows(now_s), COLUMNS[self.sort_column], self.reversed)
        table = self.query_one(DataTable)
        names = [row.robot for row in rows]
        if names != self._shown:
            self._lay_out(table, rows)
        else:
            for row in rows:
                for column in COLUMNS:
                    table.update_cell(row.robot, column.name, _cell(row, column), update_width=True)
        self.query_one("#detail", Static).update(self._detail(now_s))

    def _lay_out(self, table: DataTable, rows: list[Row]) -> None:
        """New robots or a new order: the selected robot stays selected."""
        selected = self.selected
        table.clear()
        for row in rows:
            table.add_row(*(_cell(row, column) for column in COLUMNS), key=row.robot)
        self._shown = [row.robot for row in rows]
        if selected in self._shown:
            table.move_cursor(row=self._shown.index(selected))

    def _name_columns(self) -> None:
        table = self.query_one(DataTable)
        table.clear(columns=True)
        self._shown = []
        for number, column in enumerate(COLUMNS):
            arrow = (" ▼" if self.reversed else " ▲") if number == self.sort_column else ""
            table.add_column(Text(column.title + arrow, justify="right" if column.right else "left"), key=column.name)

    @property
    def selected(self) -> str | None:
        """The robot under the cursor."""
        row = self.query_one(DataTable).cursor_row
        return self._shown[row] if 0 <= row < len(self._shown) else None

    def _detail(self, now_s: float) -> Text:
        if self.selected is None:
            return Text(
                f"No robot is heard on {self.feed.url}. Is a pilotfish-coordinator running, on this bus? "
                "pilotfish doctor says if the bus works."
            )
        state = self.robots.by_name[self.selected]
        row = state.row(now_s)
        what = " ".join(word for word in (row.status, f"({row.reason})" if row.reason else "") if word)
        head = Text.assemble((f"{state.name}  ", "bold"), what, "\n")
        unseen = "   ".join(f"{column.title}: {column.text(row) or NOT_KNOWN}" for column in self._beyond_the_edge())
        return Text.assemble(
            head, (unseen + "\n" if unseen else "", "dim"), Text("\n").join(_event_lines(state, self._wall_offset_s))
        )

    def _beyond_the_edge(self) -> list[Column]:
        """The columns that a narrow terminal does not show whole; the reason stands behind the status anyway."""
        table = self.query_one(DataTable)
        ends = accumulate(column.get_render_width(table) for column in table.ordered_columns)
        shown = zip(COLUMNS, ends, strict=True)
        return [column for column, end in shown if end > table.size.width and column.name != "reason"]

    # --- keys
    def action_sort(self, by: int) -> None:
        """Sorts by a column further to the right, or left."""
        self._sort_by((self.sort_column + by) % len(COLUMNS))

    def action_reverse(self) -> None:
        """Turns the order around."""
        self.reversed = not self.reversed
        self._sort_by(self.sort_column)

    def on_data_table_header_selected(self, event: DataTable.HeaderSelected) -> None:
        """A click on a title sorts by it; a second one reverses."""
        if event.column_index == self.sort_column:
            self.reversed = not self.reversed
        self._sort_by(event.column_index)

    def _sort_by(self, column: int) -> None:
        selected = self.selected
        self.sort_column = column
        self._name_columns()
        self.show()
        if selected in self._shown:
            self.query_one(DataTable).move_cursor(row=self._shown.index(selected))

    def action_help(self) -> None:
        """Shows keys and columns."""
        self.push_screen(HelpScreen())

    def action_stop(self) -> None:
        """Stops the selected robot; asks nothing."""
        robot = self.selected
        if robot is None:
            self.notify("no robot is selected", severity="warning")
            return
        self._say(robot, "stop is being sent")
        self._send_stop(robot)

    @work(thread=True)
    def _send_stop(self, robot: str) -> None:
        try:
            answer, severity = f"the stop is confirmed: {self._stop(robot)}", "information"
        except PilotfishError as error:
            answer, severity = f"the stop was not confirmed: {error}", "error"
        self.call_from_thread(self._say, robot, answer, severity)

    def _say(self, robot: str, text: str, severity: str = "information") -> None:
        if robot in self.robots.by_name:
            self.robots.by_name[robot].note(time.monotonic(), text)
        self.notify(f"{robot}: {text}", severity=severity, timeout=8.0)  # type: ignore[arg-type]
        self.show()


def _cell(row: Row, column) -> Text:
    return Text(column.text(row), style=style(row, column), justify="right" if column.right else "left")


def _event_lines(state: RobotState, wall_offset_s: float) -> list[Text]:
    lines = []
    for event in reversed(state.events):
        wall_s = event.arrival_s + wall_offset_s
        shown = time.strftime("%H:%M:%S", time.localtime(wall_s)) + f".{int(wall_s % 1 * 1000):03d}"
        lines.append(Text.assemble((shown, "dim"), "  ", event.text))
    return lines

"""The commands of docs/printing-tags.md, one after the other, as they can be copied."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from rasters import run

from pilotfish import data as shipped

PAGE = Path(__file__).parents[2] / "docs" / "printing-tags.md"


def test_every_command_of_the_page_works(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "data").symlink_to(shipped.path("leaders").parent)
    blocks = re.findall(r"```sh\n(.*?)```", PAGE.read_text(), re.S)
    commands = [shlex.split(line)[1:] for block in blocks for line in block.splitlines()]
    assert len(commands) >= 9
    for command in commands:
        result, said = run(*command)
        assert result.exit_code == 0, (command, said)
    for written in ("tags.pdf", "small.pdf", "my_robot.yaml", "three_faces.png", "board.yaml", "chessboard.pdf"):
        assert (tmp_path / written).stat().st_size > 50


def test_the_sizes_that_the_page_names_are_those_that_fit():
    from pilotfish.printing import parse_paper
    from pilotfish.printing.tag_sheets import largest_tag_m

    (a4, letter) = re.search(r"\((\d+) mm on A4, (\d+) mm on Letter\)", PAGE.read_text()).groups()
    assert round(largest_tag_m("tag36h11", 1.0, parse_paper("A4")) * 1e3) == int(a4)
    assert round(largest_tag_m("tag36h11", 1.0, parse_paper("Letter")) * 1e3) == int(letter)

"""A robot on the bus whose window can be recognised by its colours, and where its parts are on the screen."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

import robot_on_bus
from pilotfish.lcmtypes.bot_core import image_t

WIDTH, HEIGHT = 160, 120  # so that it fits into one datagram: lcm-spy itself loses larger ones
PICTURE = (150, 20, 160)  # a colour that nothing else in the window has
OUTLINE = (0xFF, 0xD2, 0x3E)  # of tags; apps/spy/pilotfish/spy/Palette.java
LIT = (0xC7, 0x5A, 0x00)  # of a rule that fires fully
CORNERS_PX = [[50.0, 75.0], [80.0, 75.0], [80.0, 45.0], [50.0, 45.0]]


def plain_picture(utime: int, colour=PICTURE) -> image_t:
    """Raw BGR, with rows that are longer than the picture is wide."""
    message = image_t()
    message.utime, message.width, message.height = utime, WIDTH, HEIGHT
    message.row_stride, message.pixelformat = 3 * WIDTH + 10, image_t.PIXEL_FORMAT_BGR
    row = bytes(colour[::-1]) * WIDTH + bytes(10)
    message.data = row * HEIGHT
    message.size = len(message.data)
    return message


def one_tag(**values):
    """An observation with tag 7 at CORNERS_PX."""
    seen = robot_on_bus.observation(1, **values)
    seen.tags[0].id, seen.tags[0].corners_px = 7, CORNERS_PX
    return seen


def robot(url: str, name: str = "robot1", **messages) -> robot_on_bus.RobotOnBus:
    """Tracking, with one tag in a plain picture; rule 31 (E is PZ, EC is ZE) fires fully."""
    status = robot_on_bus.with_lists(robot_on_bus.status(text="tracking"), strengths={31: 1.0})
    image = plain_picture(robot_on_bus.NOW_US)
    return robot_on_bus.RobotOnBus(
        url, name, **({"STATUS": status, "OBSERVATION": one_tag(), "IMAGE": image} | messages)
    )


class Box(NamedTuple):
    """Of pixels, all inclusive."""

    left: int
    top: int
    right: int
    bottom: int


def box_of(pixels: np.ndarray, colour, *, least: int = 1) -> Box | None:
    """Around all pixels of that colour; rows and columns with fewer than `least` of them do not count."""
    hit = (pixels == colour).all(axis=2)
    columns, rows = np.flatnonzero(hit.sum(axis=0) >= least), np.flatnonzero(hit.sum(axis=1) >= least)
    if not columns.size or not rows.size:
        return None
    return Box(int(columns[0]), int(rows[0]), int(columns[-1]), int(rows[-1]))

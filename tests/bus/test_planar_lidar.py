"""Ranges on the bus: bot_core.planar_lidar_t, checked like everything that comes in."""

import math
import struct

import pytest

from pilotfish import core
from pilotfish.lcmtypes.bot_core import planar_lidar_t


def scan(ranges_m, first_rad=-1.5, step_rad=0.5, utime=7):
    return core.RangeScan(utime=utime, first_rad=first_rad, step_rad=step_rad, ranges_m=ranges_m)


def message(**changes):
    made = planar_lidar_t()
    made.utime, made.ranges, made.rad0, made.radstep = 7, [1.0, 2.5, -1.0], -1.5, 0.5
    made.intensities, made.nintensities = [], 0
    for name, value in changes.items():
        setattr(made, name, value)
    made.nranges = len(made.ranges)
    made.nintensities = len(made.intensities)
    return made


def received(link, data):
    """What the Bus makes of these bytes, and what it counts."""
    seen = []
    link.bus.on_ranges("r1", seen.append)
    link.send("R1_RANGES", data)
    return seen, link.bus.rejected


def test_a_scan_goes_out_as_a_planar_lidar_and_comes_in_as_it_was(link):
    sent = scan([0.5, 2.25, -1.0])
    wire = planar_lidar_t.decode(link.catch("R1_RANGES", lambda: link.bus.publish_ranges("r1", sent)))
    assert (wire.utime, list(wire.ranges), wire.rad0, wire.radstep) == (7, [0.5, 2.25, -1.0], -1.5, 0.5)
    assert wire.nintensities == 0
    assert received(link, wire.encode()) == ([sent], {})


def test_a_laser_with_intensities_is_read(link):
    seen, rejected = received(link, message(ranges=[4.0] * 1440, radstep=0.004, intensities=[9.0] * 1440).encode())
    assert [len(each.ranges_m) for each in seen] == [1440]
    assert rejected == {}


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"ranges": []}, "ranges_too_many"),
        ({"ranges": [1.0] * 1441}, "ranges_too_many"),
        ({"intensities": [1.0] * 1441}, "ranges_too_many"),
        ({"utime": -1}, "ranges_time_invalid"),
        ({"ranges": [1.0, math.nan]}, "ranges_not_finite"),
        ({"ranges": [1.0, math.inf]}, "ranges_not_finite"),
        ({"rad0": math.nan}, "ranges_not_finite"),
        ({"radstep": math.inf}, "ranges_not_finite"),
        ({"ranges": [100.5]}, "ranges_out_of_bounds"),
        ({"ranges": [1.0] * 100, "radstep": 0.1}, "ranges_out_of_bounds"),  # 9.9 rad: more than once around
    ],
)
def test_what_cannot_be_right_is_counted_and_goes_no_further(link, changes, kind):
    assert received(link, message(**changes).encode()) == ([], {kind: 1})


def test_truncated_and_lying_messages_are_refused(link):
    whole = message().encode()
    seen = []
    link.bus.on_ranges("r1", seen.append)
    for size in range(len(whole)):
        link.send("R1_RANGES", whole[:size])
    for count in (-1, 2, 4, 2**31 - 1):  # where 3 readings follow
        link.send("R1_RANGES", whole[:16] + struct.pack(">i", count) + whole[20:])
    link.send("R1_RANGES", whole + b"\0")
    link.send("R1_RANGES", bytes(8) + whole[8:])  # another type's fingerprint
    assert seen == []
    assert sum(link.bus.rejected.values()) == len(whole) + 6
    assert set(link.bus.rejected) == {"ranges_corrupt", "ranges_too_many"}


def test_a_scan_that_is_not_usable_is_not_sent_but_counted(link):
    link.bus.publish_ranges("r1", scan([math.nan]))
    assert link.bus.rejected == {"ranges_not_publishable": 1}

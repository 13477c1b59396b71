"""The numbers of a status are described once; lcmtypes/pilotfish_status_t.lcm, which others read, says the same."""

import re
from pathlib import Path

import pytest

from pilotfish import bus
from pilotfish.lcmtypes.pilotfish import status_t

LCM_FILE = Path(__file__).parents[2] / "lcmtypes" / "pilotfish_status_t.lcm"
FIELD = re.compile(r"^    (\w+)\s+(\w+)((?:\[\w+\])*);$", re.MULTILINE)

# By hand on both sides: what answers what, values of more than one number, and lists.
NO_TABLE_NUMBERS = {
    "utime",
    "status",
    "reason",
    "text",
    "stage_count",
    "stages",
    "rejected_count",
    "rejected",
    "strengths",
}
SETPOINT = {"setpoint_distance_m", "setpoint_bearing_rad", "setpoint_run"}


def test_the_lcm_file_has_the_numbers_of_the_description_with_their_types_in_their_order():
    in_file = [(name, kind) for kind, name, _ in FIELD.findall(LCM_FILE.read_text())]
    assert {name for name, _ in in_file} >= NO_TABLE_NUMBERS | SETPOINT, "the file is not read as it should be"
    described = [(name, kind) for name, kind, _, _ in bus.status_fields()]
    assert described == [row for row in in_file if row[0] not in NO_TABLE_NUMBERS | SETPOINT]
    assert [name for name, _ in in_file] == status_t.__slots__


def test_every_number_of_a_status_goes_out_and_comes_back(link):
    """Each its own, exact in its type: 1.5, 2.5, ... for doubles, the place in the table for the others."""
    report = bus.StatusReport(utime=1)
    values = {}
    for place, (name, kind, _, _) in enumerate(bus.status_fields(), start=1):
        values[name] = {"double": place + 0.5, "boolean": True}.get(kind, place)
        setattr(report, name, values[name])
    data = link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", report))
    message = status_t.decode(data)
    assert {name: getattr(message, name) for name in values} == values
    received = []
    link.bus.on_status("r1", received.append)
    link.send("R1_STATUS", data)
    assert {name: getattr(received[0], name) for name in values} == values


@pytest.mark.parametrize("name", [name for name, kind, _, _ in bus.status_fields() if kind == "double"])
@pytest.mark.parametrize("bad", [float("nan"), float("inf")])
def test_a_number_that_is_not_finite_goes_out_as_zero_and_does_not_come_in(link, name, bad):
    report = bus.StatusReport(utime=1)
    setattr(report, name, bad)
    message = status_t.decode(link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", report)))
    assert getattr(message, name) == 0.0
    received = []
    link.bus.on_status("r1", received.append)
    setattr(message, name, bad)
    link.send("R1_STATUS", message.encode())
    assert received == []
    assert link.bus.rejected["status_not_finite"] == 2  # sent, and received


def test_every_number_says_what_it_is():
    assert all(text for _, _, _, text in bus.status_fields())
    assert bus.StatusReport.error_m.__doc__.endswith("[m]")

"""What a coordinator and the wheels' process say of themselves, out and in."""

import numpy as np
import pytest

from pilotfish import bus, core


@pytest.mark.parametrize("measured", [None, core.Twist(linear_mps=0.25, angular_radps=-0.5)])
def test_what_the_wheels_process_says_survives_both_ways(link, measured):
    report = bus.BaseReport(
        utime=12,
        session=2**62 + 1,
        counter=3,
        monotonic_us=2**61 + 5,
        accepted_session=2**61,
        command=core.Twist(linear_mps=0.125, angular_radps=-1.0),
        measured=measured,
        stopped=True,
        state=bus.BaseReport.State.fault,
        text="the serial line is gone",
        rejected={"command_replayed": 4},
    )
    data = link.catch("R1_BASE", lambda: link.bus.publish_base("r1", report))
    received = []
    link.bus.on_base("r1", received.append)
    link.send("R1_BASE", data)
    (back,) = received
    for field in (
        "utime",
        "session",
        "counter",
        "monotonic_us",
        "accepted_session",
        "command",
        "measured",
        "stopped",
        "state",
        "text",
        "rejected",
    ):
        assert getattr(back, field) == getattr(report, field), field


def test_a_status_survives_both_ways(link):
    report = bus.StatusReport(
        utime=3,
        status=core.Status.lost,
        reason=core.Reason.no_frame,
        error_m=-0.5,
        strengths=np.linspace(0, 1, 57)[1:] // 0.25 / 4,  # exact in single precision
        setpoint=core.Setpoint(distance_m=1.1, bearing_rad=-0.1, run=False),
        rejected={"image_corrupt": 3},
    )
    report.session, report.setpoint_counter, report.missed_deadlines, report.clock_epochs = 2**62 + 1, 2**61, 5, 6
    report.stages = [bus.StageReport(name="vision", counts=range(11), max_ms=12.5)]
    data = link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", report))
    received = []
    link.bus.on_status("r1", received.append)
    link.send("R1_STATUS", data)
    (back,) = received
    fields = "utime status reason error_m strengths session setpoint_counter missed_deadlines clock_epochs rejected"
    for field in fields.split():
        assert getattr(back, field) == getattr(report, field), field
    assert (back.setpoint.distance_m, back.setpoint.bearing_rad, back.setpoint.run) == (1.1, -0.1, False)
    (stage,) = back.stages
    assert (stage.name, stage.counts, stage.max_ms) == ("vision", list(range(11)), 12.5)

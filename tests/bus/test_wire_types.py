"""The types themselves: what other programs rely on, and one datagram for every state message."""

import itertools

import numpy as np
import pytest

from pilotfish import bus, core
from pilotfish.lcmtypes import bot_core
from pilotfish.lcmtypes import pilotfish as types

ONE_DATAGRAM_BYTES = 1400
COUNTER_BYTES = 4 + 24 + 1 + 8  # of the longest: length, name, its end, count

# Made from the names, types and order of the fields. The first four are libbot's, published: a change here
# means that existing viewers and loggers no longer read us. The others are ours: a change means that old logs
# can no longer be read.
FINGERPRINTS = {
    bot_core.image_t: "14739ffe13d5f5f0",
    bot_core.image_metadata_t: "9a4b634d0577fb8e",
    bot_core.pose_t: "2e16efb052b0105e",
    bot_core.planar_lidar_t: "e3d17423180b5e8d",
    types.base_t: "5af1d9a0c5fb41d9",
    types.command_t: "7d8a1997660b07c8",
    types.counter_t: "85bf7873eaa98dd0",
    types.motion_t: "65420622915db3dd",
    types.observation_t: "a8773267d35ca428",
    types.setpoint_t: "3f6bae990fba7acc",
    types.stage_t: "1deddd80d1432c03",
    types.status_t: "7dd0ac6945feed05",
    types.tag_detection_t: "ef8d50b69ab4b284",
    # The black box's.
    types.box_file_t: "4e4221d2ef4c9661",
    types.box_start_t: "a98e56efd1204535",
    types.held_t: "11a6014e4fc98079",
    types.measured_tag_t: "90538cba87c4df6d",
    types.measurement_t: "83fca08184d3e5e6",
    types.sent_t: "05519759646c5271",
    types.step_t: "5e97aab19e0ee7a4",
}


@pytest.mark.parametrize("message_type", FINGERPRINTS, ids=lambda t: t.__name__)
def test_a_types_fingerprint_is_the_published_one(message_type):
    assert f"{message_type().get_hash():016x}" == FINGERPRINTS[message_type]


def test_pixel_formats_are_the_fourcc_codes_of_their_names():
    # libbot's numbers are the four letters, the first in the lowest byte.
    for name, letters in {"GRAY": b"GREY", "RGB": b"RGB3", "BGR": b"BGR3", "MJPEG": b"MJPG"}.items():
        assert getattr(bot_core.image_t, f"PIXEL_FORMAT_{name}") == int.from_bytes(letters, "little")


def longest_words():
    """The status and the reason whose words are longest."""
    reasons = core.Reason.__members__.values()
    return max(core.Status.__members__.values(), key=lambda s: len(s.name)), max(reasons, key=lambda r: len(r.text))


def worst_tag(tag_id):
    return core.TagDetection(id=tag_id, corners_px=np.full((4, 2), 639.5), hamming=2, decision_margin=1e9)


def worst_counters(how_many):
    return {f"{i:02}{'x' * 22}": 2**62 for i in range(how_many)}


def worst_status(counters):
    status, reason = longest_words()
    report = bus.StatusReport(utime=2**62, status=status, reason=reason, rejected=counters)
    report.stages = [bus.StageReport(name="x" * 12, counts=[2**31 - 1] * 11, max_ms=1e9) for _ in range(6)]
    return report


def test_the_longest_state_messages_fit_into_one_datagram(link):
    status, reason = longest_words()
    extreme = 2**62
    observation = core.Observation(utime=extreme, distance_m=20.0, tags=[worst_tag(i) for i in range(12)])
    base = bus.BaseReport(utime=extreme, text="x" * 80, rejected=worst_counters(16))
    encoded = {
        "COMMAND": lambda: link.bus.publish_command(
            "r1", bus.CommandReport(utime=extreme, counter=extreme, status=status, reason=reason)
        ),
        "OBSERVATION": lambda: link.bus.publish_observation(
            "r1", bus.ObservationReport(utime=extreme, observation=observation, reason=reason)
        ),
        "STATUS": lambda: link.bus.publish_status("r1", worst_status(worst_counters(40))),
        "BASE": lambda: link.bus.publish_base("r1", base),
        "SETPOINT": lambda: link.bus.publish_setpoint("r1", bus.SetpointReport(utime=extreme)),
        "MOTION": lambda: link.bus.publish_motion("r1", bus.MotionReport(utime=extreme)),
        "POSE": lambda: link.bus.publish_pose("r1", bus.PoseReport(utime=extreme, x_m=1, y_m=1, heading_rad=1)),
    }
    sizes = {what: len(link.catch(f"R1_{what}", publish)) for what, publish in encoded.items()}
    assert max(sizes.values()) <= ONE_DATAGRAM_BYTES, sizes
    # And the worst case is one: 12 tags of 41 bytes; 56 strengths of 4, 6 stages of 69 and 12 counters of 37 bytes or
    # more; 16 counters and a text.
    assert sizes["OBSERVATION"] > 12 * 41
    assert sizes["STATUS"] > 56 * 4 + 6 * 69 + 12 * COUNTER_BYTES
    assert sizes["BASE"] > 16 * 37 + 80


def catch_status(link, report):
    return types.status_t.decode(link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", report)))


def longest_counters_that_fit(link):
    """As many as the datagram has room for behind the other fields: a new field of a status takes from it."""
    without = len(link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", worst_status({}))))
    return (ONE_DATAGRAM_BYTES - without) // COUNTER_BYTES


def test_as_many_of_the_longest_counters_travel_with_6_stages_as_fit_and_without_stages_24(link):
    fit = longest_counters_that_fit(link)
    assert fit >= 12  # pilotfish_status_t.lcm promises it
    message = catch_status(link, worst_status(worst_counters(fit)))
    assert (len(message.stages), message.rejected_count) == (6, fit)
    assert {c.name: c.count for c in message.rejected} == worst_counters(fit)
    assert catch_status(link, bus.StatusReport(utime=1, rejected=worst_counters(24))).rejected_count == 24


def test_of_more_counters_than_fit_every_one_is_seen_in_its_turn_and_nothing_vanishes(link):
    counters = {f"{i:02}{'x' * 22}": 10**i for i in range(18)}
    seen = {}
    for _ in range(2):  # of 18, 11 at least and "others", then the rest and "others"
        rejected = catch_status(link, worst_status(counters)).rejected
        assert rejected[-1].name == "others"
        assert sum(c.count for c in rejected) == sum(counters.values())
        seen |= {c.name: c.count for c in rejected[:-1]}
    assert seen == counters


def catch_base(link, report):
    return types.base_t.decode(link.catch("R1_BASE", lambda: link.bus.publish_base("r1", report)))


@pytest.mark.parametrize(
    ("report", "catch", "at_most"), [(bus.StatusReport, catch_status, 24), (bus.BaseReport, catch_base, 16)]
)
def test_of_short_names_as_many_travel_as_a_listener_accepts(link, report, catch, at_most):
    """One more than at_most: all but two of them and "others" in one message, those two and "others" in the next."""
    counters = {f"{i:02}": 2**i for i in range(at_most)}
    assert {c.name: c.count for c in catch(link, report(utime=1, rejected=counters)).rejected} == counters
    counters["one more"] = 1
    lists = [catch(link, report(utime=1, rejected=counters)).rejected for _ in range(2)]
    assert sorted(len(rejected) for rejected in lists) == [3, at_most]
    assert {c.name for rejected in lists for c in rejected} == counters.keys() | {"others"}
    assert all(sum(c.count for c in rejected) == 2**at_most for rejected in lists)  # 2^n - 1 and the one


def test_counters_fill_a_datagram_to_the_last_byte_and_no_further(link):
    """A counter takes 13 bytes (length, final zero, count) and its letters. Of those, 14 counters have as many as fill
    the room that the rest of the message leaves; then one more."""

    def sent(letters):
        each, longer = divmod(letters, 14)
        names = [f"{i:02}".ljust(each + (i < longer), "x") for i in range(14)]
        report = worst_status(dict.fromkeys(names, 1))
        data = link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", report))
        return len(data), types.status_t.decode(data).rejected

    rest = len(link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", worst_status({}))))
    letters = ONE_DATAGRAM_BYTES - rest - 14 * 13
    assert 14 * 2 <= letters < 14 * 24
    full, rejected = sent(letters)
    assert (full, len(rejected)) == (ONE_DATAGRAM_BYTES, 14)
    fuller, rejected = sent(letters + 1)
    assert fuller <= ONE_DATAGRAM_BYTES
    assert rejected[-1].name == "others"


def test_more_stages_and_longer_names_than_there_is_room_for_are_cut(link):
    report = worst_status({"y" * 40: 1})
    report.stages = [bus.StageReport(name=f"{i}" * 40) for i in range(8)]
    message = catch_status(link, report)
    assert [stage.name for stage in message.stages] == [f"{i}" * 12 for i in range(6)]
    assert [c.name for c in message.rejected] == ["y" * 24]
    data = link.catch("R1_BASE", lambda: link.bus.publish_base("r1", bus.BaseReport(utime=1, text="x" * 400)))
    assert types.base_t.decode(data).text == "x" * 80


def test_all_tags_of_a_body_fit(link):
    observation = core.Observation(utime=1, distance_m=1.0, tags=[worst_tag(i) for i in range(12)])
    data = link.catch(
        "R1_OBSERVATION",
        lambda: link.bus.publish_observation("r1", bus.ObservationReport(utime=1, observation=observation)),
    )
    assert [tag.id for tag in types.observation_t.decode(data).tags] == list(range(12))


def test_the_numbers_on_the_wire_are_those_of_the_enumerations(link):
    for status, reason in itertools.product(core.Status.__members__.values(), core.Reason.__members__.values()):
        report = bus.CommandReport(utime=1, status=status, reason=reason)
        command = types.command_t.decode(link.catch("R1_COMMAND", lambda r=report: link.bus.publish_command("r1", r)))
        assert command.status == getattr(types.command_t, f"STATUS_{status.name.upper()}")
        assert command.reason == int(reason)
        assert command.text == (f"{status.name}: {reason.text}" if reason.text else status.name)

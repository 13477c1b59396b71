"""The types themselves: what other programs rely on, and one datagram for every state message."""

import itertools

import numpy as np
import pytest

from pilotfish import bus, core
from pilotfish.lcmtypes import bot_core
from pilotfish.lcmtypes import pilotfish as types

ONE_DATAGRAM_BYTES = 1400

# Made from the names, types and order of the fields. The first three are libbot's, published: a change here
# means that existing viewers and loggers no longer read us. The others are ours: a change means that old logs
# can no longer be read.
FINGERPRINTS = {
    bot_core.image_t: "14739ffe13d5f5f0",
    bot_core.image_metadata_t: "9a4b634d0577fb8e",
    bot_core.pose_t: "2e16efb052b0105e",
    types.command_t: "71709ee15ed54a31",
    types.counter_t: "85bf7873eaa98dd0",
    types.motion_t: "65420622915db3dd",
    types.observation_t: "a8773267d35ca428",
    types.setpoint_t: "2e0a14ffa6c018f9",
    types.status_t: "6e731e9ee4922afb",
    types.tag_sighting_t: "ef8d50b69ab4b284",
    # The black box's.
    types.box_file_t: "4e4221d2ef4c9661",
    types.box_start_t: "725a7acb57630f9c",
    types.held_t: "2687693b510791cf",
    types.measured_tag_t: "90538cba87c4df6d",
    types.measurement_t: "ba0247f2265b99f3",
    types.sent_t: "2f14673366e8751d",
    types.step_t: "42555625b48bdc3b",
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
    return core.TagSighting(id=tag_id, corners_px=np.full((4, 2), 639.5), hamming=2, decision_margin=1e9)


def test_the_longest_state_messages_fit_into_one_datagram(link):
    status, reason = longest_words()
    extreme = 2**62
    observation = core.Observation(utime=extreme, distance_m=20.0, tags=[worst_tag(i) for i in range(12)])
    encoded = {
        "COMMAND": lambda: link.bus.publish_command(
            "r1", bus.CommandReport(utime=extreme, counter=extreme, status=status, reason=reason)
        ),
        "OBSERVATION": lambda: link.bus.publish_observation(
            "r1", bus.ObservationReport(utime=extreme, observation=observation, reason=reason)
        ),
        "STATUS": lambda: link.bus.publish_status(
            "r1",
            bus.StatusReport(
                utime=extreme,
                status=status,
                reason=reason,
                rejected={f"{i:02}{'x' * 22}": extreme for i in range(16)},
            ),
        ),
        "SETPOINT": lambda: link.bus.publish_setpoint("r1", core.Setpoint(), utime=extreme),
        "MOTION": lambda: link.bus.publish_motion("r1", bus.MotionReport(utime=extreme)),
        "POSE": lambda: link.bus.publish_pose("r1", bus.PoseReport(utime=extreme, x_m=1, y_m=1, heading_rad=1)),
    }
    sizes = {what: len(link.catch(f"R1_{what}", publish)) for what, publish in encoded.items()}
    assert max(sizes.values()) < ONE_DATAGRAM_BYTES, sizes
    # And the worst case is one: 12 tags of 41 bytes, 56 strengths, 16 counters of 37 bytes.
    assert sizes["OBSERVATION"] > 12 * 41
    assert sizes["STATUS"] > 56 * 8 + 16 * 37


def test_all_tags_of_a_body_fit_and_more_counters_than_the_limit_do_not_make_a_message_longer(link):
    observation = core.Observation(utime=1, distance_m=1.0, tags=[worst_tag(i) for i in range(12)])
    data = link.catch(
        "R1_OBSERVATION",
        lambda: link.bus.publish_observation("r1", bus.ObservationReport(utime=1, observation=observation)),
    )
    assert [tag.id for tag in types.observation_t.decode(data).tags] == list(range(12))

    counters = {f"{i:02}{'x' * 40}": 10**i for i in range(18)}
    data = link.catch("R1_STATUS", lambda: link.bus.publish_status("r1", bus.StatusReport(utime=1, rejected=counters)))
    rejected = types.status_t.decode(data).rejected
    assert [c.name for c in rejected] == [f"{i:02}{'x' * 22}" for i in range(15)] + ["others"]
    assert sum(c.count for c in rejected) == sum(counters.values())  # nothing vanishes


def test_the_numbers_on_the_wire_are_those_of_the_enumerations(link):
    for status, reason in itertools.product(core.Status.__members__.values(), core.Reason.__members__.values()):
        report = bus.CommandReport(utime=1, status=status, reason=reason)
        command = types.command_t.decode(link.catch("R1_COMMAND", lambda r=report: link.bus.publish_command("r1", r)))
        assert command.status == getattr(types.command_t, f"STATUS_{status.name.upper()}")
        assert command.reason == int(reason)
        assert command.text == (f"{status.name}: {reason.text}" if reason.text else status.name)

"""A Bus that listens to everything, and one good message of each kind, to be spoilt."""

from pilotfish.lcmtypes.bot_core import image_metadata_t, image_t, pose_t
from pilotfish.lcmtypes.pilotfish import base_t, command_t, counter_t, motion_t, setpoint_t, stage_t, status_t


def valid_image(**changes):
    message = image_t()
    message.utime = 1
    message.width, message.height, message.row_stride = 20, 16, 20
    message.pixelformat = image_t.PIXEL_FORMAT_GRAY
    message.data = bytes(range(256)) + bytes(64)
    entry = image_metadata_t()
    entry.key, entry.n, entry.value = "Gain", 2, b"12"
    message.nmetadata, message.metadata = 1, [entry]
    for name, value in changes.items():
        setattr(message, name, value)
    if "size" not in changes:
        message.size = len(message.data)
    return message


def valid_setpoint(**changes):
    message = setpoint_t()
    message.mac = bytes(32)
    message.distance_m, message.bearing_rad, message.run = 1.0, 0.1, True
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def valid_command(**changes):
    message = command_t()
    message.mac = bytes(32)
    message.linear_mps, message.angular_radps, message.text = 0.1, 0.2, "tracking"
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def valid_pose(**changes):
    message = pose_t()
    message.utime, message.orientation, message.vel = 1, [1.0, 0.0, 0.0, 0.0], [0.2, 0.0, 0.0]
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def valid_motion(**changes):
    message = motion_t()
    message.utime, message.linear_mps, message.angular_radps = 1, 0.2, -0.1
    for name, value in changes.items():
        setattr(message, name, value)
    return message


def counter(name, count=1):
    message = counter_t()
    message.name, message.count = name, count
    return message


def with_counters(message, changes):
    for name, value in ({"rejected": [counter("image_corrupt")]} | changes).items():
        setattr(message, name, value)
    message.rejected_count = len(message.rejected)
    return message


def valid_status(**changes):
    message = status_t()
    message.setpoint_distance_m, message.text = 1.0, "tracking"
    stage = stage_t()
    stage.name = "vision"
    message.stages, message.stage_count = [stage], 1
    return with_counters(message, changes)


def valid_base(**changes):
    message = base_t()
    message.text, message.mac = "waiting", bytes(32)
    return with_counters(message, changes)


VALID = {
    "IMAGE": valid_image(),
    "R1_SETPOINT": valid_setpoint(),
    "R1_COMMAND": valid_command(),
    "R1_STATUS": valid_status(),
    "R1_BASE": valid_base(),
    "R1_POSE": valid_pose(),
    "R1_MOTION": valid_motion(),
}


class Edge:
    """A Bus that listens to everything it can, and what got through."""

    def __init__(self, link):
        self.link = link
        self.accepted = []
        link.bus.on_image("IMAGE", self.accepted.append)
        link.bus.on_setpoint("r1", self.accepted.append)
        link.bus.on_command("r1", self.accepted.append)
        link.bus.on_status("r1", self.accepted.append)
        link.bus.on_base("r1", self.accepted.append)
        link.bus.on_pose("r1", self.accepted.append)
        link.bus.on_motion("r1", self.accepted.append)

    def refuses(self, channel, data):
        """The kind under which it counted the message."""
        before = dict(self.link.bus.rejected)
        self.link.send(channel, data)
        assert self.accepted == []
        (kind,) = (k for k, n in self.link.bus.rejected.items() if n != before.get(k, 0))
        assert self.link.bus.rejected[kind] == before.get(kind, 0) + 1
        assert len(kind) <= 24  # what a status message has room for
        return kind

    def accepts(self, channel, data):
        self.link.send(channel, data)
        (message,) = self.accepted
        self.accepted.clear()
        return message

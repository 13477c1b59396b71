"""Recorded messages as the core's own values, and values as keys that compare bit for bit."""

from __future__ import annotations

import numpy as np

from pilotfish import blackbox, core
from pilotfish.black_box.bits import bits
from pilotfish.coordinator import ConfigBundle, ConfigOverrides, ConfigText, HeldCommand
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import box_start_t, held_t, measurement_t, step_t

COPY_MARK = "pilotfish_copy"


def bundle_of(start: box_start_t) -> ConfigBundle:
    """The configuration that a start holds: its files, and what the command line said instead."""
    files = [ConfigText(role=file.role, name=file.name, text=bytes(file.data)) for file in start.files]
    said = dict(override.partition("=")[::2] for override in start.overrides)
    return ConfigBundle(files, ConfigOverrides(law=said.get("law"), profile=said.get("profile")))


def held_of(message: held_t) -> HeldCommand:
    """The HeldCommand that a message contains, to the bit."""
    return HeldCommand(
        utime=message.utime,
        command=core.Twist(linear_mps=message.linear_mps, angular_radps=message.angular_radps),
        from_us=message.from_us,
        until_us=message.until_us,
        holding=bool(message.holding),
        run=bool(message.run),
        ever_measured=bool(message.ever_measured),
        turning=bool(message.turning),
    )


def scan_of(message: step_t) -> core.RangeScan:
    """What sonars or a laser measured, to the bit."""
    return core.RangeScan(
        utime=message.utime, first_rad=message.first_rad, step_rad=message.step_rad, ranges_m=list(message.ranges_m)
    )


def observation_of(message: measurement_t) -> core.Observation:
    """ValueError if it cannot be one."""
    other = None
    if message.other_camera_from_leader:
        other = _pose(np.reshape(message.other_camera_from_leader, (3, 4)))
    return core.Observation(
        utime=message.utime,
        distance_m=message.distance_m,
        bearing_rad=message.bearing_rad,
        heading_rad=message.heading_rad,
        covariance=np.array(message.covariance),
        measured=core.RelativeMeasurement(
            distance_m=message.measured_distance_m,
            bearing_rad=message.measured_bearing_rad,
            heading_rad=message.measured_heading_rad,
            covariance=np.array(message.measured_covariance),
        ),
        heading_ambiguity=message.heading_ambiguity,
        cMo=_pose(np.array(message.camera_from_leader)),
        other_cMo=other,
        ambiguity_ratio=message.ambiguity_ratio,
        reprojection_error_px=message.reprojection_error_px,
        min_decision_margin=message.min_decision_margin,
        found_by=core.FoundBy(message.found_by & 0xFF),  # damaged, it may be negative, which no FoundBy can be
        tags=[
            core.TagDetection(
                id=tag.id,
                hamming=tag.hamming,
                decision_margin=tag.decision_margin,
                corners_px=np.array(tag.corners_px),
            )
            for tag in message.tags
        ],
    )


_ORIGINALS = (image_t.PIXEL_FORMAT_MJPEG, image_t.PIXEL_FORMAT_GRAY)


def original_picture(data: bytes) -> image_t | None:
    """The image_t in these bytes, if it holds the pixels vision saw: a JPEG as it came over the bus, or raw ones."""
    if not data.startswith(image_t._get_packed_fingerprint()):
        return None
    message = image_t.decode(data)
    copied = any(extra.key == COPY_MARK for extra in message.metadata)
    return None if copied or message.pixelformat not in _ORIGINALS else message


def frame_of(picture: image_t) -> core.Frame:
    """The frame in an original picture; one that vision refuses if there is none in it."""
    size = {"width": picture.width, "height": picture.height}
    frame = None
    if picture.pixelformat == image_t.PIXEL_FORMAT_MJPEG:
        frame = blackbox.decode_jpeg(bytes(picture.data), **size, utime=picture.utime)
    elif picture.width > 0 and len(picture.data) == picture.width * picture.height:
        pixels = np.frombuffer(bytes(picture.data), np.uint8).reshape(picture.height, picture.width)
        frame = core.Frame(pixels, utime=picture.utime)
    return frame or core.Frame.unchecked(b"", width=0, height=0, stride_bytes=0, utime=picture.utime)


def twist_bits(twist: core.Twist) -> bytes:
    """Speed and turn rate as bytes: equal for the same bits only, NaN included."""
    return bits(twist.linear_mps, twist.angular_radps)


def held_key(held: HeldCommand) -> tuple[object, ...]:
    """All of a HeldCommand, comparable to the bit."""
    flags = (held.holding, held.run, held.ever_measured, held.turning)
    return (held.utime, twist_bits(held.command), held.from_us, held.until_us, *flags)


def observation_key(observation: core.Observation | None) -> tuple[object, ...] | None:
    """All of an Observation, comparable to the bit; None for none."""
    if observation is None:
        return None
    o, m = observation, observation.measured
    scalars = bits(
        *(o.distance_m, o.bearing_rad, o.heading_rad, o.heading_ambiguity, m.distance_m, m.bearing_rad, m.heading_rad),
        *(o.ambiguity_ratio, o.reprojection_error_px, o.min_decision_margin),
    )
    other = None if o.other_cMo is None else o.other_cMo.tobytes()
    tags = tuple((tag.id, tag.hamming, bits(tag.decision_margin), tag.corners_px.tobytes()) for tag in o.tags)
    matrices = (o.covariance.tobytes(), m.covariance.tobytes(), o.cMo.tobytes(), other)
    return (o.utime, scalars, *matrices, o.found_by, tags)


def _pose(upper: np.ndarray) -> np.ndarray:
    return np.vstack([upper, [0.0, 0.0, 0.0, 1.0]])

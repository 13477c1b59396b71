"""Writes the seeds that fuzzers start from: tests/fuzz/corpus/<target>/seed-*. The same files every time.

    PYTHONPATH=build/release/python .venv/bin/python tests/fuzz/make_corpus.py [target ...]

What else lies in those folders was found by libFuzzer and minimised (`fuzz_<target> -merge=1`).
"""

from __future__ import annotations

import io
import random
import struct
import sys
from pathlib import Path

sys.path.append(str(Path(__file__).resolve().parents[2]))  # where the package `bench` is

import numpy as np
from PIL import Image

from bench.common import wire
from pilotfish.lcmtypes.bot_core import image_t, pose_t
from pilotfish.lcmtypes.pilotfish import base_t, command_t, motion_t, setpoint_t, status_t

CORPUS = Path(__file__).parent / "corpus"


def as_it_is(datagram: bytes, sender: int = 0, after_us: int = 0) -> bytes:
    """A record of transport.cpp. Its length is a multiple of four; zeros behind a datagram are payload."""
    datagram += bytes(-len(datagram) % 4)
    return bytes([sender << 5 | after_us, len(datagram) // 4]) + datagram


def made(part: bytes, *, sequence=0, message_bytes, offset, number, fragments, sender=0, after_us=0) -> bytes:
    control = bytes([128 | sender << 5 | after_us])
    return control + struct.pack(">BHHBBB", sequence, message_bytes, offset, number, fragments, len(part)) + part


def three_parts(**more) -> list[bytes]:
    cuts = [(b"A\0" + bytes(10), 0), (b"b" * 20, 10), (b"c" * 5, 30)]
    return [
        made(part, message_bytes=35, offset=offset, number=number, fragments=3, **more)
        for number, (part, offset) in enumerate(cuts)
    ]


def transport() -> list[bytes]:
    first, second, third = three_parts()
    others = three_parts(sender=1, sequence=7)
    overlapping = made(b"d" * 20, message_bytes=35, offset=11, number=1, fragments=3)
    wrapping = made(b"d" * 20, message_bytes=64, offset=0xFFFF, number=1, fragments=3)
    return [
        as_it_is(b"LC02\0\0\0\0A\0hello") + as_it_is(b"LC02\0\0\0\1NOBODY\0hello"),
        as_it_is(b"LC03" + struct.pack(">IIIHH", 0, 64, 0xFFFFFFFF, 1, 3) + bytes(44)),
        as_it_is(b"LC03\0\0") + as_it_is(b"LC04" + bytes(40)) + as_it_is(b""),
        first + second + third,
        third + second + first + third,
        first + others[0] + second + others[1] + third + others[2],
        first + second + second + overlapping + third,
        first + wrapping + second + third,
        first + b"".join(three_parts(sequence=k)[0] for k in range(1, 6)) + second,
        first + as_it_is(b"LC02\0\0\0\0B\0", after_us=31) * 5 + second + third,
        b"".join(made(b"x", message_bytes=9000, offset=2 + 2 * k, number=1, fragments=99) for k in range(60)),
    ]


def pictures() -> list[bytes]:
    def message(pixel_format: int, channels: int) -> bytes:
        picture = image_t()
        picture.utime, picture.width, picture.height, picture.row_stride = 1, 20, 16, 20 * channels
        picture.pixelformat, picture.data = pixel_format, bytes(range(256)) * 4
        picture.data = picture.data[: 20 * 16 * channels]
        picture.size, picture.nmetadata = len(picture.data), 0
        return picture.encode()

    gray = np.arange(32 * 24, dtype=np.uint32).reshape(24, 32).astype(np.uint8)
    formats = [
        (image_t.PIXEL_FORMAT_GRAY, 1),
        (image_t.PIXEL_FORMAT_RGB, 3),
        (image_t.PIXEL_FORMAT_BGR, 3),
    ]
    return [*(message(*layout) for layout in formats), wire.encode_image(gray, utime=1, jpeg=True)]


def jpegs() -> list[bytes]:
    gray = Image.fromarray(np.arange(32 * 24, dtype=np.uint32).reshape(24, 32).astype(np.uint8))
    files = []
    for picture, options in [(gray, {}), (gray, {"progressive": True}), (gray.convert("RGB"), {"quality": 30})]:
        file = io.BytesIO()
        picture.save(file, "JPEG", **options)
        files.append(file.getvalue())
    return files


def images() -> list[bytes]:
    # images.cpp: an even byte, then the message as it is; or 1, utime, format, width, height, stride, data
    header = struct.pack(">BBBBBH", 1, 1, 3, 32, 24, 0)
    raw = struct.pack(">BBBBBH", 1, 1, 0, 20, 16, 20) + bytes(320)
    return [*(b"\0" + message for message in pictures()), *(header + jpeg for jpeg in jpegs()), raw]


def messages() -> list[bytes]:
    setpoint, command, pose, motion, base, status = (
        setpoint_t(),
        command_t(),
        pose_t(),
        motion_t(),
        base_t(),
        status_t(),
    )
    setpoint.distance_m, setpoint.run = 1.0, True
    setpoint.mac = command.mac = base.mac = bytes(32)
    command.linear_mps, command.text = 0.25, "tracking"
    pose.orientation, pose.vel = [1.0, 0.0, 0.0, 0.0], [0.2, 0.0, 0.0]
    motion.linear_mps = 0.2
    base.text, status.text, status.setpoint_distance_m = "waiting", "tracking", 1.0
    whole = [message.encode() for message in (setpoint, command, pose, motion, base, status)]
    # messages.cpp: 0 to 5 and the whole message, or 132 to 137 and what follows the fingerprint
    return [
        *(bytes([k]) + data for k, data in enumerate(whole)),
        *(bytes([132 + k]) + data[8:] for k, data in enumerate(whole)),
        *(bytes([k]) + data[:-1] for k, data in enumerate(whole)),
    ]


def logs() -> list[bytes]:
    def event(channel: bytes, data: bytes, length: int | None = None) -> bytes:
        sizes = struct.pack(">II", len(channel), len(data) if length is None else length)
        return b"\xed\xa1\xda\x01" + bytes(16) + sizes + channel + data

    good = b"".join(event(b"IMAGE", message) for message in pictures()[:1])
    noise = random.Random(1).randbytes(40)
    return [
        good + event(b"OTHER", b"x"),
        good[:-3],
        event(b"IMAGE", b"", 2**31 - 1) + good,
        event(b"IMAGE", b"", 2**32 - 1) + event(b"", b"x") + event(b"A" * 64, b""),
        noise + event(b"IMAGE", noise) + noise + event(b"A", b"\xed\xa1\xda\x01" * 9),
    ]


TARGETS = {"transport": transport, "images": images, "messages": messages, "logs": logs}

if __name__ == "__main__":
    for target in sys.argv[1:] or TARGETS:
        folder = CORPUS / target
        folder.mkdir(parents=True, exist_ok=True)
        for number, data in enumerate(TARGETS[target]()):
            (folder / f"seed-{number:02}").write_bytes(data)

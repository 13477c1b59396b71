"""Datagrams of the bus: whole messages come out, and nothing that is sent ends the server."""

from __future__ import annotations

import random

from bus.datagrams import TWO_DATAGRAMS, Sender, fragment, in_fragments, short
from pilotfish.view.datagrams import MAX_MESSAGE_BYTES, MAX_UNFINISHED, Reassembly
from robot_on_bus import RobotOnBus


def everything(_channel):
    return True


def test_fragments_in_any_order_make_the_message():
    payload = random.Random(1).randbytes(100_000)
    parts = in_fragments(b"ROBOT1_IMAGE", payload, 7_000, sequence=5)
    for seed in range(20):
        random.Random(seed).shuffle(parts)
        reassembly = Reassembly(everything)
        out = [reassembly.take(part, "sender", 0.0) for part in parts]
        assert [message for message in out if message] == [("ROBOT1_IMAGE", payload)]
        assert not reassembly.refused


def test_two_senders_with_one_sequence_number_are_kept_apart():
    one, two = b"1" * 5000, b"2" * 5000
    reassembly, out = Reassembly(everything), []
    pairs = zip(in_fragments(b"A", one, 2000), in_fragments(b"A", two, 2000), strict=True)
    for mine, yours in pairs:
        out += [reassembly.take(mine, "one", 0.0), reassembly.take(yours, "two", 0.0)]
    assert [message[1] for message in out if message] == [one, two]


def test_what_nobody_wants_is_not_held():
    asked = []
    reassembly = Reassembly(lambda channel: asked.append(channel) or False)
    for part in in_fragments(b"OTHER", bytes(5000), 1000):
        assert reassembly.take(part, "sender", 0.0) is None
    assert reassembly.take(short(b"OTHER", b"x"), "sender", 0.0) is None
    assert asked == ["OTHER", "OTHER"]
    assert not reassembly.refused


def test_a_message_with_a_piece_missing_is_given_up_after_a_second():
    reassembly = Reassembly(everything)
    parts = in_fragments(b"A", bytes(5000), 1000)
    for part in parts[:-1]:
        reassembly.take(part, "sender", 0.0)
    reassembly.take(in_fragments(b"B", bytes(50), 30, sequence=1)[0], "sender", 1.5)
    assert reassembly.refused["message_incomplete"] == 1
    assert reassembly.take(parts[-1], "sender", 1.5) is None


def test_unfinished_messages_are_bounded():
    reassembly = Reassembly(everything)
    for sequence in range(1000):
        reassembly.take(in_fragments(b"A", bytes(50_000), 40_000, sequence=sequence)[0], "sender", 0.0)
    assert len(reassembly._unfinished) <= MAX_UNFINISHED


def test_every_malformed_datagram_is_refused_and_counted():
    good = {"message_bytes": 64, "offset": 0, "number": 0, "fragments": 2}
    malformed = [
        b"",
        b"LC",
        b"LC02",
        b"XXXX" + bytes(60),
        short(b"", b"x"),
        short(b"A" * 64, b"x"),
        short("ü".encode(), b"x"),
        b"LC03" + bytes(10),
        *TWO_DATAGRAMS[1:],
        *[
            fragment(b"A\0" + bytes(10), **(good | wrong))
            for wrong in (
                {"fragments": 0},
                {"number": 2},
                {"message_bytes": 0},
                {"message_bytes": MAX_MESSAGE_BYTES + 1},
                {"offset": 60},
                {"offset": 0xFFFFFFFF},
            )
        ],
    ]
    for datagram in malformed:
        reassembly = Reassembly(everything)
        assert reassembly.take(datagram, "sender", 0.0) is None
        assert sum(reassembly.refused.values()) == 1, datagram[:20]


def test_random_datagrams_never_raise():
    rng, reassembly = random.Random(2), Reassembly(everything)
    for k in range(20_000):
        header = rng.choice([b"", b"LC02", b"LC03"])
        datagram = bytearray(header + rng.randbytes(rng.choice([0, 3, 4, 15, 16, 17, 40, 90])))
        if header == b"LC03" and len(datagram) > 20 and rng.random() < 0.7:  # mostly plausible headers
            datagram[4:20] = fragment(
                b"", sequence=rng.randrange(4), message_bytes=rng.randrange(100), offset=rng.randrange(60),
                number=rng.randrange(3), fragments=rng.randrange(4),
            )[4:20]  # fmt: skip
        reassembly.take(bytes(datagram), rng.randrange(3), 0.001 * k)


def test_the_datagrams_that_end_liblcm_do_not_end_the_server(shared):
    sender = Sender(shared.url)
    for datagram in [*TWO_DATAGRAMS, b"", b"LC02", b"LC03" + b"\xff" * 30] * 20:
        sender.socket.sendto(datagram, sender.to)
    sender.socket.close()
    with RobotOnBus(shared.url, "survivor"):
        for _ in range(1000):
            if "survivor" in shared.get("/api/robots")[1]:
                break
    assert "survivor" in shared.get("/api/robots")[1]
    assert shared.child.process.poll() is None

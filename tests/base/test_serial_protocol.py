"""The text on the line to the motor controller, whose side is written here once more, from its description."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st
from motor_controller import checksum, telemetry_line

from pilotfish import base


def parsed(data):
    parser = base.ControllerParser()
    return parser.feed(data), parser.rejected


def test_the_checksum_is_the_published_one():
    # CRC-8 with polynomial 0x07 and start 0 of "123456789": 0xF4 in every catalogue of CRCs.
    assert base.crc8(b"123456789") == 0xF4


@given(st.binary(max_size=100))
def test_the_checksum_is_that_of_the_controllers_side(data):
    assert base.crc8(data) == checksum(data)


def test_a_set_point_is_milliradians_per_second_with_its_number():
    body = b"PFW,7,-1500,2250"
    line = base.set_point_line(sequence=7, left_radps=-1.5, right_radps=2.25)
    assert line == b"$" + body + b"*%02X\r\n" % checksum(body)


@given(st.floats(), st.floats(), st.integers(0, 65535))
def test_whatever_the_speeds_the_line_is_a_line(left, right, sequence):
    line = base.set_point_line(sequence=sequence, left_radps=left, right_radps=right)
    assert len(line) <= base.MAX_LINE
    kind, number, *speeds = line[1 : line.index(b"*")].split(b",")
    assert (kind, int(number), len(speeds)) == (b"PFW", sequence, 2)
    for speed in speeds:
        assert abs(int(speed)) <= 1_000_000


def test_not_a_number_is_sent_as_zero():
    line = base.set_point_line(sequence=1, left_radps=float("nan"), right_radps=float("inf"))
    assert line.startswith(b"$PFW,1,0,0*")


def test_what_the_controller_says_is_read():
    (line,), rejected = parsed(
        telemetry_line(sequence=65535, time_ms=2**32 - 1, left=-(2**31), right=2**31 - 1, faults=9)
    )
    assert (line.sequence, line.time_ms, line.left_ticks, line.right_ticks) == (65535, 2**32 - 1, -(2**31), 2**31 - 1)
    assert line.faults == 9
    assert sum(rejected.values()) == 0


def test_lines_come_in_pieces_of_any_size_and_between_chatter():
    stream = b"boot v1.2\r\n" + b"".join(telemetry_line(sequence=k) for k in range(20)) + b"\r\n\n#"
    for size in (1, 3, 7, 1000):
        parser = base.ControllerParser()
        lines = [line for at in range(0, len(stream), size) for line in parser.feed(stream[at : at + size])]
        assert [line.sequence for line in lines] == list(range(20))


def test_a_line_cut_short_costs_itself_and_not_the_next():
    lines, rejected = parsed(telemetry_line(sequence=1)[:15] + telemetry_line(sequence=2))
    assert [line.sequence for line in lines] == [2]
    assert rejected["cut_short"] == 1


def framed(body):
    return b"$" + body + b"*%02X\r\n" % checksum(body)


@pytest.mark.parametrize(
    "body",
    [
        b"PFE,1,2,3,4",
        b"PFE,1,2,3,4,5,6",
        b"PFE,1,2,3,4,",
        b"PFE,65536,2,3,4,5",
        b"PFE,-1,2,3,4,5",
        b"PFE,1,4294967296,3,4,5",
        b"PFE,1,2,2147483648,4,5",
        b"PFE,1,2,3.5,4,5",
        b"PFE,1,2, 3,4,5",
        b"PFE,1,2,+3,4,5",
        b"PFE,0x1,2,3,4,5",
        b"PFW,1,2,3",
        b"PFX,1,2,3,4,5",
        b"",
    ],
)
def test_a_right_checksum_around_something_else_is_no_line(body):
    lines, rejected = parsed(framed(body))
    assert lines == []
    assert rejected["malformed"] == 1


def test_without_an_end_nothing_grows():
    lines, rejected = parsed(b"$" + b"9" * 10_000 + telemetry_line(sequence=3))
    assert [line.sequence for line in lines] == [3]
    assert rejected["too_long"] == 1


def test_one_or_two_flipped_bits_next_to_each_other_are_always_found():
    good = telemetry_line(sequence=12, time_ms=3456, left=789, right=-12)
    for bit in range(8, 8 * (len(good) - 2)):  # behind the $, before the line's end
        for width in (1, 3):
            bad = bytearray(good)
            for at in (bit + k for k, on in enumerate(bin(width)[2:]) if on == "1"):
                bad[at // 8] ^= 0x80 >> (at % 8)
            assert parsed(bytes(bad))[0] == []


def test_a_hundred_thousand_random_and_damaged_bytes_give_no_line_that_was_not_sent():
    """Random damage passes a checksum of 8 bits once in 256 times, but hardly ever with six numbers in it."""
    rng = random.Random(8)
    parser = base.ControllerParser()
    wrong = 0
    for k in range(3000):
        line = bytearray(telemetry_line(sequence=k, left=7, right=7))
        for _ in range(rng.randint(1, 4)):
            line[rng.randrange(len(line))] = rng.choice(b"$*,0123456789ABCDEFP\r\n\x00\xff-")
        wrong += sum((got.left_ticks, got.right_ticks) != (7, 7) for got in parser.feed(bytes(line)))
    assert parser.feed(rng.randbytes(100_000)) == []
    # A damaged line keeps its shape in about a third of the cases, and 1 in 256 of those gets through: some 4 of 3000.
    assert wrong <= 20


def test_a_line_has_80_characters_at_most_from_the_dollar_to_the_checksum():
    for length, kind in [(80, "malformed"), (81, "too_long")]:
        body = b"9" * (length - len(b"$*HH"))
        lines, rejected = parsed(framed(body))
        assert lines == []
        assert rejected == {"checksum": 0, "malformed": 0, "too_long": 0, "cut_short": 0} | {kind: 1}


@pytest.mark.parametrize("end", [b"\r", b"\n", b"\r\n"])
def test_a_carriage_return_or_a_line_feed_ends_a_line(end):
    lines, rejected = parsed(telemetry_line(sequence=4).rstrip() + end)
    assert [line.sequence for line in lines] == [4]
    assert sum(rejected.values()) == 0


@pytest.mark.parametrize("body", [b"", b"*", b"*0", b"00", b"PFE,1,2,3,4,5"])
def test_a_line_without_a_checksum_is_counted_as_one_with_a_wrong_one(body):
    lines, rejected = parsed(b"$" + body + b"\r\n")
    assert lines == []
    assert rejected == {"checksum": 1, "malformed": 0, "too_long": 0, "cut_short": 0}


@pytest.mark.parametrize("place", [-4, -3])  # before the line's end
@pytest.mark.parametrize(("digit", "other"), [("A", ":"), ("9", "@"), *zip("ABCDEF", "abcdef", strict=True)])
def test_the_digits_of_a_checksum_are_0_to_9_and_capital_a_to_f(place, digit, other):
    """In ASCII : stands behind 9, where a ten would be, and @ before A, where a nine would be."""
    line = next(line for line in map(telemetry_line, range(1000)) if chr(line[place]) == digit)
    bad = bytearray(line)
    bad[place] = ord(other)
    lines, rejected = parsed(bytes(bad))
    assert (lines, rejected["checksum"]) == ([], 1)
    assert len(parsed(line)[0]) == 1


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (0, ""),
        (2, "a motor driver reports an error"),
        (4, "a motor draws too much current"),
        (8, "an encoder does not count"),
        (16, "the supply is too low"),
        (32, "the emergency stop is pressed"),
        (64, "a fault without a name"),
        (32 + 16 + 2, "the emergency stop is pressed"),  # what people can see comes first
        (16 + 4 + 2, "a motor driver reports an error"),
    ],
)
def test_of_the_faults_the_first_is_named(faults, words):
    assert base.first_fault(faults) == words


MS = 1000


def test_a_controller_that_echoes_a_recent_line_hears_us():
    link = base.ControllerLink(timeout_s=0.25)
    assert not link.alive(now_us=0)
    first = link.next_sequence(now_us=0)
    assert not link.alive(now_us=0), "sent is not received"
    link.echoed(first)
    assert link.alive(now_us=250 * MS)
    assert not link.alive(now_us=251 * MS)


def test_one_that_repeats_an_old_echo_does_not():
    link = base.ControllerLink(timeout_s=0.25)
    first = link.next_sequence(now_us=0)
    for k in range(1, 60):
        link.next_sequence(now_us=k * 20 * MS)
        link.echoed(first)
    assert not link.alive(now_us=60 * 20 * MS)


def test_a_number_that_was_never_sent_proves_nothing():
    link = base.ControllerLink(timeout_s=0.25)
    sent = link.next_sequence(now_us=0)
    for number in (sent + 1, sent + 1000, (sent - 1) % 65536, (sent - 2000) % 65536):
        link.echoed(number)
        assert not link.alive(now_us=1)


def test_the_numbers_wrap_around():
    link = base.ControllerLink(timeout_s=0.25)
    for k in range(65536 + 10):
        number = link.next_sequence(now_us=k * MS)
        link.echoed(number)
        assert link.alive(now_us=k * MS)
    assert number == 10


def test_the_newest_line_that_was_echoed_counts_whatever_is_echoed_after_it():
    """Sent at 0 and at 200 ms, echoed in the other order: 200 + 250 ms."""
    link = base.ControllerLink(timeout_s=0.25)
    first, second = link.next_sequence(now_us=0), link.next_sequence(now_us=200 * MS)
    link.echoed(second)
    link.echoed(first)
    assert link.alive(now_us=450 * MS)
    assert not link.alive(now_us=451 * MS)


@pytest.mark.parametrize(("behind", "counts"), [(1023, True), (1024, False), (1025, False)])
def test_of_the_last_1024_lines_an_echo_counts(behind, counts):
    link = base.ControllerLink(timeout_s=5.0)
    first = link.next_sequence(now_us=0)
    for k in range(behind):
        link.next_sequence(now_us=1 + k)
    link.echoed(first)
    assert link.alive(now_us=behind) == counts

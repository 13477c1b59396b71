"""LCM's datagrams put together again: tests/probes/reassembly_probe.cpp, where the tests decide every byte and time.

The probe is built with the release (scripts/build --tests).
"""

import random
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from datagrams import TWO_DATAGRAMS, fragment, in_fragments, short
from hypothesis import given, settings
from hypothesis import strategies as st

RELEASE = Path(__file__).parents[2] / "build" / "release"


@dataclass
class Answer:
    messages: list[tuple[str, int, bytes]] = field(default_factory=list)  # channel, arrival [us], payload
    held: list[tuple[int, int]] = field(default_factory=list)  # bytes, messages
    arrivals: list[int] = field(default_factory=list)
    counts: dict[str, int] = field(default_factory=dict)

    @property
    def payloads(self):
        return [payload for _, _, payload in self.messages]


@pytest.fixture(scope="module")
def probe():
    if not (RELEASE / "build.ninja").exists():
        pytest.skip("needs build/release: run scripts/build --tests")
    build = ["cmake", "--build", RELEASE, "--target", "reassembly_probe"]
    subprocess.run(build, check=True, capture_output=True)  # does nothing if nothing changed
    program = RELEASE / "tests" / "probes" / "reassembly_probe"

    def run(*lines):
        done = subprocess.run([program], input="\n".join(lines), check=True, capture_output=True, text=True)
        answer = Answer()
        for line in done.stdout.splitlines():
            what, *words = line.split(" ")
            if what == "message":
                answer.messages.append((words[0], int(words[1]), bytes.fromhex(words[2])))
            elif what == "held":
                answer.held.append((int(words[0]), int(words[1])))
            elif what == "arrival":
                answer.arrivals.append(int(words[0]))
            else:
                answer.counts[words[0]] = int(words[1])
                assert len(words[0]) <= 24  # what a status message has room for
        return answer

    return run


def arriving(*datagrams, sender=(1, 2), at_us=0, every_us=0):
    return [
        f"datagram {sender[0]} {sender[1]} {at_us + k * every_us} {datagram.hex()}"
        for k, datagram in enumerate(datagrams)
    ]


def payload_of(length, seed=1):
    return random.Random(seed).randbytes(length)


def test_a_short_message_comes_through_with_its_arrival(probe):
    answer = probe("subscribe A", *arriving(short(b"A", b"hello"), short(b"B", b"not for us"), at_us=7))
    assert answer.messages == [("A", 7, b"hello")]
    assert answer.counts == {}


def test_a_message_in_fragments_comes_when_it_is_whole_and_is_as_old_as_its_first(probe):
    payload = payload_of(1000)
    parts = in_fragments(b"A", payload, 300)
    answer = probe("subscribe A", *arriving(*parts[:-1], at_us=50, every_us=10), "held", *arriving(parts[-1], at_us=90))
    assert answer.held == [(300 * 3 - 2, 1)]  # the channel's two bytes are not payload
    assert answer.messages == [("A", 50, payload)]
    assert answer.counts == {}


@settings(max_examples=60, deadline=None, derandomize=True)
@given(data=st.data(), length=st.integers(80, 400), part_bytes=st.integers(5, 80))
@pytest.mark.fault("fragments_lost")
def test_fragments_come_in_any_order(probe, data, length, part_bytes):
    payload = payload_of(length)
    parts = data.draw(st.permutations(in_fragments(b"A", payload, part_bytes)))
    answer = probe("subscribe A", *arriving(*parts), "held")
    assert answer.payloads == [payload]
    assert answer.held == [(0, 0)]
    assert answer.counts == {}


def test_fragments_of_two_senders_and_of_two_messages_do_not_mix(probe):
    payloads = [payload_of(500, seed) for seed in range(4)]
    streams = [
        arriving(*in_fragments(b"A", payload, 100, sequence=k // 2), sender=(9, 1000 + k % 2))
        for k, payload in enumerate(payloads)
    ]
    interleaved = [line for lines in zip(*streams, strict=True) for line in lines]
    assert probe("subscribe A", *interleaved).payloads == payloads


def test_the_sequence_number_may_wrap(probe):
    payloads = [payload_of(200, seed) for seed in range(3)]
    lines = [
        line
        for sequence, payload in zip([2**32 - 1, 0, 1], payloads, strict=True)
        for line in arriving(*in_fragments(b"A", payload, 60, sequence=sequence))
    ]
    assert probe("subscribe A", *lines).payloads == payloads


def test_a_repeated_fragment_changes_nothing(probe):
    payload = payload_of(500)
    parts = in_fragments(b"A", payload, 100)
    for order in ([0, 0, 1, 1, 2, 3, 4, 5], [5, 5, 3, 0, 3, 1, 2, 4]):
        answer = probe("subscribe A", *arriving(*(parts[k] for k in order)))
        assert answer.payloads == [payload]
        assert answer.counts == {"fragment_repeated": 2}


def test_a_fragment_of_a_message_that_is_already_whole_is_late(probe):
    parts = in_fragments(b"A", payload_of(500), 100)
    answer = probe("subscribe A", *arriving(*parts, parts[3]), "held")
    assert (len(answer.messages), answer.counts, answer.held) == (1, {"fragment_late": 1}, [(0, 0)])


def test_bytes_that_are_there_are_never_overwritten(probe):
    parts = in_fragments(b"A", payload_of(500), 100)
    forged = parts[2][:-1] + bytes([parts[2][-1] ^ 1])
    for order in ([0, 1, 2, "forged", 3, 4, 5], [0, 1, 5, 2, "forged", 3, 4], [5, 2, "forged", 0, 1, 3, 4]):
        datagrams = [forged if k == "forged" else parts[k] for k in order]
        answer = probe("subscribe A", *arriving(*datagrams))
        assert answer.messages == []
        assert answer.counts["fragment_overlap"] == 1


def test_another_fragment_0_under_the_same_number_begins_another_message(probe):
    """A sender that always says 0, and lost a fragment of its first picture: the two are not patched together."""
    first, second = payload_of(500, 1), payload_of(500, 2)
    answer = probe("subscribe A", *arriving(*in_fragments(b"A", first, 100)[:-1], *in_fragments(b"A", second, 100)))
    assert answer.payloads == [second]
    assert answer.counts == {"fragment_overlap": 1}


@pytest.mark.fault("fragments_lost")
def test_a_lost_fragment_costs_its_message_and_its_memory_is_given_back(probe):
    lost = in_fragments(b"A", payload_of(500), 100)
    after = in_fragments(b"A", payload_of(300, 2), 100, sequence=1)
    answer = probe(
        "subscribe A", *arriving(*lost[:-1]), "held", *arriving(*after, at_us=1_000_001), "held", *arriving(lost[-1])
    )
    assert answer.payloads == [payload_of(300, 2)]
    assert answer.held == [(498, 1), (0, 0)]  # 98 + 4 x 100; the last part of 2 bytes is the lost one
    assert answer.counts == {"message_incomplete": 1, "fragment_late": 1}


def test_fragments_of_a_channel_nobody_wants_are_never_kept(probe):
    parts = in_fragments(b"B", payload_of(2000), 100)
    answer = probe("subscribe A", *(line for part in parts for line in [*arriving(part), "held"]))
    assert answer.held == [(0, 0)] * len(parts)
    assert answer.counts == {}
    # In another order they are kept until fragment 0 says whose they are.
    answer = probe("subscribe A", *arriving(*parts[1:], parts[0]), "held")
    assert (answer.messages, answer.held, answer.counts) == ([], [(0, 0)], {})


LIMITS = "limits 10000 20000 8 3 1000000"


def test_one_sender_has_few_unfinished_messages_and_loses_its_oldest(probe):
    begun = [in_fragments(b"A", payload_of(300, k), 100, sequence=k) for k in range(5)]
    answer = probe(
        LIMITS,
        "subscribe A",
        *arriving(*(parts[0] for parts in begun)),
        "held",
        *arriving(*(part for parts in begun for part in parts[1:])),
    )
    assert answer.held == [(3 * 98, 3)]
    assert answer.payloads == [payload_of(300, k) for k in (2, 3, 4)]
    assert answer.counts["message_displaced"] == 2


@pytest.mark.parametrize("other", [(2, 1), (0, 1), (1, 2), (1, 0)])
def test_the_messages_of_one_sender_do_not_push_out_those_of_another(probe, other):
    """Senders differ by address or by port; each may have three, and there are eight places."""
    senders = [(1, 1), other]
    begun = [in_fragments(b"A", payload_of(300, k), 100, sequence=k) for k in range(3)]
    lines = [line for sender in senders for parts in begun for line in arriving(parts[0], sender=sender)]
    lines += [line for sender in senders for parts in begun for line in arriving(*parts[1:], sender=sender)]
    answer = probe(LIMITS, "subscribe A", *lines)
    assert answer.payloads == [payload_of(300, k) for k in range(3)] * 2
    assert answer.counts == {}


def test_where_memory_ends_the_oldest_message_makes_room_for_the_newest(probe):
    """Three of 9000 bytes, of which 20 000 hold two."""
    begun = [in_fragments(b"A", payload_of(9000, k), 1000) for k in range(3)]
    lines = [line for k, parts in enumerate(begun) for line in arriving(*parts[:-1], sender=(k, k))]
    lines += [line for k, parts in enumerate(begun) for line in arriving(parts[-1], sender=(k, k))]
    answer = probe(LIMITS, "subscribe A", *lines, "held")
    assert answer.payloads == [payload_of(9000, k) for k in (1, 2)]
    assert answer.counts == {"message_displaced": 1, "fragment_late": 1}
    assert answer.held == [(0, 0)]


def test_many_senders_share_the_places_and_the_oldest_message_goes(probe):
    firsts = [in_fragments(b"A", payload_of(300), 100)[0]] * 100
    lines = [line for k, datagram in enumerate(firsts) for line in arriving(datagram, sender=(k, k))]
    answer = probe(LIMITS, "subscribe A", *lines, "held")
    assert answer.held == [(8 * 98, 8)]
    assert answer.counts == {"message_displaced": 92}


def test_memory_is_bounded_whatever_is_promised_and_however_small_the_parts(probe):
    tiny = [
        fragment(b"x", sequence=k % 3, message_bytes=10000, offset=2 + 2 * (k // 3), number=1, fragments=5000)
        for k in range(3000)
    ]
    answer = probe(LIMITS, "subscribe A", *(line for d in tiny for line in [*arriving(d), "held"]))
    assert max(held for held, _ in answer.held) <= 20000
    assert answer.messages == []


def test_the_two_datagrams_that_crash_liblcm_are_refused(probe):
    for channel in ("X", "Y"):
        answer = probe(f"subscribe {channel}", *arriving(*TWO_DATAGRAMS))
        assert answer.messages == []
        assert answer.counts == {"fragment_out_of_bounds": 1}


GOOD = {"message_bytes": 100, "offset": 50, "number": 1, "fragments": 2}


@pytest.mark.parametrize(
    ("changes", "part", "kind"),
    [
        ({"message_bytes": 2**32 - 1}, b"x", "message_too_large"),
        ({"message_bytes": 32 * 2**20 + 1}, b"x", "message_too_large"),
        ({"offset": 0xFFFFFFFF}, b"x", "fragment_out_of_bounds"),
        ({"offset": 100}, b"x", "fragment_out_of_bounds"),
        ({"offset": 99}, b"xy", "fragment_out_of_bounds"),
        ({"message_bytes": 0, "offset": 0}, b"x", "fragment_out_of_bounds"),
        ({"fragments": 0}, b"x", "fragment_header_bad"),
        ({"fragments": 1}, b"x", "fragment_header_bad"),
        ({"fragments": 101}, b"x", "fragment_header_bad"),  # one of them must be empty
        ({"offset": 0}, b"x", "fragment_header_bad"),  # where number 0 belongs
        ({"number": 0}, b"A\0x", "fragment_header_bad"),
        ({}, b"", "fragment_header_bad"),
        ({"number": 0, "offset": 0}, b"A\0", "fragment_header_bad"),
        ({"number": 0, "offset": 0}, b"no final zero", "datagram_channel_bad"),
        ({"number": 0, "offset": 0}, b"", "datagram_channel_bad"),
        ({"number": 0, "offset": 0}, b"\0x", "datagram_channel_bad"),
        ({"number": 0, "offset": 0}, b"A" * 64 + b"\0x", "datagram_channel_bad"),
    ],
)
def test_a_header_that_contradicts_itself_is_refused(probe, changes, part, kind):
    answer = probe("subscribe A", *arriving(fragment(part, **{**GOOD, **changes})), "held")
    assert (answer.counts, answer.held) == ({kind: 1}, [(0, 0)])


@pytest.mark.parametrize("datagram", [b"", b"LC", b"LC02", b"LC02\0\0\0", b"LC03" + bytes(15), b"LC04" + bytes(60)])
def test_what_is_no_datagram_of_lcm_is_refused(probe, datagram):
    assert probe("subscribe A", *arriving(datagram)).counts == {"datagram_not_lcm": 1}


def test_fragments_that_contradict_each_other_cost_their_message(probe):
    parts = in_fragments(b"A", payload_of(500), 100)
    for changes in ({"message_bytes": 499}, {"fragments": 7}):
        liar = fragment(parts[2][20:], **{"message_bytes": 500, "offset": 198, "number": 2, "fragments": 6, **changes})
        answer = probe("subscribe A", *arriving(*parts[:2], liar, *parts[2:]), "held")
        assert answer.messages == []
        assert answer.counts == {"fragment_mismatch": 1, "fragment_late": 4}
        assert answer.held == [(0, 0)]
    # All bytes are there after two fragments, but three were announced.
    two = [fragment(b"A\0xy", message_bytes=4, offset=0, number=0, fragments=3),
           fragment(b"zz", message_bytes=4, offset=2, number=1, fragments=3)]  # fmt: skip
    assert probe("subscribe A", *arriving(*two)).counts == {"fragment_mismatch": 1}


@settings(max_examples=100, deadline=None, derandomize=True)
@given(
    noise=st.lists(
        st.tuples(
            st.sampled_from([b"LC02", b"LC03", b""]),
            st.binary(max_size=60),
            st.integers(0, 3),
            st.integers(0, 2_000_000),
        ),
        max_size=40,
    )
)
def test_random_bytes_never_become_a_message_of_a_channel_nobody_wants(probe, noise):
    lines = [
        line for magic, rest, port, at_us in noise for line in arriving(magic + rest, sender=(1, port), at_us=at_us)
    ]
    answer = probe(LIMITS, "subscribe A", *lines, "held")
    assert all(channel == "A" for channel, _, _ in answer.messages)
    assert answer.held[0][0] <= 20000


def test_a_message_is_as_old_as_it_waited_in_the_kernel(probe):
    # The wall clock shows the monotonic one plus 1000; nothing waited at 500. Arguments: stamp, then both clocks
    # when nothing waited, and both clocks now.
    def arrival(stamp_us, now_us=900_000, wall_us=901_000):
        (at_us,) = probe(f"arrival {stamp_us} 500 1500 {now_us} {wall_us}").arrivals
        return at_us

    assert arrival(801_000) == 800_000
    assert arrival(901_000) == 900_000
    assert arrival(950_000) == 900_000  # of the future: now
    assert arrival(0) == 500  # not before the instant at which nothing waited
    assert arrival(1_000, now_us=400, wall_us=1_400) == 400  # asked about an instant before that: now
    # The wall clock was set since (an hour back, an hour on): the oldest arrival that is possible.
    for step_us in (-3_600_000_000, 3_600_000_000, -2_001, 2_001):
        assert arrival(801_000, wall_us=901_000 + step_us) == 500
    assert arrival(801_000, wall_us=901_000 + 1_999) == 798_001  # no step, so the wait is accepted

"""What comes over the wire itself, over real multicast: crafted datagrams, floods, other senders, times of arrival."""

import contextlib
import os
import random
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from bus_link import PATIENCE_S, Link
from datagrams import TWO_DATAGRAMS, Sender, in_fragments, short
from edge import valid_command, valid_image, valid_setpoint

from bench.common import wire
from fuzzy.compiled import compile_program, pkg_config
from pilotfish import bus, core

NO_MAC = bytes(32)
ROUTE = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo"


@pytest.fixture
def sender(url):
    sender = Sender(url)
    yield sender
    sender.close()


def handle_until(link, condition):
    give_up = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < give_up, link.bus.rejected
        link.bus.handle(20)


def setpoints_of(link):
    """The distances that get through to the Bus's handler."""
    received = []
    link.bus.on_setpoint("r1", lambda setpoint: received.append(setpoint.setpoint.distance_m))
    return received


def still_answers(link, received):
    """Whatever came before: a good setpoint gets through."""
    link.lcm.publish("R1_SETPOINT", valid_setpoint(distance_m=1.25, mac=NO_MAC).encode())
    handle_until(link, lambda: 1.25 in received)


RECEIVE_WITH_LIBLCM = """
#include <lcm/lcm.h>
#include <cstdio>
int main(int, char** arguments) {
  lcm_t* receiver = lcm_create(arguments[1]);
  lcm_subscribe(receiver, "X", [](const lcm_recv_buf_t*, const char*, void*) {}, nullptr);
  std::puts("listens");
  std::fflush(stdout);
  while (lcm_handle(receiver) == 0) {}
}
"""


def test_two_datagrams_do_not_end_the_bus(link, sender):
    received = setpoints_of(link)
    link.bus.on_image("X", received.append)  # so that its fragments are looked at
    for _ in range(50):
        sender.send(*TWO_DATAGRAMS)
    still_answers(link, received)
    assert link.bus.rejected == {"fragment_out_of_bounds": 50, "fragment_repeated": 49}


def test_the_two_datagrams_are_the_ones_that_end_a_receiver_of_liblcm(tmp_path, url, sender):
    """The positive control: without it the tests above would pass with any 64 bytes."""
    source = tmp_path / "receiver.cpp"
    source.write_text(RECEIVE_WITH_LIBLCM)
    receiver = compile_program(tmp_path, [source], *pkg_config("lcm"))
    with subprocess.Popen([receiver, url], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout.readline() == "listens\n"
        give_up = time.monotonic() + PATIENCE_S
        while child.poll() is None and time.monotonic() < give_up:
            sender.send(*TWO_DATAGRAMS)
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.wait(0.05)
        survived = child.poll() is None
        child.kill()
    if survived:
        pytest.skip("this liblcm survives them: it is a newer one than 1.3.1")
    assert child.returncode < 0  # a signal


def test_random_bytes_to_the_port_are_counted_and_nothing_else(link, sender):
    received = setpoints_of(link)
    link.bus.on_image("IMAGE", received.append)
    rng = random.Random(3)
    for k in range(2000):
        magic = (b"", b"LC02", b"LC03")[k % 3]
        sender.send(magic + rng.randbytes(rng.randrange(200)))
        if k % 100 == 0:
            link.bus.handle(0)
    still_answers(link, received)
    assert received == [1.25]
    assert sum(link.bus.rejected.values()) > 1000
    assert len(link.bus.rejected) <= 15


def test_a_datagram_without_a_byte_is_counted_and_hides_nothing_behind_it(link, sender):
    received = setpoints_of(link)
    link.bus.on_image("IMAGE", received.append)  # else the kernel drops it
    link.bus.handle(0)
    good = short(b"R1_SETPOINT", valid_setpoint(distance_m=1.25, mac=NO_MAC).encode())
    sender.send(b"", good)
    assert link.bus.handle(1000) == 1  # in one call
    assert (received, link.bus.rejected) == ([1.25], {"datagram_not_lcm": 1})


def test_an_image_in_fragments_comes_through_in_any_order_and_once(link, sender):
    received = []
    link.bus.on_image("IMAGE", received.append)
    image = np.random.default_rng(1).integers(0, 256, (120, 160), dtype=np.uint8)
    parts = in_fragments(b"IMAGE", wire.encode_image(image, utime=5), 1000)
    random.Random(1).shuffle(parts)
    sender.send(*parts, parts[3])
    handle_until(link, lambda: received and link.bus.rejected)
    assert len(received) == 1
    np.testing.assert_array_equal(received[0].image, image)
    assert link.bus.rejected == {"fragment_late": 1}


def test_fragments_of_two_senders_interleaved_make_two_images(url, link, sender):
    other = Sender(url)
    received = []
    link.bus.on_image("IMAGE", lambda frame: received.append(int(frame.image[0, 0])))
    streams = [
        in_fragments(b"IMAGE", wire.encode_image(np.full((120, 160), level, np.uint8), utime=5), 1000)
        for level in (10, 20)
    ]
    for ours, theirs in zip(*streams, strict=True):
        sender.send(ours)
        other.send(theirs)
    other.close()
    handle_until(link, lambda: len(received) == 2)
    assert received == [10, 20]
    assert link.bus.rejected == {}


def test_a_lost_fragment_costs_one_image(link, sender):
    received = []
    link.bus.on_image("IMAGE", lambda frame: received.append(frame.utime))
    for utime in range(3):
        data = wire.encode_image(np.zeros((120, 160), np.uint8), utime=utime)
        parts = in_fragments(b"IMAGE", data, 1000, sequence=utime)
        sender.send(*(parts[:7] + parts[8:] if utime == 1 else parts))
    handle_until(link, lambda: len(received) == 2)
    assert received == [0, 2]


def test_a_bus_without_images_has_fragments_dropped_by_the_kernel(link, sender):
    received = setpoints_of(link)
    for _ in range(100):
        sender.send(*TWO_DATAGRAMS)
    still_answers(link, received)
    assert link.bus.rejected == {}  # not one of them got as far as being refused


def test_one_call_takes_a_bounded_part_of_a_flood(url):
    link = Link(url)
    counters = []
    link.bus.on_command("r1", lambda report: counters.append(report.counter))
    link.bus.handle(0)
    sender = Sender(url)
    flood = short(b"R1_COMMAND", valid_command(mac=NO_MAC).encode())
    sender.send(*[flood] * 1500)
    sender.close()
    assert link.bus.handle(1000) == 1000
    assert link.bus.handle(1000) == 500


def test_a_flood_on_another_channel_ends_the_wait_in_time_and_hides_no_message_behind_it(link, sender):
    received = setpoints_of(link)
    flood = short(b"SOMEBODY_ELSE", bytes(100))
    sender.send(*[flood] * 1200)
    link.lcm.publish("R1_SETPOINT", valid_setpoint(distance_m=1.25, mac=NO_MAC).encode())
    assert link.bus.handle(1000) == 0  # 1000 datagrams, none for us: the caller gets its turn
    assert link.bus.handle(1000) == 1
    assert received == [1.25]
    assert link.bus.rejected == {}


def test_what_does_not_fit_into_the_sockets_buffer_is_counted(url, sender):
    link = Link(url.partition("?")[0] + "?ttl=0&recv_buf_size=65536")
    received = []
    link.bus.on_image("IMAGE", received.append)
    link.bus.on_command("r1", received.append)
    sender.send(*[short(b"R1_COMMAND", valid_command(mac=NO_MAC).encode())] * 2000)
    while link.bus.handle(0):
        pass
    sender.send(short(b"R1_COMMAND", valid_command(mac=NO_MAC).encode()))  # brings the kernel's number with it
    assert link.bus.handle(1000) == 1
    assert len(received) + link.bus.rejected["receive_buffer_full"] == 2001
    assert len(received) < 2000


FOREIGN = """
import socket, sys
from datagrams import Sender, short
from edge import valid_setpoint
from pilotfish import bus
url = "udpm://239.255.76.67:7667?ttl=" + sys.argv[1]
link = bus.Bus(url)
received = []
link.on_setpoint("r1", lambda setpoint: received.append(setpoint.setpoint.distance_m))
link.handle(0)
for address, distance_m in [("10.9.8.7", 1.25), ("127.0.0.1", 1.5)]:
    sender = Sender(url)
    sender.socket.setsockopt(socket.SOL_IP, 19, 1)  # IP_TRANSPARENT: an address that is not this host's
    sender.socket.setsockopt(socket.SOL_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
    sender.socket.bind((address, 0))
    sender.send(short(b"R1_SETPOINT", valid_setpoint(distance_m=distance_m, mac=bytes(32)).encode()))
while 1.5 not in received:
    assert link.handle(5000)
print(received, link.rejected)
"""


@pytest.mark.parametrize(
    ("ttl", "says"), [(0, "[1.5] {'datagram_foreign': 1}"), (1, "[1.25, 1.5] {}")], ids=["this host", "network"]
)
def test_what_another_host_sends_is_dropped_where_the_bus_is_this_host_alone(own_network, ttl, says):
    done = subprocess.run(
        [*own_network, "sh", "-c", f'{ROUTE} && exec "$@"', "sh", sys.executable, "-c", FOREIGN, str(ttl)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(Path(__file__).parent), *sys.path])},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stdout.strip() == says, done.stderr


def arrival_of_one_that_waits(link, arrivals, channel, data):
    """Its arrival, and when it was sent; it waits unread for 30 ms, as it would while this process is stopped."""
    arrivals.clear()
    link.bus.handle(0)
    idle_us = (
        core.monotonic_now_us() + 5_000
    )  # since then nothing has waited: who does not know an arrival says that instant
    while core.monotonic_now_us() < idle_us:
        pass
    before = core.monotonic_now_us()
    link.lcm.publish(channel, data)
    after = core.monotonic_now_us()
    while core.monotonic_now_us() < after + 30_000:
        pass
    handle_until(link, lambda: arrivals)
    (arrival,) = arrivals
    assert arrival <= after + CLOCKS_APART_US  # never younger than it is
    return arrival - before


CLOCKS_APART_US = 100  # the wall clock and the monotonic one are not read at the same instant


@pytest.mark.parametrize(
    ("channel", "data"), [("R1_SETPOINT", valid_setpoint(mac=NO_MAC).encode()), ("IMAGE", valid_image().encode())]
)
def test_a_message_is_as_old_as_it_is_even_if_it_waited_in_the_kernel(link, channel, data):
    arrivals = []
    link.bus.on_setpoint("r1", lambda _: arrivals.append(link.bus.arrival_us))
    link.bus.on_encoded_image("IMAGE", lambda image: arrivals.append(image.arrival_us))
    # The kernel begins to stamp a moment after the first socket asks for it; until then a message counts as older.
    give_up = time.monotonic() + PATIENCE_S
    while arrival_of_one_that_waits(link, arrivals, channel, data) < -CLOCKS_APART_US:
        assert time.monotonic() < give_up
    assert arrival_of_one_that_waits(link, arrivals, channel, data) >= -CLOCKS_APART_US


def test_inside_a_process_too_a_message_is_as_old_as_it_is():
    local = bus.Bus("memq://")
    arrivals = []
    local.on_setpoint("r1", lambda _: arrivals.append(local.arrival_us))
    before = core.monotonic_now_us()
    local.publish_setpoint("r1", bus.SetpointReport(utime=1, session=1, counter=1, setpoint=core.Setpoint()))
    after = core.monotonic_now_us()
    while core.monotonic_now_us() < after + 20_000:
        pass
    assert local.handle(1000) == 1
    assert before - 1100 <= arrivals[0] <= after + 1100  # liblcm's stamp is that of the wall clock


def test_an_encoded_image_is_not_decoded_until_somebody_asks(link):
    received = []
    link.bus.on_encoded_image("IMAGE", received.append)
    image = np.random.default_rng(1).integers(0, 256, (480, 640), dtype=np.uint8)
    link.bus.publish_image("IMAGE", core.Frame(image, utime=7))
    handle_until(link, lambda: received)
    (encoded,) = received
    assert (encoded.utime, encoded.width, encoded.height) == (7, 640, 480)
    np.testing.assert_array_equal(bus.decode(encoded).image, image)
    np.testing.assert_array_equal(bus.decode(encoded, expected_size=(640, 480)).image, image)
    with pytest.raises(ValueError, match="image_size_unexpected"):
        bus.decode(encoded, expected_size=(640, 481))


def test_a_damaged_jpeg_passes_as_encoded_and_is_refused_when_it_is_decoded(edge):
    encoded = []
    edge.link.bus.on_encoded_image("IMAGE2", encoded.append)
    data = wire.encode_image(np.zeros((48, 64), np.uint8), utime=7, jpeg=True)
    damaged = valid_image(
        pixelformat=wire.decode_image(data) and 1196444237, width=64, height=48, data=b"junk"
    ).encode()
    edge.link.send("IMAGE2", damaged)
    with pytest.raises(ValueError, match="image_jpeg_refused"):
        bus.decode(encoded[0])
    assert edge.link.bus.rejected == {}


@pytest.mark.parametrize(
    ("changes", "kind"),
    [
        ({"width": 0}, "image_size_mismatch"),
        ({"width": 16385}, "image_too_large"),
        ({"row_stride": 19}, "image_size_mismatch"),
        ({"pixelformat": 0}, "image_format_unknown"),
        ({"utime": -1}, "image_time_invalid"),
    ],
)
def test_a_header_that_contradicts_itself_is_refused_without_decoding(edge, changes, kind):
    edge.link.bus.on_encoded_image("IMAGE2", edge.accepted.append)
    assert edge.refuses("IMAGE2", valid_image(**changes).encode()) == kind
    edge.accepts("IMAGE2", valid_image().encode())


def test_own_messages_come_back_as_liblcm_has_it(link):
    received = setpoints_of(link)
    report = bus.SetpointReport(utime=1, session=1, counter=1, setpoint=core.Setpoint(distance_m=0.75))
    link.bus.publish_setpoint("r1", report)
    handle_until(link, lambda: received)
    assert received == [0.75]

"""A key, its file, and the MAC made with it: by Python's own hmac as the independent oracle."""

import hashlib
import hmac
import os

import pytest
from edge import valid_base, valid_command, valid_setpoint
from hypothesis import given
from hypothesis import strategies as st

from pilotfish import bus, core
from pilotfish.lcmtypes.pilotfish import base_t, command_t, setpoint_t

KEY_HEX = "00112233445566778899aabbccddeeff" * 2


def write_key(path, text=KEY_HEX + "\n", mode=0o600):
    path.write_bytes(text.encode())
    path.chmod(mode)
    return str(path)


@pytest.fixture
def key(tmp_path):
    return bus.load_key(write_key(tmp_path / "key"))


def oracle_mac(channel, encoded):
    """crypto_auth is HMAC-SHA-512 cut off after 32 bytes (libsodium's manual)."""
    signed = channel.encode() + b"\0" + encoded[:-32] + bytes(32)
    return hmac.new(bytes.fromhex(KEY_HEX), signed, hashlib.sha512).digest()[:32]


@given(channel=st.text("ABCXYZ_019", min_size=1, max_size=63), encoded=st.binary(min_size=32, max_size=400))
def test_the_mac_is_what_every_language_with_an_hmac_can_make(tmp_path_factory, channel, encoded):
    key = bus.load_key(write_key(tmp_path_factory.mktemp("key") / "key"))
    assert bus.message_mac(key, channel, encoded) == oracle_mac(channel, encoded)


@pytest.mark.parametrize("text", [KEY_HEX, KEY_HEX + "\n", KEY_HEX + "\r\n", KEY_HEX.upper()])
def test_a_key_file_holds_64_hex_digits_and_perhaps_a_line_end(tmp_path, text):
    key = bus.load_key(write_key(tmp_path / "key", text))
    assert bus.message_mac(key, "C", bytes(32)) == oracle_mac("C", bytes(32))


@pytest.mark.parametrize(
    "text", ["", KEY_HEX[:-1], KEY_HEX + "0", KEY_HEX + "\n\n", "g" + KEY_HEX[1:], " " + KEY_HEX, KEY_HEX[:40] + "\n"]
)
def test_a_key_file_that_holds_anything_else_is_refused(tmp_path, text):
    with pytest.raises(ValueError, match=r"key_file: .* must hold 64 hex digits and nothing else"):
        bus.load_key(write_key(tmp_path / "key", text))


def test_a_key_of_zeros_is_refused_because_anyone_would_guess_it(tmp_path):
    with pytest.raises(ValueError, match=r"key_file: .*key holds zeros only, .*; make a key with pilotfish key new"):
        bus.load_key(write_key(tmp_path / "key", "0" * 64))
    bus.load_key(write_key(tmp_path / "other", "0" * 63 + "1"))


@pytest.mark.parametrize("mode", [0o640, 0o604, 0o644, 0o620, 0o601])
def test_a_key_file_that_others_may_use_is_refused_saying_what_to_do(tmp_path, mode):
    with pytest.raises(ValueError, match=r"key_file: .*chmod 600"):
        bus.load_key(write_key(tmp_path / "key", mode=mode))


@pytest.mark.parametrize("kind", ["missing", "folder", "pipe", "device"])
def test_what_is_no_key_file_is_refused_without_waiting(tmp_path, kind):
    path = tmp_path / "key"
    if kind == "folder":
        path.mkdir(mode=0o700)
    elif kind == "pipe":
        os.mkfifo(path, 0o600)
    elif kind == "device":
        path = "/dev/zero"
    with pytest.raises(ValueError, match="key_file: "):
        bus.load_key(str(path))


def test_sessions_are_positive_and_never_drawn_twice():
    drawn = [bus.new_session_id() for _ in range(10_000)]
    assert min(drawn) > 0
    assert len(set(drawn)) == len(drawn)  # by chance: 10^8 / 2 pairs out of 2^63, once in 2 * 10^11 runs
    assert max(drawn) > 2**62  # each bit is drawn: all below it, once in 2^10000


def signed(channel, message):
    message.mac = oracle_mac(channel, message.encode())
    return message.encode()


def test_with_a_key_commands_setpoints_and_the_bases_reports_go_out_with_a_mac(link, key):
    link.bus.set_key(key)
    data = link.catch("R1_COMMAND", lambda: link.bus.publish_command("r1", bus.CommandReport(utime=1, counter=2)))
    assert command_t.decode(data).mac == oracle_mac("R1_COMMAND", data)
    data = link.catch("R1_SETPOINT", lambda: link.bus.publish_setpoint("r1", bus.SetpointReport(utime=1)))
    assert setpoint_t.decode(data).mac == oracle_mac("R1_SETPOINT", data)
    data = link.catch("R1_BASE", lambda: link.bus.publish_base("r1", bus.BaseReport(utime=1, rejected={"a": 1})))
    assert base_t.decode(data).mac == oracle_mac("R1_BASE", data)


def test_with_a_key_only_what_was_made_with_it_for_this_channel_comes_in(edge, key):
    edge.link.bus.set_key(key)
    for kind, message in (("command", valid_command()), ("setpoint", valid_setpoint()), ("base", valid_base())):
        channel = f"R1_{kind.upper()}"
        edge.accepts(channel, signed(channel, message))
        assert edge.refuses(channel, signed(f"R2_{kind.upper()}", message)) == f"{kind}_mac_wrong"
        message.mac = bytes(32)
        assert edge.refuses(channel, message.encode()) == f"{kind}_mac_wrong"


def test_no_bit_of_a_signed_message_can_be_flipped(edge, key):
    edge.link.bus.set_key(key)
    data = signed("R1_COMMAND", valid_command(session=5, counter=6))
    for bit in range(8 * len(data)):
        flipped = bytearray(data)
        flipped[bit // 8] ^= 1 << bit % 8
        assert edge.refuses("R1_COMMAND", bytes(flipped)) in ("command_mac_wrong", "command_corrupt")


@pytest.mark.parametrize(
    "changes", [{}, {"distance_m": float("nan")}, {"bearing_rad": 4.0}, {"distance_m": 0.0}, {"mac": b"x" * 32}]
)
@pytest.mark.parametrize("with_key", [False, True])
def test_a_stop_is_accepted_from_anyone_but_nothing_else_in_it(edge, key, with_key, changes):
    if with_key:
        edge.link.bus.set_key(key)
    stop = valid_setpoint(**({"run": False, "session": 5, "counter": 6} | changes))
    report = edge.accepts("R1_SETPOINT", stop.encode())
    assert not report.setpoint.run
    trusted = not with_key and set(changes) <= {"mac"}
    assert (report.session, report.counter) == ((5, 6) if trusted else (0, 0))
    assert report.setpoint.distance_m == 1.0  # what it asks for, or a default: never NaN, never out of bounds
    assert sum(edge.link.bus.rejected.values()) == (0 if trusted else 1)  # and what is wrong with it is counted


@pytest.mark.parametrize("with_key", [False, True])
def test_a_stop_without_its_mac_as_pythons_lcm_sends_it_is_accepted_and_nothing_else_is(edge, key, with_key):
    if with_key:
        edge.link.bus.set_key(key)
    stop = valid_setpoint(run=False, session=5, counter=6, distance_m=2.0, mac=b"")
    report = edge.accepts("R1_SETPOINT", stop.encode())
    assert (report.session, report.counter, report.setpoint.run, report.setpoint.distance_m) == (0, 0, False, 1.0)
    stop.run = True
    assert edge.refuses("R1_SETPOINT", stop.encode()) == "setpoint_corrupt"


def test_a_signed_stop_is_accepted_in_all_it_says(edge, key):
    edge.link.bus.set_key(key)
    stop = signed("R1_SETPOINT", valid_setpoint(run=False, session=5, counter=6, distance_m=2.0))
    report = edge.accepts("R1_SETPOINT", stop)
    assert (report.session, report.counter, report.setpoint.run, report.setpoint.distance_m) == (5, 6, False, 2.0)


def test_a_command_between_two_buses_with_one_key_arrives(url, key):
    sender, receiver = bus.Bus(url), bus.Bus(url)
    received = []
    receiver.on_command("r1", received.append)
    for each in (sender, receiver):
        each.set_key(key)
    report = bus.CommandReport(utime=1, session=2, counter=3, command=core.Twist(linear_mps=0.5))
    sender.publish_command("r1", report)
    assert receiver.handle(5000) == 1
    assert received[0].command == report.command

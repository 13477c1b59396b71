"""Each check on a machine made of a few files: what it finds, and that it says what to do."""

import resource
import subprocess
from pathlib import Path

import pytest

from pilotfish.doctor import Host, Verdict, bus_checks, devices, network, programs, system
from pilotfish.errors import ExecutableNotFoundError
from pilotfish.lcmtypes.pilotfish.command_t import command_t

# /proc/net/route: addresses as hexadecimal of the four bytes read as a little-endian number. 224.0.0.0/4 -> 000000E0
# with mask 000000F0; 239.255.76.67/32 -> 434CFFEF with mask FFFFFFFF; flags 1: up.
HEAD = "Iface\tDestination\tGateway\tFlags\tRefCnt\tUse\tMetric\tMask\tMTU\tWindow\tIRTT\n"
DEFAULT = "eth0\t00000000\t010200C0\t0003\t0\t0\t0\t00000000\t0\t0\t0\n"
GROUP_TO_LO = "lo\t434CFFEF\t00000000\t0001\t0\t0\t0\tFFFFFFFF\t0\t0\t0\n"
MULTICAST_TO_LO = "lo\t000000E0\t00000000\t0001\t0\t0\t0\t000000F0\t0\t0\t0\n"


def said(returncode, stdout="", stderr=""):
    return subprocess.CompletedProcess([], returncode, stdout, stderr)


# --- network ----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("routes", "verdict", "device"),
    [
        ("", Verdict.wrong, "none"),
        (DEFAULT, Verdict.note, "eth0"),  # it leaves by the default route
        (DEFAULT + MULTICAST_TO_LO, Verdict.ok, "lo"),
        (MULTICAST_TO_LO.replace("lo", "wlan0") + GROUP_TO_LO, Verdict.ok, "lo"),  # the more specific one wins
        (GROUP_TO_LO + MULTICAST_TO_LO.replace("lo", "wlan0"), Verdict.ok, "lo"),  # in whatever order
        (GROUP_TO_LO.replace("0001", "0000"), Verdict.wrong, "none"),  # a route that is down is none
        ("nonsense\n\n" + GROUP_TO_LO, Verdict.ok, "lo"),
    ],
)
def test_the_route_of_the_group_is_read_from_the_kernels_table(machine, routes, verdict, device):
    found = network.check_route(machine({"proc/net/route": HEAD + routes}), network.Group())
    assert found.verdict is verdict
    assert device in found.seen
    assert ("ip route add 239.255.76.67/32 dev lo" in found.advice) == (verdict is not Verdict.ok)


@pytest.mark.parametrize(
    ("url", "group"),
    [
        ("udpm://239.255.76.67:7667?ttl=0", network.Group("239.255.76.67", 7667)),
        ("udpm://239.255.76.68:7700?ttl=1&recv_buf_size=4194304", network.Group("239.255.76.68", 7700)),
        ("udpm://", network.Group()),
        ("udpm://?ttl=1", network.Group()),
        ("memq://", None),
        ("file:///tmp/run.log", None),
    ],
)
def test_the_group_is_read_from_the_url_as_lcm_reads_it(url, group):
    assert network.group_of(url) == group


@pytest.mark.parametrize(
    ("text", "verdict"),
    [("212992\n", Verdict.note), ("1228799", Verdict.note), ("1228800", Verdict.ok), ("4194304", Verdict.ok)],
)
def test_the_receive_buffer_should_hold_four_raw_pictures(machine, text, verdict):
    """4 * 640 * 480 = 1 228 800 bytes; 212 992 is what a stock Debian allows."""
    assert network.check_receive_buffer(machine({"proc/sys/net/core/rmem_max": text})).verdict is verdict


# --- other senders on the bus -----------------------------------------------------------------------------------------
def received(*messages):
    channels = {}
    for channel, data in messages:
        channels.setdefault(channel, bus_checks.Channel()).receive(channel, data)
    return channels


def command(session):
    message = command_t()
    message.session = session
    return message.encode()


def test_channels_are_listed_with_their_rates():
    """30 messages of 10 bytes in 2 s: 15 Hz and 150 bytes a second."""
    (summary,) = bus_checks.findings_of(received(*30 * [("ROBOT1_POSE", bytes(10))]), 2.0)
    assert summary.seen == "ROBOT1_POSE 15.0 Hz 0.1 kB/s"
    assert summary.verdict is Verdict.ok


def test_one_coordinator_a_robot_is_as_it_should_be():
    findings = bus_checks.findings_of(
        received(*3 * [("ROBOT1_COMMAND", command(7)), ("ROBOT2_COMMAND", command(8))]), 1.0
    )
    assert [finding.verdict for finding in findings] == [Verdict.ok]


def test_two_coordinators_of_one_name_are_wrong():
    findings = bus_checks.findings_of(received(("ROBOT1_COMMAND", command(7)), ("ROBOT1_COMMAND", command(-1))), 1.0)
    (senders,) = [finding for finding in findings if finding.check == "senders"]
    assert senders.verdict is Verdict.wrong
    assert senders.seen.startswith("2 send on ROBOT1_COMMAND")
    assert "0000000000000007" in senders.seen and "ffffffffffffffff" in senders.seen


@pytest.mark.parametrize(
    "data",
    [b"", b"\x00" * 8, command(7)[:20], bytes(range(256))],
    ids=["nothing", "another type", "cut off", "noise"],
)
def test_commands_of_another_version_are_wrong(data):
    findings = bus_checks.findings_of(received(("ROBOT1_COMMAND", data)), 1.0)
    assert [finding.verdict for finding in findings] == [Verdict.ok, Verdict.wrong]


def test_a_hundred_channels_do_not_fill_the_screen():
    (summary,) = bus_checks.findings_of(received(*((f"C{k:03}", b"") for k in range(100))), 1.0)
    assert len(summary.seen.splitlines()) == 13
    assert summary.seen.endswith("and 88 more channels")


# --- programs ---------------------------------------------------------------------------------------------------------
def nowhere(name):
    raise ExecutableNotFoundError(name)


@pytest.mark.parametrize(("needed", "verdict"), [(True, Verdict.wrong), (False, Verdict.note)])
def test_a_program_that_is_not_there_is_wrong_where_it_is_needed(machine, needed, verdict):
    assert programs.check_program(machine(), "pilotfish-x", needed, find=nowhere).verdict is verdict


@pytest.mark.parametrize(
    ("answer", "verdict", "words"),
    [
        (said(0, "pilotfish-x 1.2.3\n"), Verdict.ok, "1.2.3"),
        (said(0, "pilotfish-x 1.2.2\n"), Verdict.wrong, "version 1.2.2"),
        (said(0, ""), Verdict.wrong, "version none"),
        (said(127, stderr="x: error while loading shared libraries: liby.so.1"), Verdict.wrong, "liby.so.1"),
        (None, Verdict.wrong, "--version fails"),
    ],
)
def test_a_program_must_start_and_be_of_this_version(machine, answer, verdict, words):
    host = machine(**{"pilotfish-x": answer})
    found = programs.check_program(host, "pilotfish-x", True, find=lambda name: Path("/b", name), version="1.2.3")
    assert found.verdict is verdict
    assert words in found.seen


def test_a_program_that_does_not_answer_in_time_is_no_older_version(machine, tmp_path):
    (tmp_path / "pilotfish-x").write_text("")
    host = machine(**{"pilotfish-x": None})
    found = programs.check_program(host, "pilotfish-x", True, find=lambda name: tmp_path / name, version="1.2.3")
    assert found.verdict is Verdict.note
    assert "did not answer in time" in found.seen


# --- devices ----------------------------------------------------------------------------------------------------------
def test_cameras_are_named_and_one_without_permission_is_wrong(machine):
    files = {"dev/video0": "", "dev/video1": "", "sys/class/video4linux/video0/name": "Eye 3000\n"}
    found = devices.check_cameras(machine(files))
    assert found.verdict is Verdict.ok
    assert found.seen == "video0 (Eye 3000), video1"
    found = devices.check_cameras(machine(files, closed=["video1"]))
    assert found.verdict is Verdict.wrong
    assert "video1" in found.seen and "video0" not in found.seen
    assert "usermod -aG video" in found.advice


def test_serial_lines_are_adapters_and_not_the_ttys_of_every_pc(machine):
    files = {"dev/ttyUSB0": "", "dev/ttyACM1": "", "dev/ttyS0": ""}
    assert devices.check_serial_lines(machine(files)).seen == "ttyUSB0, ttyACM1"
    found = devices.check_serial_lines(machine(files, closed=["ttyACM1"]))
    assert found.verdict is Verdict.wrong
    assert "usermod -aG dialout" in found.advice


# --- the machine ------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("root", "priority", "memory", "verdict"),
    [
        (True, 0, 65536, Verdict.ok),
        (False, 50, resource.RLIM_INFINITY, Verdict.ok),
        (False, 0, resource.RLIM_INFINITY, Verdict.note),
        (False, 50, 8 << 20, Verdict.note),
    ],
)
def test_real_time_needs_a_priority_and_memory_to_lock(machine, root, priority, memory, verdict):
    limits = {resource.RLIMIT_RTPRIO: priority, resource.RLIMIT_MEMLOCK: memory}
    assert system.check_real_time(machine(root=root, limits=limits)).verdict is verdict


@pytest.mark.parametrize(("source", "verdict"), [("tsc\n", Verdict.ok), ("hpet", Verdict.note)])
def test_the_clock_should_be_quick_to_read(machine, source, verdict):
    files = {"sys/devices/system/clocksource/clocksource0/current_clocksource": source}
    assert system.check_clock(machine(files)).verdict is verdict


@pytest.mark.parametrize(("synchronized", "verdict"), [(True, Verdict.ok), (False, Verdict.note), (None, Verdict.note)])
def test_an_unsynchronized_clock_is_told(machine, synchronized, verdict):
    assert system.check_time(machine(synchronized=synchronized)).verdict is verdict


@pytest.mark.parametrize(
    ("free", "verdict"), [(99_999_999, Verdict.wrong), (100_000_000, Verdict.note), (1_000_000_000, Verdict.ok)]
)
def test_a_full_disk_is_wrong(machine, free, verdict):
    assert system.check_disk(machine(free=free)).verdict is verdict


EXPRESSION = '{"expr": [{"match": {}}, {"counter": {"packets": 42}}, {"drop": null}]}'
RULES = f'{{"nftables": [{{"metainfo": {{}}}}, {{"rule": {EXPRESSION}}}]}}'


@pytest.mark.parametrize(
    ("answer", "verdict", "words"),
    [
        (None, Verdict.note, "no nft"),
        (said(0, RULES), Verdict.ok, "42 packets"),
        (said(0, "{"), Verdict.ok, "only this host"),
        (said(1, stderr="Error: No such file or directory"), Verdict.note, "every host"),
        (said(1, stderr="Operation not permitted (you must be root)"), Verdict.note, "only root"),
    ],
)
def test_the_firewall_rule_is_looked_for(machine, answer, verdict, words):
    found = system.check_firewall(machine(nft=answer))
    assert found.verdict is verdict
    assert words in found.seen


def test_the_version_of_liblcm_is_told(machine):
    files = {"usr/lib/x86_64-linux-gnu/liblcm.so.1.3.4": ""}
    assert system.check_liblcm(machine(files)).seen == "1.3.4"
    assert system.check_liblcm(machine(files, **{"dpkg-query": said(0, "1.3.1+repack1-3")})).seen == "1.3.1+repack1-3"


@pytest.mark.parametrize(
    "check",
    [
        lambda host: network.check_route(host, network.Group()),
        network.check_receive_buffer,
        system.check_clock,
        system.check_liblcm,
        system.check_firewall,
        devices.check_cameras,
        devices.check_serial_lines,
    ],
)
def test_a_machine_without_any_of_these_files_gets_a_note(machine, check):
    assert check(machine()).verdict is Verdict.note


def test_the_firewall_remedy_names_rules_that_are_there(machine, said, tmp_path):
    """The package's where it is installed, else those of the clone that these sources are in, else where they stand."""
    packaged = machine({"usr/share/pilotfish/nftables/pilotfish.nft": "table"}, nft=said(1, "", "No such file"))
    assert system.check_firewall(packaged).advice == "sudo nft -f /usr/share/pilotfish/nftables/pilotfish.nft"
    (tmp_path / "a clone" / "packaging" / "nftables").mkdir(parents=True)
    rules = tmp_path / "a clone" / "packaging" / "nftables" / "pilotfish.nft"
    rules.write_text("table")
    bare = Host(tmp_path / "nothing")
    near = tmp_path / "a clone" / "python" / "pilotfish" / "system.py"
    assert system._let_only_this_host(bare, [near]) == f"sudo nft -f '{rules}'"
    assert "operating-guide" in system._let_only_this_host(bare, [tmp_path / "else" / "system.py"])

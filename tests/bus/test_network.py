"""A network that does not work must say so, and what to do: quickly, and before anything waits for it."""

import contextlib
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import textwrap
import threading

import pytest

from pilotfish import bus

OPEN_A_BUS = """
import sys
from pilotfish import bus
try:
    link = bus.Bus(sys.argv[1])
except bus.BusError as error:
    sys.exit(f"refused: {error}")
received = []
link.on_command("r1", received.append)
link.publish_command("r1", bus.CommandReport(utime=1))
assert link.handle(5000) == 1
print("works")
"""


def open_elsewhere(url, wrapper=(), **environment):
    return subprocess.run(
        [*wrapper, sys.executable, "-c", OPEN_A_BUS, url],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path), **environment},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )


@pytest.mark.parametrize(
    ("url", "says"),
    [
        ("udpm://239.255.76.67?ttl=0", "has no valid port"),
        ("udpm://239.255.76.67:0", "has port 0"),
        ("udpm://239.255.76.67:65536", "has no valid port"),
        ("udpm://10.0.0.1:7667", "has no multicast group"),
        ("udpm://localhost:7667", "has no multicast group"),
        ("udpm://239.255.76.67:7667?tll=1", "unknown option 'tll'; known: ttl, recv_buf_size"),
        ("udpm://239.255.76.67:7667?ttl=x", "has no valid ttl"),
        ("udpm://239.255.76.67:7667?ttl=0&recv_buf_size=", "has no valid recv_buf_size"),
        ("nonsense", "the LCM URL nonsense does not begin with a provider"),
        ("carrier-pigeon://roof", "known: udpm, mpudpm, memq, tcpq, file"),
        ("udp://x", "the LCM URL udp://x does not begin with a provider of liblcm, as in udpm://239.255.76.67:7667"),
        (
            "tcpq://localhost:1",
            "no LCM server answers at localhost:1, which tcpq://localhost:1 names: Connection refus",
        ),
        ("tcpq://nowhere.invalid:7700", "no LCM server answers at nowhere.invalid:7700"),
        ("tcpq://localhost:seven", "no LCM server answers at localhost:seven"),
        ("file:///nowhere/run.log?mode=r", "liblcm cannot open file:///nowhere/run.log"),
    ],
)
def test_an_impossible_url_is_refused_with_its_reason(url, says):
    with pytest.raises(bus.BusError, match=re.escape(says)):
        bus.Bus(url)


def test_a_server_that_listens_is_accepted():
    """It greets as LCM's TCPService does: a magic number and a version, to whoever connects."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(60)

        def greet():
            connections = []
            for _ in range(2):  # the check's, and liblcm's own
                connections.append(server.accept()[0])
                with contextlib.suppress(OSError):  # the check has gone
                    connections[-1].sendall(struct.pack(">II", 0x287617FB, 0x0100))
            connections[-1].recv(8)
            for each in connections:
                each.close()

        greeting = threading.Thread(target=greet, daemon=True)
        greeting.start()
        url = f"tcpq://127.0.0.1:{server.getsockname()[1]}"
        assert bus.Bus(url).url == url
        greeting.join(60)


def test_an_unknown_url_is_refused_in_one_message(capfd):
    """liblcm would print one of its own."""
    with pytest.raises(bus.BusError):
        bus.Bus("udp://x")
    assert capfd.readouterr().err == ""


def test_the_url_comes_from_the_environment_if_none_is_given(url, monkeypatch):
    monkeypatch.setenv("LCM_DEFAULT_URL", url)
    assert bus.Bus().url == url
    monkeypatch.delenv("LCM_DEFAULT_URL")
    assert bus.Bus().url == bus.DEFAULT_URL


def test_waiting_without_a_subscription_ends(url):
    assert bus.Bus(url).handle(1) == 0


def test_without_a_route_the_error_names_commands_that_mend_it(own_network, url):
    refused = open_elsewhere(url, own_network)
    assert refused.returncode == 1
    assert refused.stderr.startswith("refused: no way for multicast to 239.255.76.67:"), refused.stderr
    (advice,) = re.findall(r"On one host: (.*?)\. ", refused.stderr)
    assert "ip route add 224.0.0.0/4 dev lo" in advice
    mended = open_elsewhere(url, [*own_network, "sh", "-c", f'{advice} && exec "$@"', "sh"])
    assert mended.stdout == "works\n", mended.stderr


def test_where_messages_vanish_the_bus_gives_up_before_liblcm_starts_its_ten_seconds(tmp_path, url):
    """A firewall, played by a library that swallows what is sent. liblcm would end in "self test failed"."""
    compiler = shutil.which("cc") or pytest.skip("needs a C compiler")
    source, library = tmp_path / "swallow.c", tmp_path / "swallow.so"
    source.write_text(
        textwrap.dedent("""
            #include <stddef.h>
            #include <sys/types.h>
            #include <sys/uio.h>
            #include <sys/socket.h>
            ssize_t sendto(int s, const void* data, size_t n, int f, const struct sockaddr* a, socklen_t l) {
              (void)s; (void)data; (void)f; (void)a; (void)l;
              return (ssize_t)n;
            }
            """)
    )
    subprocess.run([compiler, "-shared", "-fPIC", "-o", library, source], check=True)
    preloaded = os.environ.get("LD_PRELOAD", "").split(":")  # a sanitizer's runtime wants to be first
    refused = open_elsewhere(url, LD_PRELOAD=":".join([*filter(None, preloaded), str(library)]))
    assert refused.returncode == 1
    assert "what is sent does not come back; a firewall may swallow it" in refused.stderr
    assert "self test" not in refused.stderr

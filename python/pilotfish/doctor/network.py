"""The way of the bus through this host: route, multicast that comes back, receive buffer."""

from __future__ import annotations

import os
import re
import socket
import struct
import time
from dataclasses import dataclass
from ipaddress import IPv4Address

from pilotfish.doctor.finding import Finding, note, ok, wrong
from pilotfish.doctor.host import Host

DEFAULT_URL = "udpm://239.255.76.67:7667?ttl=0"
MEND_ROUTE = (
    "sudo systemctl enable --now pilotfish-lcm-route, or: sudo ip link set lo up multicast on; "
    "sudo ip route add {group}/32 dev lo src 127.0.0.1"
)
KEEP_BUFFER = (
    "echo net.core.rmem_max=4194304 | sudo tee /etc/sysctl.d/60-pilotfish.conf && "
    "sudo sysctl -p /etc/sysctl.d/60-pilotfish.conf"
)
RAW_IMAGE_BYTES = 640 * 480
WANTED_IMAGES = 4  # "a few": what may arrive while the reader is busy with one


@dataclass(frozen=True)
class Group:
    """A multicast group of LCM, by default its own."""

    address: str = "239.255.76.67"
    port: int = 7667


def group_of(url: str) -> Group | None:
    """Where a udpm URL sends; None for LCM's other providers."""
    match = re.fullmatch(r"udpm://(?:([\d.]+):(\d{1,5}))?(?:\?.*)?", url)
    if not match:
        return None
    return Group(match[1], int(match[2])) if match[1] else Group()


def check_route(host: Host, group: Group) -> Finding:
    """The most specific of the kernel's routes, as /proc/net/route lists them."""
    table = host.read("/proc/net/route")
    if table is None:
        return note("multicast route", "the routes cannot be read here")
    device = _device_towards(table, group.address)
    if device is None:
        return wrong("multicast route", f"none to {group.address}", MEND_ROUTE.format(group=group.address))
    if device == "lo":
        return ok("multicast route", f"{group.address} stays on this host (lo)")
    return note(
        "multicast route",
        f"{group.address} goes by way of {device}; the services let in only what comes from lo",
        MEND_ROUTE.format(group=group.address),
    )


def _device_towards(table: str, address: str) -> str | None:
    wanted = int(IPv4Address(address))
    best: tuple[int, str] | None = None
    for line in table.splitlines()[1:]:
        fields = line.split()
        if len(fields) < 8:
            continue
        destination, flags, mask = (int(fields[k], 16) for k in (1, 3, 7))
        destination, mask = (socket.ntohl(value) for value in (destination, mask))
        is_up = flags & 1
        if is_up and wanted & mask == destination and (best is None or mask > best[0]):
            best = mask, fields[0]
    return best[1] if best else None


def check_multicast(group: Group, within_s: float = 0.5) -> Finding:
    """Sends LCM's smallest message to the group, and waits for it to come back."""
    try:
        source = multicast_comes_back(group, within_s)
    except OSError as error:
        return wrong("multicast", f"cannot be sent: {error.strerror}", MEND_ROUTE.format(group=group.address))
    if source is None:
        advice = MEND_ROUTE.format(group=group.address) + "; or a firewall swallows it"
        return wrong("multicast", "what is sent does not come back", advice)
    if not source.startswith("127."):
        return note(
            "multicast",
            f"comes back, from {source}; the services let in only localhost",
            MEND_ROUTE.format(group=group.address),
        )
    return ok("multicast", f"comes back, from {source}")


def multicast_comes_back(group: Group, within_s: float) -> str | None:
    """The address it came from; None if it did not. Raises OSError where it cannot be sent at all."""
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
    ):
        receiver.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        receiver.bind((group.address, group.port))
        member = struct.pack("4s4s", socket.inet_aton(group.address), bytes(4))
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        message = b"LC02\0\0\0\0LCM_SELF_TEST\0pilotfish doctor %d" % os.getpid()
        sender.sendto(message, (group.address, group.port))
        until = time.monotonic() + within_s
        while (left_s := until - time.monotonic()) > 0:
            receiver.settimeout(left_s)
            try:
                received, (source, _) = receiver.recvfrom(2048)
            except TimeoutError:
                return None
            if received == message:
                return source
    return None


def check_receive_buffer(host: Host) -> Finding:
    """The kernel's accounting charges a datagram about twice its size; raw pictures above the buffer get lost."""
    text = host.read("/proc/sys/net/core/rmem_max")
    if text is None or not text.isdigit():
        return note("receive buffer", "net.core.rmem_max cannot be read here")
    granted = int(text)
    if granted >= WANTED_IMAGES * RAW_IMAGE_BYTES:
        return ok("receive buffer", f"{granted} bytes: {granted // RAW_IMAGE_BYTES} raw pictures of 640x480")
    return note(
        "receive buffer",
        f"{granted} bytes: too few for raw pictures of 640x480 on the bus ({RAW_IMAGE_BYTES} bytes each)",
        KEEP_BUFFER + " (that keeps it after a restart, too), or send JPEG",
    )

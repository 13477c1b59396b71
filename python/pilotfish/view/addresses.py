"""Under which addresses others reach this host."""

from __future__ import annotations

import ipaddress
import socket


def reachable_addresses(host: str) -> list[str]:
    """For an address that a server listens on: itself, or if it is all of this host's, those that others can use."""
    try:
        address = ipaddress.ip_address(host.strip("[]"))
    except ValueError:
        return [host]
    if not address.is_unspecified:
        return [f"[{address}]" if address.version == 6 else str(address)]
    found = [_outgoing(), *_named()]
    return list(dict.fromkeys(one for one in found if one is not None)) or [socket.gethostname()]


def _outgoing() -> str | None:
    """The address from which packets leave; connecting a UDP socket sends none."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # RFC 5737: nobody's
            return str(probe.getsockname()[0])
        except OSError:
            return None


def _named() -> list[str]:
    try:
        found = socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET, socket.SOCK_STREAM)
    except OSError:
        return []
    return [str(entry[4][0]) for entry in found if not str(entry[4][0]).startswith("127.")]

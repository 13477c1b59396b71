"""A bus of one's own: LCM traffic is kept apart by the UDP port (another multicast group on the same port is
not enough).

The port is below the kernel's ephemeral range, different for processes that live at the same time, and free
right now.
"""

from __future__ import annotations

import itertools
import os
import socket

_FIRST, _COUNT = 20000, 12000
_APART = 7417  # the golden section of _COUNT: processes born one after the other begin far from each other
_RECEIVE_BUFFER_BYTES = 4194304
_calls = itertools.count()


def free_udp_port() -> int:
    """A UDP port no process on this host is bound to, another one with every call."""
    start = os.getpid() * _APART
    for call in itertools.islice(_calls, _COUNT):  # a taken port uses up its call: the next begins behind it
        port = _FIRST + (start + call) % _COUNT
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", port))
            except OSError:
                continue
            return port
    raise OSError(f"no free UDP port between {_FIRST} and {_FIRST + _COUNT}")


def private_lcm_url() -> str:
    """An LCM URL for this host alone (ttl=0) on a port of its own."""
    return f"udpm://239.255.76.67:{free_udp_port()}?ttl=0&recv_buf_size={_RECEIVE_BUFFER_BYTES}"

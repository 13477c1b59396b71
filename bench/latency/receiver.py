"""The programs' answers, and when the kernel received them: independent of the receiver's own scheduling."""

from __future__ import annotations

import ctypes
import socket
import struct
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.observation_t import observation_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t

_SO_ATTACH_FILTER, _SO_TIMESTAMPNS = 26, 35
_SHORT = b"LC02"
# Load the word behind the UDP header; equal to "LC02": keep the datagram, else none of it. The pictures, which are in
# fragments ("LC03"), are not copied to this socket.
_ONLY_SHORT = b"".join(
    struct.pack("=HBBI", *instruction)
    for instruction in (
        (0x20, 0, 0, 8),
        (0x15, 0, 1, int.from_bytes(_SHORT, "big")),
        (0x06, 0, 0, 1 << 18),
        (0x06, 0, 0, 0),
    )
)


@dataclass
class Received:
    """Of one bus, by the picture's utime."""

    answers_ns: dict[int, int] = field(default_factory=dict)  # wall clock, by the kernel
    tracking: int = 0  # answers that follow the leader
    other_commands: int = 0  # the coordinator's own beat, which repeats the utime of the last picture
    looked_ms: list[float] = field(default_factory=list)  # vision and law, as the coordinator's status says
    inside_ms: list[float] = field(default_factory=list)  # from the picture's arrival to the command, as it says

    def take(self, channel: str, data: bytes, at_ns: int) -> None:
        """The first command that names a picture answers it; what names it again does not."""
        if channel == "ROBOT1_COMMAND":
            command = command_t.decode(data)
            if command.utime in self.answers_ns:
                self.other_commands += 1
                return
            self.answers_ns[command.utime] = at_ns
            self.tracking += command.status == command_t.STATUS_TRACKING
        elif channel == "ROBOT1_OBSERVATION":
            self.inside_ms.append(1e3 * observation_t.decode(data).latency_s)
        elif channel == "ROBOT1_STATUS":
            self.looked_ms.append(status_t.decode(data).processing_ms)


class Receiver:
    """On the bus of one receiver."""

    def __init__(self, url: str) -> None:
        network = urlsplit(url)
        group, port = network.hostname or "", network.port or 0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        self._socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        program = ctypes.create_string_buffer(_ONLY_SHORT)
        self._socket.setsockopt(
            socket.SOL_SOCKET, _SO_ATTACH_FILTER, struct.pack("@HP", len(_ONLY_SHORT) // 8, ctypes.addressof(program))
        )
        self._socket.setsockopt(socket.SOL_SOCKET, _SO_TIMESTAMPNS, 1)
        self._socket.bind((group, port))
        self._socket.setsockopt(
            socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + socket.inet_aton("0.0.0.0")
        )
        self.received = Received()

    def fileno(self) -> int:
        return self._socket.fileno()

    def close(self) -> None:
        self._socket.close()

    def listen(self) -> None:
        """Everything that has come."""
        while True:
            try:
                datagram, extras, *_ = self._socket.recvmsg(65536, 128)
            except BlockingIOError:
                return
            stamps = [data for level, kind, data in extras if (level, kind) == (socket.SOL_SOCKET, _SO_TIMESTAMPNS)]
            seconds, nanoseconds = struct.unpack("@qq", stamps[0])
            channel, _, payload = datagram[8:].partition(b"\0")  # behind the magic and the number
            self.received.take(channel.decode("ascii"), payload, seconds * 1_000_000_000 + nanoseconds)

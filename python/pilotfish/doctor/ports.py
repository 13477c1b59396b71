"""Who holds the bus's UDP port: LCM's programs share it, anything else keeps them out."""

from __future__ import annotations

import errno
import socket
from contextlib import suppress
from pathlib import Path

from pilotfish.doctor.finding import Finding, note, ok, wrong
from pilotfish.doctor.host import Host


def check_port(host: Host, port: int) -> Finding:
    """Whether LCM may bind the port, and which programs on this host have done so."""
    holders = programs_on(host, port)
    listed = ", ".join(holders) if holders else "nobody yet"
    if problem := cannot_bind(port):
        return wrong(
            "port",
            f"UDP {port} cannot be shared ({problem}); it is held by {listed if holders else 'a program of others'}",
            f"end it (sudo ss -ulpn 'sport = :{port}' names it), or use another port: "
            f"--lcm-url 'udpm://239.255.76.67:{port + 1}?ttl=0' everywhere",
        )
    if holders or (sockets := _sockets(host, port)) == 0:
        return ok("port", f"UDP {port}: {listed}")
    return note("port", f"UDP {port}: {sockets} sockets of other users", f"sudo ss -ulpn 'sport = :{port}' names them")


def cannot_bind(port: int) -> str:
    """As LCM binds it, with addresses shared; empty if it can be."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("", port))
        except OSError as error:
            return errno.errorcode.get(error.errno or 0, str(error))
    return ""


def programs_on(host: Host, port: int) -> list[str]:
    """ "pilotfish-coord (412)" for each process of this user (all of them for root) with a socket on the port."""
    inodes = {f"socket:[{inode}]" for inode in _inodes(host, port)}
    found = []
    for folder in host.find("/proc", "[0-9]*/fd") if inodes else []:
        if inodes & _open_files(folder):
            pid = folder.parent.name
            name = host.read(f"/proc/{pid}/comm") or "?"
            found.append((int(pid), f"{name} ({pid})"))
    return [text for _, text in sorted(found)]


def _open_files(folder: Path) -> set[str]:
    names = set()
    with suppress(OSError):  # another user's, or it has ended
        for file in folder.iterdir():
            with suppress(OSError):  # closed in between
                names.add(str(file.readlink()))
    return names


def _sockets(host: Host, port: int) -> int:
    return len(_inodes(host, port))


def _inodes(host: Host, port: int) -> list[str]:
    """/proc/net/udp: `sl local_address rem_address st tx:rx tr:when retrnsmt uid timeout inode`, addresses in
    hexadecimal as ADDRESS:PORT."""
    inodes = []
    for table in ("/proc/net/udp", "/proc/net/udp6"):
        for line in (host.read(table) or "").splitlines()[1:]:
            fields = line.split()
            if len(fields) > 9 and fields[1].rpartition(":")[2] == f"{port:04X}":
                inodes.append(fields[9])
    return inodes

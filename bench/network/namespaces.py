"""Network namespaces that end with the process that made them.

A namespace is kept by an open descriptor, not by a name in /run/netns, and every program in it is killed by the kernel
when this process ends (PR_SET_PDEATHSIG). So nothing is left behind, not after Ctrl-C and not after SIGKILL: the kernel
removes a namespace, and the virtual cables that end in it, with its last descriptor and process.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

CLONE_NEWNET = 0x40000000  # linux/sched.h
_IN_USER_NAMESPACE = "PILOTFISH_BENCH_IN_USER_NAMESPACE"
_TOOLS = {"ip": "iproute2", "tc": "iproute2", "nsenter": "util-linux", "setpriv": "util-linux", "unshare": "util-linux"}
_libc = ctypes.CDLL(None, use_errno=True)


class NetworkNotPermittedError(RuntimeError):
    """No network namespace can be made here; the message says what to do."""


def become_root_of_a_user_namespace() -> None:
    """Who is not root runs this program again, as the root of a user namespace; for root nothing happens. To be called
    before any thread begins, and with nothing done yet. Raises NetworkNotPermittedError."""
    if missing := sorted({package for tool, package in _TOOLS.items() if not shutil.which(tool)}):
        raise NetworkNotPermittedError(f"programs are missing: sudo apt install {' '.join(missing)}")
    if os.geteuid() == 0:
        return
    if _IN_USER_NAMESPACE in os.environ:
        raise NetworkNotPermittedError(_ADVICE)
    probe = subprocess.run(["unshare", "--user", "--map-root-user", "--net", "true"], capture_output=True, check=False)
    if probe.returncode:
        raise NetworkNotPermittedError(_ADVICE)
    os.environ[_IN_USER_NAMESPACE] = "1"
    os.execvp("unshare", ["unshare", "--user", "--map-root-user", "--", *sys.orig_argv])


_ADVICE = (
    "network namespaces are not permitted to this user. Run it as root, or permit user namespaces: "
    "sudo sysctl kernel.unprivileged_userns_clone=1 (Debian), "
    "sudo sysctl kernel.apparmor_restrict_unprivileged_userns=0 (Ubuntu 24.04); "
    "in a container: --cap-add NET_ADMIN --cap-add SYS_ADMIN"
)


class Namespace:
    """A network of its own, empty but for a loopback interface that is down."""

    def __init__(self) -> None:
        outside = os.open("/proc/thread-self/ns/net", os.O_RDONLY)
        try:
            unshare_network()
            self.descriptor = os.open("/proc/thread-self/ns/net", os.O_RDONLY)
            _call("setns", outside, CLONE_NEWNET)
        finally:
            os.close(outside)

    def close(self) -> None:
        os.close(self.descriptor)

    def command(self, words: Sequence[str | Path]) -> list[str]:
        """The words of a command that runs in here and ends, at the latest, with this process."""
        network = f"--net=/proc/{os.getpid()}/fd/{self.descriptor}"
        return ["nsenter", network, "setpriv", "--pdeathsig", "KILL", *map(str, words)]

    def run(self, *commands: str) -> None:
        """Commands of ``ip``, one after the other."""
        _ip(self.command(["ip", "-batch", "-"]), commands)

    @contextmanager
    def entered(self) -> Iterator[None]:
        """Sockets that this thread opens meanwhile, and threads that it begins, are in here."""
        outside = os.open("/proc/thread-self/ns/net", os.O_RDONLY)
        try:
            _call("setns", self.descriptor, CLONE_NEWNET)
            try:
                yield
            finally:
                _call("setns", outside, CLONE_NEWNET)
        finally:
            os.close(outside)


def unshare_network() -> None:
    """This thread moves into a new network. Raises NetworkNotPermittedError."""
    try:
        _call("unshare", CLONE_NEWNET)
    except PermissionError as error:
        raise NetworkNotPermittedError(_ADVICE) from error


def run_ip(*commands: str) -> None:
    """Commands of ``ip`` where this process is."""
    _ip(["ip", "-batch", "-"], commands)


def _ip(words: list[str], commands: Sequence[str]) -> None:
    done = subprocess.run(words, input="\n".join(commands), capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"ip: {done.stderr.strip()}\n  of: " + "\n      ".join(commands))


def _call(name: str, *arguments: int) -> None:
    if getattr(_libc, name)(*arguments):
        number = ctypes.get_errno()
        raise OSError(number, f"{name}: {os.strerror(number)}")

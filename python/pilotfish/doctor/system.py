"""The machine itself: real time, clock, room for recordings, firewall, liblcm."""

from __future__ import annotations

import json
import re
import resource
import shlex
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from pilotfish.doctor.finding import Finding, note, ok, wrong
from pilotfish.doctor.host import Host

BLACK_BOX = "/var/lib/pilotfish"
RULES = "/usr/share/pilotfish/nftables/pilotfish.nft"
_WANTED_FREE_BYTES = 1_000_000_000
_MIN_FREE_BYTES = 100_000_000
# Read from user space without a system call; the others cost a microsecond and more each time.
_FAST_CLOCKS = {"tsc", "arch_sys_counter", "kvm-clock", "hyperv_clocksource_tsc_page", "riscv_clocksource"}


def check_real_time(host: Host) -> Finding:
    """Whether the programs may have a real-time priority and lock their memory."""
    if host.is_root():
        return ok("real time", "allowed (root)")
    priority, memory = host.limit(resource.RLIMIT_RTPRIO), host.limit(resource.RLIMIT_MEMLOCK)
    if priority != 0 and memory == resource.RLIM_INFINITY:
        return ok("real time", f"priority up to {'any' if priority < 0 else priority}, memory can be locked")
    missing = [*(["no real-time priority"] if priority == 0 else [])]
    if memory != resource.RLIM_INFINITY:
        missing.append(f"only {memory // 1024} kB of memory can be locked")
    return note(
        "real time",
        " and ".join(missing) + " for programs started by hand",
        "nothing for the services; else lines for rtprio and memlock in /etc/security/limits.d",
    )


def check_governor(host: Host) -> Finding:
    """Whether the processors run at full speed, or first have to notice that there is something to do."""
    files = host.find("/sys/devices/system/cpu", "cpu[0-9]*/cpufreq/scaling_governor")
    governors = Counter(text for file in files if (text := _text(file)))
    if not governors:
        return note("CPU governor", "none: the frequency is not for this system to choose (a virtual machine?)")
    listed = ", ".join(f"{name} on {count}" for name, count in governors.most_common())
    if set(governors) == {"performance"}:
        return ok("CPU governor", listed)
    return note(
        "CPU governor",
        f"{listed}: a processor that slows down between two pictures adds a few ms to some of them",
        "sudo cpupower frequency-set -g performance (package linux-cpupower; until the next restart)",
    )


def check_clock(host: Host) -> Finding:
    """Whether the kernel's clock is quick to read."""
    source = host.read("/sys/devices/system/clocksource/clocksource0/current_clocksource")
    if source is None:
        return note("clock source", "cannot be read here")
    if source in _FAST_CLOCKS:
        return ok("clock source", source)
    return note("clock source", f"{source} is slow to read", "see /sys/devices/system/clocksource and the BIOS")


def check_time(host: Host) -> Finding:
    """Whether the time of day is synchronised."""
    synchronized = host.clock_is_synchronized()
    if synchronized is None:
        return note("time of day", "whether it is synchronized cannot be read here")
    if synchronized:
        return ok("time of day", "synchronized")
    return note(
        "time of day",
        "not synchronized; ages are measured on the monotonic clock, but recordings carry the wrong time",
        "sudo apt-get install chrony, or: sudo timedatectl set-ntp true",
    )


def check_disk(host: Host, black_box: str = BLACK_BOX) -> Finding:
    """Whether there is room for a black box."""
    folder = host.path(black_box)
    while not folder.is_dir() and folder != folder.parent:
        folder = folder.parent
    free = host.free_bytes(folder)
    if free < _MIN_FREE_BYTES:
        return wrong("disk", f"{free // 1_000_000} MB free for {black_box}", "make room, or record somewhere else")
    if free < _WANTED_FREE_BYTES:
        return note("disk", f"{free // 1_000_000} MB free for {black_box}: recordings will be short")
    return ok("disk", f"{free / 1e9:.1f} GB free for {black_box}")


def check_firewall(host: Host) -> Finding:
    """Whether other hosts can send to the bus."""
    shown = host.run(["nft", "-j", "list", "table", "inet", "pilotfish"])
    if shown is None:
        return note("firewall", "no nft here: who else may send to the bus is not known", "apt-get install nftables")
    if shown.returncode == 0:
        return ok("firewall", f"only this host can send; {_dropped(shown.stdout)} packets of others dropped")
    if "permitted" in shown.stderr:
        return note("firewall", "only root can read the rules", "sudo nft list table inet pilotfish")
    return note("firewall", "every host on the network can send to the bus", _let_only_this_host(host))


def _let_only_this_host(host: Host, near: Sequence[Path] | None = None) -> str:
    """The command with the rules that are there: the package's, or a clone's, above one of the files ``near``; else
    where they are written."""
    if host.path(RULES).is_file():
        return f"sudo nft -f {RULES}"
    for start in near if near is not None else (Path(__file__).resolve(), Path(sys.prefix)):
        for folder in start.parents:
            if (rules := folder / "packaging/nftables/pilotfish.nft").is_file():
                return f"sudo nft -f {shlex.quote(str(rules))}"
    return "docs/operating-guide.md, 'LCM on your machine', has the rules for nft; the Debian package brings them"


def _dropped(rules: str) -> int:
    try:
        rules_only = [entry["rule"] for entry in json.loads(rules)["nftables"] if "rule" in entry]
        return sum(part["counter"]["packets"] for rule in rules_only for part in rule["expr"] if "counter" in part)
    except (ValueError, KeyError, TypeError):
        return 0


def check_liblcm(host: Host) -> Finding:
    """The system's, which LCM's own tools use. Debian's file carries another number than its release."""
    packaged = host.run(["dpkg-query", "-W", "-f", "${Version}", "liblcm1"])
    if packaged is not None and packaged.returncode == 0 and packaged.stdout:
        return ok("liblcm", packaged.stdout)
    folders = ("/usr/local/lib", *(f"/usr/lib/{folder.name}" for folder in host.find("/usr/lib", "*-linux-gnu*")))
    files = [file for folder in folders for file in host.find(folder, "liblcm.so*")]
    versions = {match[1] for file in files if (match := re.search(r"\.so\.(\d+\.\d+\.\d+)$", _real(file)))}
    if not files:
        return note("liblcm", "not installed on the system", "apt-get install liblcm1 liblcm-bin")
    return ok("liblcm", ", ".join(sorted(versions)) if versions else "installed, of unknown version")


def _text(file: Path) -> str:
    try:
        return file.read_text(errors="replace").strip()
    except OSError:
        return ""


def _real(file: Path) -> str:
    return file.resolve().name

"""A graph of ROS 1 or ROS 2 of one's own: its bridge, and peers that listen and publish in processes of their own."""

from __future__ import annotations

import itertools
import os
import socket
import subprocess
import sys
import sysconfig
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ros_definitions import Definitions
from rosbags.typesys import Stores

from build_tree import ROOT
from pilotfish.harness.child import Child

HERE = Path(__file__).parent
_numbers = itertools.count()

# This host only, and without multicast, which a container's loopback may not have.
CYCLONEDDS = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<Peers><Peer Address="127.0.0.1"/></Peers></Discovery></Domain></CycloneDDS>'
)


class Heard(NamedTuple):
    """A message that a listener received."""

    at_us: int
    """CLOCK_BOOTTIME."""
    message: Any


class Listener(Child):
    """Prints what it receives on one topic."""

    def __init__(self, command: Sequence[str | Path], folder: Path, definitions: Definitions, ros_name: str) -> None:
        super().__init__(command, folder, f"listener{next(_numbers)}")
        self._definitions, self._ros_name = definitions, ros_name
        self._skipped = 0

    def raw(self) -> list[tuple[int, bytes]]:
        """All that it has received so far: time [us] and bytes."""
        complete = self.stdout().splitlines(keepends=True)[self._skipped :]
        words = [line.split() for line in complete if line.endswith("\n")]
        return [(int(at_us), bytes.fromhex(text)) for at_us, text in words]

    def heard(self) -> list[Heard]:
        """The same, decoded."""
        return [Heard(at_us, self._definitions.decode(data, self._ros_name)) for at_us, data in self.raw()]

    def forget(self) -> None:
        """From here on, only what comes now."""
        self._skipped += len(self.raw())


class Graph:
    """What both have in common."""

    name: str
    definitions: Definitions

    def __init__(self, folder: Path, python: str = sys.executable) -> None:
        self.folder, self.python = folder, python

    def topic(self, name: str) -> str:
        """Another ROS topic with every call."""
        return f"/test{os.getpid()}_{next(_numbers)}/{name}"

    def bridge(self, *arguments: str) -> Child:
        """The example, started."""
        program = ROOT / "examples" / self.name / "bridge.py"
        return Child([self.python, program, *arguments], self.folder, f"bridge{next(_numbers)}")

    def listen(self, topic: str, ros_name: str) -> Listener:
        """A listener, started."""
        return Listener(self._peer("listen", topic, ros_name), self.folder, self.definitions, ros_name)

    def publish(self, topic: str, messages: Sequence[Any]) -> Child:
        """A publisher that sends them in turn, started."""
        file = self.folder / f"messages{next(_numbers)}"
        file.write_text("".join(self.definitions.encode(message).hex() + "\n" for message in messages))
        command = [*self._peer("publish", topic, messages[0].__msgtype__), file]
        return Child(command, self.folder, f"publisher{next(_numbers)}")

    def _peer(self, what: str, topic: str, ros_name: str) -> list[str]:
        raise NotImplementedError


class Ros2Graph(Graph):
    """A DDS domain."""

    name = "ros2"
    definitions = Definitions(Stores.ROS2_HUMBLE)
    domain = str(1 + os.getpid() % 100)

    def bridge(self, *arguments: str) -> Child:
        return super().bridge(*arguments, "--domain", self.domain)

    def _peer(self, what: str, topic: str, ros_name: str) -> list[str]:
        return [self.python, str(HERE / "ros2_peer.py"), what, self.domain, f"rt{topic}", ros_name]


class Ros1Graph(Graph):
    """A roscore's graph; $ROS_MASTER_URI says where it is."""

    name = "ros1"
    definitions = Definitions(Stores.ROS1_NOETIC)

    def _peer(self, what: str, topic: str, ros_name: str) -> list[str]:
        return [self.python, str(HERE / "ros1_peer.py"), what, topic, ros_name.replace("/msg/", "/")]


def free_tcp_port() -> int:
    """One that nobody listens on right now."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def python_with_rospy() -> tuple[str, dict[str, str]] | None:
    """An interpreter that imports both rospy and what Pilotfish needs, and its environment: this one; or Debian's own,
    of the same version, with this one's packages before its own."""
    packages = [*filter(None, [os.environ.get("PYTHONPATH")]), sysconfig.get_path("purelib")]
    for python, more in ((sys.executable, {}), ("/usr/bin/python3", {"PYTHONPATH": os.pathsep.join(packages)})):
        check = f"import sys, rospy, pilotfish.core; sys.exit(sys.version_info[:2] != {sys.version_info[:2]})"
        if (
            Path(python).is_file()
            and not subprocess.run([python, "-c", check], env=os.environ | more, capture_output=True).returncode
        ):
            return python, more
    return None

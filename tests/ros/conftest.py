from __future__ import annotations

import importlib.util
import shutil
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

from pilotfish.harness.child import Child
from pilotfish.harness.ports import private_lcm_url

if TYPE_CHECKING:
    from ros_graphs import Graph

STARTS_WITHIN_S = 30.0


@pytest.fixture(scope="module")
def url() -> str:
    return private_lcm_url()


@pytest.fixture(scope="session")
def rospy_python() -> tuple[str, dict[str, str]]:
    from ros_graphs import python_with_rospy

    if not shutil.which("roscore"):
        pytest.skip("no roscore: apt-get install --no-install-recommends python3-roslaunch python3-rosmaster")
    found = python_with_rospy()
    if found is None:
        pytest.skip("no rospy for this Python: apt-get install --no-install-recommends python3-rospy, and the messages")
    return found


@pytest.fixture(scope="session")
def master(rospy_python, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A real roscore on a free port."""
    from ros_graphs import free_tcp_port

    folder, port = tmp_path_factory.mktemp("roscore"), free_tcp_port()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("ROS_HOME", str(folder))
        patch.setenv("ROS_IP", "127.0.0.1")
        patch.setenv("ROS_MASTER_URI", f"http://127.0.0.1:{port}")
        with Child(["roscore", "-p", str(port)], folder, "roscore") as core:
            core.wait_until(lambda: "started core service" in core.stdout(), STARTS_WITHIN_S, "a core")
            yield f"http://127.0.0.1:{port}"


@pytest.fixture(params=["ros1", "ros2"], scope="module")
def graph(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Graph]:
    """A graph of ROS 1, then one of ROS 2; skipped where that is not installed."""
    import ros_graphs as graphs

    folder = tmp_path_factory.mktemp(request.param)
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "ros2":
            if importlib.util.find_spec("cyclonedds") is None:
                pytest.skip("no cyclonedds: pip install cyclonedds")
            patch.setenv("CYCLONEDDS_URI", graphs.CYCLONEDDS)
            yield graphs.Ros2Graph(folder)
            return
        python, more = request.getfixturevalue("rospy_python")
        patch.setenv("ROS_MASTER_URI", request.getfixturevalue("master"))
        patch.setenv("ROS_HOME", str(folder))
        patch.setenv("ROS_IP", "127.0.0.1")
        for name, value in more.items():
            patch.setenv(name, value)
        yield graphs.Ros1Graph(folder, python)

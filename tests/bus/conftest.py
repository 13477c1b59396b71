import shutil
import subprocess

import pytest
from bus_link import Link
from edge import Edge

from pilotfish.harness.ports import private_lcm_url


@pytest.fixture
def url() -> str:
    return private_lcm_url()


@pytest.fixture
def link(url: str) -> Link:
    return Link(url)


@pytest.fixture
def edge(link):
    return Edge(link)


@pytest.fixture(scope="session")
def own_network():
    """A command that runs another in a network namespace of its own, where nothing is set up."""
    if not shutil.which("unshare") or not shutil.which("ip"):
        pytest.skip("needs unshare (util-linux) and ip (iproute2)")
    for wrapper in (["unshare", "--net"], ["unshare", "--net", "--map-root-user"]):
        if (
            subprocess.run([*wrapper, "ip", "link", "set", "lo", "up"], capture_output=True, check=False).returncode
            == 0
        ):
            return wrapper
    pytest.skip("this kernel or container allows no network namespaces")

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

import pytest
from bus_link import Link

from pilotfish.harness.ports import private_lcm_url


@pytest.fixture
def url() -> str:
    return private_lcm_url()


@pytest.fixture
def link(url: str) -> Link:
    return Link(url)

"""A virtual screen and a Java for the tests of pilotfish-spy; skipped where the packages for it are missing."""

from __future__ import annotations

import pytest
from spy_probe import Probe
from spy_screen import JARS, Screen, skip_unless, virtual_screen


@pytest.fixture(scope="session")
def lcm_spy():
    """Skips unless everything is there that lcm-spy itself needs."""
    skip_unless("java:default-jre", "Xvfb:xvfb", "xdotool")


@pytest.fixture(scope="session")
def plug_in():
    """Skips if Pilotfish was built without a Java compiler."""
    missing = [jar for jar in JARS if not jar.exists()]
    if missing:
        pytest.skip(f"no {missing[0]}: apps/spy/make_jars makes it")


@pytest.fixture(scope="session")
def screen(lcm_spy):
    with virtual_screen() as display:
        yield Screen(display)


@pytest.fixture(scope="session")
def probe(tmp_path_factory, plug_in):
    skip_unless("java:default-jre", "javac:default-jdk-headless")
    with Probe(tmp_path_factory.mktemp("probe")) as started:
        yield started

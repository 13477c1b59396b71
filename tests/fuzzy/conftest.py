import fuzzy_reference
import pytest

from pilotfish import fuzzy


@pytest.fixture(scope="session")
def controller():
    """The shipped controller."""
    return fuzzy.load_controller(fuzzy_reference.DATA)


@pytest.fixture
def data():
    """The shipped file, read by PyYAML; a fresh copy that a test may break."""
    return fuzzy_reference.read()


@pytest.fixture
def gaussian_data(data):
    """The shipped table with a Gaussian in place of every triangle, of about the same width."""
    for name in ("E", "EC", "U"):
        for label, spec in data[name]["terms"].items():
            if "triangle" in spec:
                a, b, c = spec["triangle"]
                data[name]["terms"][label] = {"gaussian": {"mean": b, "sigma": (c - a) / 5}}
    return data

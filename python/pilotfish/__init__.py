"""Pilotfish: a robot follows another robot by sight alone.

The modules of the C++ library are extension modules of the same names (``pilotfish.core``, ``.fuzzy``, ``.vision``,
``.control``, ``.coordinator``, ``.capture``, ``.bus``, ``.sim``, ``.base``, ``.blackbox``), loaded when they are first
used. On top of them, in Python: ``operating`` talks to a running coordinator, ``harness`` runs scenarios,
``experiments`` holds the source paper's two, ``metrics`` and ``plots`` evaluate and draw, ``calibration`` finds where
a leader's tags sit, ``cli`` is the command line.
"""

from pilotfish.errors import ConfigError, PilotfishError

__all__ = ["ConfigError", "PilotfishError", "__version__"]
__version__ = "0.1.0"


def __getattr__(name: str) -> object:
    """``import pilotfish; pilotfish.vision``: without a second import, and without loading what is not used."""
    import importlib  # not above: until the command line has come to its handlers, Ctrl-C prints a traceback
    import pkgutil

    if not name.startswith("_") and any(module.name == name for module in pkgutil.iter_modules(__path__)):
        return importlib.import_module(f"{__name__}.{name}")
    raise AttributeError(f"module 'pilotfish' has no attribute '{name}'")

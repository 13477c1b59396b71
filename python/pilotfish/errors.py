"""What can go wrong that whoever called us can mend. Each kind has the exit code that the command line ends
with; they are those of sysexits.h, as in the C++ programs."""

from __future__ import annotations


class PilotfishError(Exception):
    """The message says what is wrong and, where it is known, what to do."""

    exit_code = 1


class RecordingError(PilotfishError, ValueError):
    """A file that is not a recording; the message says which line or column."""

    exit_code = 65


class BodyLearningError(PilotfishError, ValueError):
    """A video from which a body cannot be learned; the message says what to film or to say instead."""

    exit_code = 65


class CalibrationError(PilotfishError, ValueError):
    """Pictures from which a camera, or where it sits, cannot be calibrated; the message says what to film instead."""

    exit_code = 65


class CameraError(CalibrationError):
    """A camera that cannot be opened, or that has ended; the message says which cameras there are. Retrying may
    help."""

    exit_code = 69


class MissingFileError(PilotfishError, FileNotFoundError):
    """A file or shipped data file that is not there."""

    exit_code = 66


class ExistsError(PilotfishError, FileExistsError):
    """Something stands where something new is to be written; the message says what to do. Nothing was overwritten."""

    exit_code = 74


class ExecutableNotFoundError(PilotfishError, FileNotFoundError):
    """A program of ours that is nowhere; the message lists where it was looked for."""

    exit_code = 69


class MissingPackageError(PilotfishError, ImportError):
    """A Python package that only this needs, and that is not installed; the message says how to get it."""

    exit_code = 69


class SilentRobotError(PilotfishError, RuntimeError):
    """No robot of that name answers on the bus; the message says where and for how long."""

    exit_code = 69


class OperatorError(PilotfishError, RuntimeError):
    """A coordinator that answers, but does not comply; the message has its reason and its status."""

    exit_code = 70


class HarnessError(PilotfishError, RuntimeError):
    """A run that did not come about; the message has the command and the end of what the program said."""

    exit_code = 70


class CampaignError(PilotfishError, RuntimeError):
    """A campaign that cannot go on: workers that are gone or other, results of another campaign. What is done stays."""

    exit_code = 74


class ConfigError(PilotfishError, ValueError):
    """A configuration, scenario or fuzzy controller that cannot be used; the message names the key.

    ``key`` is its dotted path (``control.limits.max_linear_mps``); None where no single key is at fault.
    """

    key: str | None = None

    exit_code = 78


class UsageError(ConfigError):
    """An argument, or an option of a command, that cannot be used; no file is at fault. The message names it."""

    exit_code = 64

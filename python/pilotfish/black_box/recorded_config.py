"""The configuration that a recording holds: of another program, or damaged, if it is refused."""

from __future__ import annotations

import re

from pilotfish import blackbox
from pilotfish.black_box import messages
from pilotfish.black_box.log import Event
from pilotfish.coordinator import CoordinatorFile, load_bundle
from pilotfish.errors import ConfigError, RecordingError
from pilotfish.lcmtypes.pilotfish import box_start_t

_UNPACKED = re.compile(r"/\S*/pilotfish-\w{6}/((\d+)\.\w+|[\w.]+)")  # where load_bundle puts a recorded file meanwhile


def recorded_config(event: Event, message: box_start_t) -> CoordinatorFile:
    """What the coordinator was configured with. RecordingError where this very program has accepted what it now
    refuses: bits of it have changed since. ConfigError for another program's."""
    try:
        return load_bundle(messages.bundle_of(message))
    except ValueError as error:
        if "temporary folder" in str(error):
            raise
        said = _UNPACKED.sub(lambda match: _name(message, match), str(error))
        if message.program != blackbox.program_description() and "UTF-8" not in said:
            raise ConfigError(
                f"recorded by '{message.program}', whose configuration this program refuses: {said}"
            ) from error
        raise RecordingError(
            f"{event.file}: the recording is damaged at byte {event.offset}, in what the coordinator was configured "
            f"with: {said}; other files of its ring have copies of their own"
        ) from error


def _name(message: box_start_t, match: re.Match[str]) -> str:
    """Of the file as it was recorded."""
    if match[2] is not None:
        number = int(match[2])
        return f"'{message.files[number].name}'" if number < len(message.files) else "a file"
    return next((f"'{file.name}'" for file in message.files if file.role == "config"), match[1])

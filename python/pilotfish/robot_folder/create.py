"""Makes the folder: everything is written beside it first and put in place at once, so that no half of one is left."""

from __future__ import annotations

import getpass
import grp
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from pilotfish.errors import ConfigError, ExistsError, MissingFileError
from pilotfish.files import read_text
from pilotfish.harness.executables import BASE, COORDINATOR, find_executable
from pilotfish.robot_folder import configs, units
from pilotfish.robot_folder.readme import readme
from pilotfish.whole_files import folder_for


@dataclass(frozen=True)
class Options:
    """What a user may say of a new robot."""

    source: str = "camera:0"  # of the coordinator
    calibration: Path | None = None  # the camera's; None: the simulated one's, to be replaced
    leader: Path | None = None  # None: an example, to be replaced
    user: str | None = None  # of the services; None: who runs this, by sudo if need be


def planned(name: str, folder: Path, options: Options) -> dict[str, str]:
    """The files by their names in the folder, which need not be there. ConfigError for what cannot be used."""
    from pilotfish.bus import channel

    channel(name, "STATUS")  # ConfigError for what is no name
    folder = Path(os.path.abspath(folder))  # noqa: PTH100 - resolve() would follow links, which may be changed on purpose
    if problem := units.unusable(folder):
        raise ConfigError(problem)
    user, group = _user_and_group(options.user)
    calibration, calibration_text = _calibration(options.calibration)
    text = configs.coordinator(name, options.source).replace(
        "calibration: calibration.yaml", f"calibration: {calibration}"
    )

    def service(program: str, config: str) -> units.Service:
        found = Path(os.path.abspath(find_executable(program)))  # noqa: PTH100
        return units.Service(name, folder, found, folder / config, user, group)

    return {
        f"{name}.yaml": text,
        calibration: calibration_text,
        "leader.yaml": _leader(options.leader),
        "fuzzy.yaml": configs.fuzzy(),
        "base.yaml": configs.base(name),
        "wheel_driver.py": configs.wheel_driver(name),
        f"systemd/pilotfish-{name}-coordinator.service": units.coordinator_unit(service(COORDINATOR, f"{name}.yaml")),
        f"systemd/pilotfish-{name}-base.service": units.base_unit(service(BASE, "base.yaml")),
        "systemd/pilotfish-lcm-route.service": units.route_unit(folder),
        "README.md": readme(name, folder, user),
    }


def create(name: str, folder: Path, options: Options = Options()) -> list[Path]:
    """Writes the folder; the files written. ExistsError if there is anything already: nothing is ever overwritten."""
    if os.path.lexists(folder) and not (folder.is_dir() and not any(folder.iterdir())):
        raise ExistsError(
            f"{folder} is there already: choose another place (--dir), or remove it; nothing is overwritten"
        )
    files = planned(name, folder, options)
    with (
        _full_disk_named(folder),
        folder_for(folder),
        tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent) as temporary,
    ):
        made = Path(temporary) / "robot"
        for file, text in files.items():
            (made / file).parent.mkdir(parents=True, exist_ok=True)
            (made / file).write_text(text)
        (made / "wheel_driver.py").chmod(0o755)
        _check(made / f"{name}.yaml")
        made.rename(folder)  # onto nothing, or onto an empty folder
    return [folder / file for file in files]


@contextmanager
def _full_disk_named(folder: Path) -> Iterator[None]:
    """What cannot be written stands in a folder of another name, which is gone when somebody reads the message."""
    try:
        yield
    except OSError as error:
        if error.errno is not None:
            raise OSError(error.errno, error.strerror, str(folder)) from error
        raise


def _check(config: Path) -> None:
    from pilotfish.coordinator import load_coordinator

    load_coordinator(str(config))


def _calibration(file: Path | None) -> tuple[str, str]:
    """Name in the folder (ViSP's files are XML), and text."""
    from pilotfish.coordinator import load_calibration

    if file is None:
        return "calibration.yaml", configs.calibration()
    _readable(file)
    try:
        load_calibration(str(file))
    except ConfigError as error:
        raise ConfigError(f"--calibration {file}: {error}") from error
    return ("calibration.xml" if file.suffix.lower() == ".xml" else "calibration.yaml"), read_text(file)


def _leader(file: Path | None) -> str:
    from pilotfish.coordinator import load_leader_body

    if file is None:
        return configs.leader()
    _readable(file)
    try:
        load_leader_body(str(file))
    except ConfigError as error:
        raise ConfigError(f"--leader {file}: {error}") from error
    return read_text(file)


def _readable(file: Path) -> None:
    if not file.is_file():
        raise MissingFileError(f"{file}: no such file")


def _user_and_group(user: str | None) -> tuple[str, str]:
    """Of the services; root only if it was asked for."""
    import pwd

    chosen = user or os.environ.get("SUDO_USER") or getpass.getuser()
    if chosen == "root" and user is None:
        chosen = "pilotfish"  # the Debian package's user
    try:
        return chosen, grp.getgrgid(pwd.getpwnam(chosen).pw_gid).gr_name
    except KeyError:
        return chosen, chosen  # it will have to be made: README.md says how

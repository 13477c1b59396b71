"""README.md of a robot's folder: what is in it, and the next steps, as commands that can be copied."""

from __future__ import annotations

import shlex
from pathlib import Path


def readme(name: str, folder: Path, user: str) -> str:
    """For a folder at the absolute path ``folder``."""

    def quoted(file: str) -> str:
        return shlex.quote(str(folder / file))

    config, channel = quoted(f"{name}.yaml"), name.upper()
    return f"""\
# {name}

Made by `pilotfish init {name}`. Every path in the configuration is relative to the file it stands in, so the folder can
be moved; the units in `systemd/` and the commands here name it, so make those anew elsewhere (`pilotfish init`).

| file | what it is | to do |
|---|---|---|
| `{name}.yaml` | the coordinator | enter where the camera sits, the distance to keep, the limits of your robot |
| `calibration.yaml` | the camera | **replace it**: it is the simulated camera's |
| `leader.yaml` | which tags the leader wears, and where | **replace it** by what yours wears |
| `fuzzy.yaml` | the fuzzy law | nothing |
| `base.yaml` | `pilotfish-base`, which drives the wheels | measure radius, track and ticks; name the serial line |
| `wheel_driver.py` | a program of your own instead, if `pilotfish-base` cannot drive it | write `turn_wheels` |
| `systemd/` | services that start with the computer | see below |

## 1. Is the machine ready?

```sh
pilotfish doctor --config {config}
```

## 2. Tags, calibration, leader

Print tags of the family tag36h11 (`pilotfish tags`), measure the side of the black square, fix them flat. Calibrate
the camera at the size you will use (`pilotfish calibrate camera`), and put the file in place of `calibration.yaml`.
Enter ids, sizes and places of the tags into `leader.yaml`, or learn them from a video of the leader turning in place:

```sh
pilotfish learn-body turn.mp4 --camera {quoted("calibration.yaml")} \\
    --tag-size 0.16 --height-of 0=0.25 --output learned.yaml
```

## 3. Look, standing still

`run: false` in `{name}.yaml` makes it look and send zeros:

```sh
pilotfish-coordinator --config {config} --json
```

`distance_m` and `bearing_rad` must be what a tape measure says. In another terminal:

```sh
pilotfish top
pilotfish doctor --following {name} --config {config}
```

## 4. Wheels, in the air

```sh
pilotfish-base --config {quoted("base.yaml")}     # driver: dry_run moves nothing; pilotfish top shows its state
pilotfish-base --config {quoted("base.yaml")} --driver serial:/dev/ttyUSB0
```

or a driver of your own: `python {quoted("wheel_driver.py")}`. Pull the coordinator's camera out: the wheels must
stop at once. End the coordinator with `kill -9`: the same.

## 5. Drive

```sh
pilotfish go {name}      # it drives as soon as it sees its leader
pilotfish stop {name}    # from any computer on the bus, always
```

## 6. As services

They run as user `{user}`, which must be there and be able to read this folder. For a user of their own:
`sudo useradd --system --groups video,dialout pilotfish`, and change `User=` and `Group=`. Recordings of a black box may
go to `/var/lib/pilotfish/{name}` and nowhere else.

```sh
sudo cp {quoted("systemd")}/pilotfish-*.service /etc/systemd/system/
sudo systemctl daemon-reload
sudo systemctl enable --now pilotfish-lcm-route pilotfish-{name}-base pilotfish-{name}-coordinator
journalctl -fu pilotfish-{name}-coordinator
```

`pilotfish-lcm-route` keeps the bus on this computer; the services let in nothing else. Channels: `{channel}_COMMAND`,
`{channel}_STATUS`, `{channel}_OBSERVATION`, `{channel}_SETPOINT`, `{channel}_BASE`.
"""

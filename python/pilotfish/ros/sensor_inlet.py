"""From ROS to a coordinator: odometry to NAME_POSE, pictures to NAME_IMAGE."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import lcm

from pilotfish.bus import channel
from pilotfish.errors import ConfigError
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.ros.conversions import pose_from_odometry
from pilotfish.ros.pictures import buffer_warning, picture_from_compressed, picture_from_image

_GRANTED = Path("/proc/sys/net/core/rmem_max")


class SensorInlet:
    """Publishes what a ROS callback hands over; from any thread. ``utime``: the message's stamp [us], which is to be on
    the clock of the images. What cannot be read is not published, and said to ``warn``: once, until something else is
    wrong."""

    def __init__(self, robot: str, lcm_url: str, warn: Callable[[str], None]) -> None:
        try:
            self._pose, self._image = channel(robot, "POSE"), channel(robot, "IMAGE")
            self._lcm = lcm.LCM(lcm_url) if lcm_url else lcm.LCM()
        except ValueError as error:
            raise ConfigError(str(error)) from error
        except RuntimeError as error:
            raise ConfigError(f"{lcm_url or '$LCM_DEFAULT_URL'}: not a bus that LCM can open") from error
        self._warn = warn
        self._said = ""

    def odometry(self, message: Any, utime: int) -> None:
        """A nav_msgs/Odometry."""
        self._publish(self._pose, pose_from_odometry, message, utime)

    def image(self, message: Any, utime: int) -> None:
        """A sensor_msgs/Image."""
        self._publish(self._image, picture_from_image, message, utime)

    def compressed(self, message: Any, utime: int) -> None:
        """A sensor_msgs/CompressedImage."""
        self._publish(self._image, picture_from_compressed, message, utime)

    def _publish(self, name: str, convert: Callable[[Any, int], Any], message: Any, utime: int) -> None:
        try:
            if utime <= 0:
                raise ValueError("header.stamp is not set: it must be when the picture was taken, or the motion held")
            converted = convert(message, utime)
        except ValueError as error:
            self._say(f"not published on {name}: {error}")
            return
        if isinstance(converted, image_t):
            self._say(buffer_warning(converted, int(_GRANTED.read_text())))
        self._lcm.publish(name, converted.encode())

    def _say(self, text: str) -> None:
        if text and text != self._said:
            self._warn(text)
            self._said = text

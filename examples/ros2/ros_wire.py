"""A DDS participant that speaks as a ROS 2 node does: topic names, types and quality of service. No ROS is needed."""

import os
from collections.abc import Callable
from typing import Annotated, Any

import messages
import typer
from cyclonedds.core import DDSException, InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from pilotfish.errors import ConfigError, SilentRobotError

MAX_DOMAIN = 232
DomainOption = Annotated[
    int | None, typer.Option(min=0, max=MAX_DOMAIN, help="ROS 2's domain. Default: $ROS_DOMAIN_ID, else 0.")
]
_BLOCKING = Policy.Reliability.Reliable(duration(milliseconds=100))
_XCDR1 = Policy.DataRepresentation(use_cdrv0_representation=True)  # what ROS 2 reads and writes


def publisher_qos(depth: int = 10) -> Qos:
    """ROS 2's default: reliable, volatile, the last ``depth`` samples."""
    return Qos(_BLOCKING, Policy.Durability.Volatile, Policy.History.KeepLast(depth), _XCDR1)


def sensor_qos(depth: int) -> Qos:
    """Best effort, as ROS 2's sensor data: matches publishers of both kinds, and nothing waits for old samples."""
    return Qos(Policy.Reliability.BestEffort, Policy.Durability.Volatile, Policy.History.KeepLast(depth), _XCDR1)


def dds_topic(ros_topic: str) -> str:
    """``/cmd_vel`` is ``rt/cmd_vel`` on the wire."""
    return f"rt/{ros_topic.removeprefix('/')}"


class Participant:
    """One participant of a ROS 2 domain."""

    def __init__(self, domain_id: int) -> None:
        self._participant = DomainParticipant(domain_id)
        self._readers: list[tuple[DataReader, Callable[[Any], None]]] = []
        self._waiting = WaitSet(self._participant)

    def writer(self, ros_topic: str, kind: type, depth: int = 10) -> DataWriter:
        """Publishes messages of ``kind``."""
        return DataWriter(self._participant, Topic(self._participant, dds_topic(ros_topic), kind), publisher_qos(depth))

    def on_message(self, ros_topic: str, kind: type, handler: Callable[[Any], None], depth: int = 5) -> None:
        """``handle`` will call ``handler`` with each message of ``kind``."""
        topic = Topic(self._participant, dds_topic(ros_topic), kind)
        reader = DataReader(self._participant, topic, sensor_qos(depth))
        condition = ReadCondition(reader, SampleState.Any | ViewState.Any | InstanceState.Any)
        self._waiting.attach(condition)
        self._readers.append((reader, handler))

    def handle(self, timeout_ms: int) -> None:
        """Waits up to ``timeout_ms``, then calls the handlers for all messages that have come."""
        self._waiting.wait(duration(milliseconds=timeout_ms))
        for reader, handler in self._readers:
            for sample in reader.take(N=8):
                if isinstance(sample, reader.topic.data_type):  # else: a publisher has ended
                    handler(sample)


def join(domain: int | None) -> Participant:
    """A participant of ``domain``; None: of $ROS_DOMAIN_ID, as ROS 2 has it."""
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if domain is None and (not text.isdecimal() or int(text) > MAX_DOMAIN):
        raise ConfigError(f"ROS_DOMAIN_ID={text} is not a number from 0 to {MAX_DOMAIN}")
    try:
        return Participant(int(text) if domain is None else domain)
    except DDSException as error:
        hint = "is a network up, and CYCLONEDDS_URI right?"
        raise SilentRobotError(f"DDS cannot be opened ({hint}): {error.msg}") from error


def stamp(utime: int) -> messages.Time:
    """Microseconds as builtin_interfaces/Time."""
    return messages.Time(sec=utime // 1_000_000, nanosec=utime % 1_000_000 * 1000)


def utime_of(time: messages.Time) -> int:
    """builtin_interfaces/Time in microseconds; what is below one is cut off."""
    return time.sec * 1_000_000 + time.nanosec // 1000

"""A second DDS participant, in a process of its own.

python ros2_peer.py listen DOMAIN TOPIC TYPE: prints "MICROSECONDS HEX" of every sample (CLOCK_BOOTTIME, CDR)
python ros2_peer.py publish DOMAIN TOPIC TYPE FILE: sends the CDR of each of its lines in turn, until it is ended
"""

import itertools
import sys
import time
from pathlib import Path

from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from dds_types import raw_type

# What rclpy's create_publisher(..., 10) and create_subscription(..., 10) ask for.
ROS2_DEFAULT = Qos(
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(10),
    Policy.DataRepresentation(use_cdrv0_representation=True),
)
PERIOD_S = 0.03


def listen(participant, topic):
    reader = DataReader(participant, topic, qos=ROS2_DEFAULT)
    waiting = WaitSet(participant)
    waiting.attach(ReadCondition(reader, SampleState.Any | ViewState.Any | InstanceState.Any))
    while True:
        waiting.wait(duration(seconds=1))
        now_us = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000
        for sample in reader.take(N=100):
            if isinstance(sample, topic.data_type):
                print(now_us, sample.cdr.hex(), flush=True)


def publish(participant, topic, samples):
    writer = DataWriter(participant, topic, qos=ROS2_DEFAULT)
    for cdr in itertools.cycle(samples):
        writer.write(topic.data_type(cdr))
        time.sleep(PERIOD_S)


if __name__ == "__main__":
    what, domain, topic_name, type_name, *files = sys.argv[1:]
    participant = DomainParticipant(int(domain))
    topic = Topic(participant, topic_name, raw_type(type_name))
    if what == "listen":
        listen(participant, topic)
    else:
        publish(participant, topic, [bytes.fromhex(line) for line in Path(files[0]).read_text().split()])

"""A second DDS participant, in a process of its own.

python ros2_peer.py listen DOMAIN TOPIC TYPE: prints "MICROSECONDS HEX" of every sample (CLOCK_BOOTTIME, CDR)
python ros2_peer.py publish DOMAIN TOPIC TYPE: sends the CDR of every line of its standard input, when a reader has
been found; prints "sent"
"""

import sys
import time

from cyclonedds.core import InstanceState as Instances
from cyclonedds.core import ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration
from ros2_definitions import dds_type

# What rclpy's create_publisher(..., 10) and create_subscription(..., 10) ask for.
ROS2_DEFAULT = Qos(
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(10),
    Policy.DataRepresentation(use_cdrv0_representation=True),
)


def listen(participant, topic):
    reader = DataReader(participant, topic, qos=ROS2_DEFAULT)
    waiting = WaitSet(participant)
    waiting.attach(ReadCondition(reader, SampleState.Any | ViewState.Any | Instances.Any))
    print("ready", flush=True)
    while True:
        waiting.wait(duration(seconds=1))
        now_us = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000
        for sample in reader.take(N=100):
            if isinstance(sample, topic.data_type):
                print(now_us, sample.cdr.hex(), flush=True)


def publish(participant, topic):
    writer = DataWriter(participant, topic, qos=ROS2_DEFAULT)
    for line in sys.stdin:
        give_up_s = time.monotonic() + 15
        while not writer.get_matched_subscriptions():
            if time.monotonic() > give_up_s:
                sys.exit("no reader was found")
            time.sleep(0.01)
        writer.write(topic.data_type(bytes.fromhex(line)))
        print("sent", flush=True)


if __name__ == "__main__":
    what, domain, topic_name, type_name = sys.argv[1:]
    participant = DomainParticipant(int(domain))
    topic = Topic(participant, topic_name, dds_type(type_name, raw=True))
    {"listen": listen, "publish": publish}[what](participant, topic)

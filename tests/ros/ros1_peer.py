"""A second ROS 1 node, in a process of its own. Needs nothing of Pilotfish.

python ros1_peer.py listen TOPIC TYPE: prints "MICROSECONDS HEX" of every message (CLOCK_BOOTTIME, ROS 1's encoding)
python ros1_peer.py publish TOPIC TYPE FILE: sends each of its lines in turn, until it is ended
"""

import itertools
import sys
import time
from pathlib import Path

import roslib.message
import rospy

PERIOD_S = 0.03


def listen(topic, kind):
    def on_message(message):
        now_us = time.clock_gettime_ns(time.CLOCK_BOOTTIME) // 1000
        print(now_us, message._buff.hex(), flush=True)

    rospy.Subscriber(topic, rospy.AnyMsg, on_message, tcp_nodelay=True)
    rospy.spin()


def publish(topic, kind, messages):
    publisher = rospy.Publisher(topic, kind, queue_size=10)
    for data in itertools.cycle(messages):
        if rospy.is_shutdown():  # SIGTERM ends rospy, not this
            break
        message = kind()
        message.deserialize(data)
        publisher.publish(message)
        time.sleep(PERIOD_S)


if __name__ == "__main__":
    what, topic, type_name, *files = sys.argv[1:]
    rospy.init_node("peer", anonymous=True)
    kind = roslib.message.get_message_class(type_name)
    if what == "listen":
        listen(topic, kind)
    else:
        publish(topic, kind, [bytes.fromhex(line) for line in Path(files[0]).read_text().split()])

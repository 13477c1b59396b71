"""Looks at robots on the bus without taking part: what ``pilotfish top`` and ``pilotfish doctor --following`` read.

from pilotfish import watching
for message in watching.watch("", seconds=1.0):
    print(message.arrival_s, message.robot, message.kind)
"""

from pilotfish.watching.feed import IMAGE_FINGERPRINT, Feed, ImageHead, Kind, Message, parse, watch

__all__ = ["IMAGE_FINGERPRINT", "Feed", "ImageHead", "Kind", "Message", "parse", "watch"]

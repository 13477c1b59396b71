"""What the pictures on the bus show, looked at here: a coordinator tells only of its own leader's tags."""

from __future__ import annotations

from dataclasses import dataclass

from pilotfish.doctor.following.watch import Watched
from pilotfish.watching.pictures import gray, ids_in_view

DEFAULT_FAMILY = "tag36h11"


@dataclass(frozen=True)
class InView:
    """Of some pictures: how many there were, the ids in at least one of them, and how bright they are (0 to 255)."""

    images: int
    ids: tuple[int, ...]
    mean_level: float | None


def look(watched: Watched, channel: str, family: str = DEFAULT_FAMILY) -> InView | None:
    """None without a readable picture on the channel."""
    images = watched.images.get(channel)
    pictures = [picture for head in images.samples if (picture := gray(head)) is not None] if images else []
    if not pictures:
        return None
    mean_level = sum(float(picture.mean()) for picture in pictures) / len(pictures)
    # One that is seen in a single picture of many may be clutter that happens to read as a tag.
    least = 1 if len(pictures) < 4 else 2
    ids = tuple(tag for tag, count in ids_in_view(pictures, family).items() if count >= least)
    return InView(len(pictures), ids, mean_level)

"""What the frames show: every tag in every picture, as four corners."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from pilotfish.core import BodyTag, CameraModel, Frame, LeaderBody, Reason
from pilotfish.errors import BodyLearningError
from pilotfish.vision import TagDetector, TagMeasurement, TagTracker

MAX_TAGS = 12  # on one body
MIN_SIGHTINGS = 3  # of an id; what is seen more rarely is a misreading
# A tag's own frame: x right and y down as one reads it; corners from the bottom left, counter-clockwise.
UNIT_CORNERS = np.array([[-0.5, 0.5, 0.0], [0.5, 0.5, 0.0], [0.5, -0.5, 0.0], [-0.5, -0.5, 0.0]])


@dataclass(frozen=True)
class TagSizes:
    """Sides of the black squares [m]: by id, and for all others ``default_m``, if there is one."""

    default_m: float | None = None
    by_id: Mapping[int, float] | None = None

    def of(self, tag_id: int) -> float | None:
        """Side of that tag's black square [m]; None if it is not known."""
        return (self.by_id or {}).get(tag_id, self.default_m)


@dataclass(frozen=True)
class Sightings:
    """S sightings of T tags in N frames.

    ``frame`` (S,): 0 to N - 1; ``tag`` (S,): place in ``ids``; ``corners_px`` (S, 4, 2): AprilTag's order;
    ``ids`` (T,): sorted; ``sizes_m`` (T,).
    """

    frame: np.ndarray
    tag: np.ndarray
    corners_px: np.ndarray
    ids: np.ndarray
    sizes_m: np.ndarray

    def __len__(self) -> int:
        return len(self.frame)

    @property
    def frame_count(self) -> int:
        """N; 0 without sightings."""
        return int(self.frame.max()) + 1 if len(self) else 0

    @property
    def corners_m(self) -> np.ndarray:
        """(S, 4, 3): the corners of each sighting's tag in the tag's own frame."""
        return UNIT_CORNERS * self.sizes_m[self.tag, None, None]

    def where(self, kept: np.ndarray) -> Sightings:
        """The sightings for which ``kept`` (S,) holds; frames and tags without any disappear."""
        _, frame = np.unique(self.frame[kept], return_inverse=True)
        tags, tag = np.unique(self.tag[kept], return_inverse=True)
        return Sightings(frame, tag, self.corners_px[kept], self.ids[tags], self.sizes_m[tags])

    def seen_together(self) -> np.ndarray:
        """(S,): whether another tag was seen in the same frame."""
        return np.bincount(self.frame, minlength=self.frame_count)[self.frame] > 1


@dataclass(frozen=True)
class Collected:
    """The sightings of a video, and what was left out of them."""

    sightings: Sightings
    frames_read: int
    frames_undecodable: int
    rare_ids: tuple[int, ...]  # seen in fewer than MIN_SIGHTINGS frames, hence not accepted
    frame_numbers: np.ndarray  # (N,): which frames, counted from 0, the N of the sightings are


def collect_sightings(
    frames: Iterable[Frame],
    camera: CameraModel,
    sizes: TagSizes,
    *,
    family: str = "tag36h11",
    every: int = 1,
    ignored_ids: frozenset[int] = frozenset(),
    on_frame: Callable[[int], None] | None = None,
) -> Collected:
    """Detects tags in every ``every``-th frame. An id that is seen twice in one picture is left out of it.

    Raises BodyLearningError: frames of another size than the calibration's, no tag, an id without a size.
    """
    corners_in = corner_finder(camera, family, ignored_ids)
    found: list[tuple[int, int, np.ndarray]] = []
    read = undecodable = 0
    for number, frame in enumerate(frames):
        if on_frame:
            on_frame(number + 1)
        if number % every:
            continue
        read += 1
        if frame.defect != Reason.none:
            undecodable += 1
            continue
        check_size(frame, number, camera)
        found += [(number, tag_id, corners_px) for tag_id, corners_px in corners_in(frame)]
    if not found:
        raise no_tag(family, read)
    return checked(found, sizes, read, undecodable)


def corner_finder(
    camera: CameraModel, family: str, ignored_ids: frozenset[int]
) -> Callable[[Frame], list[tuple[int, np.ndarray]]]:
    """A function from a frame to its tags: (id, corners (4, 2) px). An id that is seen twice in it is left out."""
    detector = TagDetector(family)
    trackers: dict[int, TagTracker] = {}  # of bodies with one tag: which ids are on the robot is not known yet

    def corners_in(frame: Frame) -> list[tuple[int, np.ndarray]]:
        tags = [tag for tag in detector.detect(frame.image).tags if tag.id not in ignored_ids]
        ids = [tag.id for tag in tags]
        found = []
        for tag in tags:
            if ids.count(tag.id) > 1:
                continue
            # The detector's corners are off by a tenth of a pixel, in much the same way in every frame; those of the
            # fitted print are not. A tag that does not fit its print is half hidden, or blurred: better without it.
            if tag.id not in trackers:
                trackers[tag.id] = TagTracker(camera=camera, body=LeaderBody([BodyTag(id=tag.id)], family=family))
            tracker = trackers[tag.id]
            fitted = tracker.track(frame.image, tracker.predict_at(tag.id, corners_px=tag.corners_px))
            if isinstance(fitted, TagMeasurement):
                found.append((tag.id, fitted.tag.corners_px))
        return found

    return corners_in


def check_size(frame: Frame, number: int, camera: CameraModel) -> None:
    """BodyLearningError unless the frame has the size that the camera was calibrated with."""
    if (frame.width, frame.height) != (camera.width, camera.height):
        raise BodyLearningError(
            f"frame {number} has {frame.width}x{frame.height} px, the camera was calibrated with "
            f"{camera.width}x{camera.height}: film at the calibration's size, or calibrate at the film's"
        )


def no_tag(family: str, read: int) -> BodyLearningError:
    """What to say if no tag was seen in ``read`` frames."""
    return BodyLearningError(
        f"no {family} tag in any of {read} frames: film nearer (a tag's side should span 40 pixels or more), with "
        "more light and without motion blur, and check --family"
    )


def check_known(ids: Iterable[int], sizes: TagSizes) -> None:
    """BodyLearningError if an id has no size."""
    unknown = [i for i in ids if sizes.of(i) is None]
    if unknown:
        raise BodyLearningError(
            f"no size is given for {_named(unknown)}: add "
            + " ".join(f"--tag-size {i}=METRES" for i in unknown)
            + ", or --ignore ID if it is not on the robot"
        )


def checked(found: list[tuple[int, int, np.ndarray]], sizes: TagSizes, read: int, undecodable: int) -> Collected:
    """Sightings of ``found``, (frame, id, corners) each and at least one. BodyLearningError: an id without a size, or
    too many."""
    frame, tag_id = (np.array(column) for column in list(zip(*found, strict=True))[:2])
    ids, counts = np.unique(tag_id, return_counts=True)
    rare = tuple(ids[counts < MIN_SIGHTINGS].tolist())
    check_known((i for i in ids.tolist() if i not in rare), sizes)
    sizes_m = np.array([sizes.of(i) or np.nan for i in ids.tolist()])
    everything = Sightings(
        frame, np.searchsorted(ids, tag_id), np.array([corners for *_, corners in found]), ids, sizes_m
    )
    is_accepted = ~np.isin(tag_id, rare)
    accepted = everything.where(is_accepted)
    if not len(accepted):
        raise BodyLearningError(
            f"{_named(rare)}: seen in fewer than {MIN_SIGHTINGS} frames each, of {read}: film for longer"
        )
    if len(accepted.ids) > MAX_TAGS:
        raise BodyLearningError(
            f"{len(accepted.ids)} ids were seen ({_named(accepted.ids.tolist())}), a body wears at most {MAX_TAGS}: "
            "name those that are not on the robot with --ignore ID"
        )
    return Collected(accepted, read, undecodable, rare, np.unique(frame[is_accepted]))


def _named(ids: Iterable[int]) -> str:
    ids = list(ids)
    return ("tag " if len(ids) == 1 else "tags ") + ", ".join(map(str, ids))

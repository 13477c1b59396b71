"""From pictures to views of the board: all pictures of a folder, the worthwhile ones of a film or a camera."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from pilotfish.calibration.camera import views as kinds
from pilotfish.calibration.camera.choosing import CHOSEN, KNOWN, MOVED, NOTHING, Chosen, Corners, consider
from pilotfish.calibration.camera.coverage import Coverage, coverage_of, tilts_of
from pilotfish.calibration.camera.detector import BoardDetector
from pilotfish.calibration.camera.fit import MIN_VIEWS, fit_lens, uncertainty
from pilotfish.calibration.camera.other_model import compare_models
from pilotfish.calibration.camera.pictures import Pictures
from pilotfish.calibration.camera.verdict import GOOD, judge
from pilotfish.calibration.camera.views import BoardView, Rejected
from pilotfish.errors import CalibrationError

DIAGNOSED = 10  # pictures of a film without a board that are looked at more closely
DIAGNOSE_EVERY = 15
FIRST_FIT_VIEWS = 6


@dataclass
class Found:
    """``views``: BoardView or Rejected of each picture that counts, in order; ``size``: (width, height) of the
    pictures; ``read``: how many there were; ``outcomes``: of a film, how many pictures came to what."""

    views: list[BoardView | Rejected] = field(default_factory=list)
    size: tuple[int, int] = (0, 0)
    read: int = 0
    outcomes: Counter[str] = field(default_factory=Counter)

    @property
    def usable(self) -> list[BoardView]:
        """The views with a board."""
        return [each for each in self.views if isinstance(each, BoardView)]


@dataclass(frozen=True)
class Progress:
    """While a camera runs: how many views there are, where the board was seen, what came of the last picture, and what
    to do next."""

    views: int
    coverage: Coverage
    last: str
    advice: str
    corners_px: np.ndarray  # (P, 2) of the last picture


def every_picture(
    pictures: Pictures, detector: BoardDetector, on_picture: Callable[[int, int | None], None] | None = None
) -> Found:
    """Every picture counts: a folder's."""
    found = Found()
    for picture in pictures:
        found.read += 1
        if picture.image is None:
            found.views.append(Rejected(picture.name, kinds.UNREADABLE, "it cannot be decoded: is the file damaged?"))
        else:
            found.size = (picture.image.shape[1], picture.image.shape[0])
            found.views.append(detector.detect(picture.image, picture.name))
        if on_picture:
            on_picture(found.read, pictures.total)
    return found


def worthwhile_pictures(
    pictures: Pictures,
    detector: BoardDetector,
    *,
    wanted: int,
    every: int = 1,
    model: str = "pinhole",
    until_good: bool = False,
    on_progress: Callable[[Progress], None] | None = None,
    on_picture: Callable[[int, int | None], None] | None = None,
) -> Found:
    """Of a film: views in which the board is still and held as never before, at most ``wanted``.

    ``until_good``, for a camera: it ends as soon as the verdict on the views so far is "good". Ctrl-C
    (KeyboardInterrupt) ends it, too, with the views that there are.
    """
    found, chosen, closer = Found(), Chosen(), 0
    coverage, advice = coverage_of([], (1, 1)), "show the board to the camera"
    try:
        for picture in pictures:
            found.read += 1
            if on_picture:
                on_picture(found.read, pictures.total)
            if picture.image is None or (found.read - 1) % every:
                continue
            found.size = (picture.image.shape[1], picture.image.shape[0])
            seen = Corners(*detector.rough(picture.image))
            chosen, outcome = consider(chosen, seen, found.size[0])
            found.outcomes[outcome] += 1
            if outcome == NOTHING and closer < DIAGNOSED and found.outcomes[NOTHING] % DIAGNOSE_EVERY == 1:
                closer += 1
                refused = detector.detect(picture.image, picture.name)
                if isinstance(refused, Rejected) and refused.why != kinds.NO_BOARD:
                    found.views.append(refused)
            done = False
            if outcome == CHOSEN:
                found.views.append(detector.detect(picture.image, picture.name, diagnose=False))
                coverage = coverage_of(found.usable, found.size)
                done = len(found.usable) >= wanted
                if until_good or on_progress:
                    advice, good = _advice(found, coverage, model)
                    done = done or (until_good and good)
            if on_progress:
                on_progress(Progress(len(found.usable), coverage, outcome, advice, seen.corners_px))
            if done:
                break
    except KeyboardInterrupt:
        pass
    return found


def check_film(found: Found) -> None:
    """CalibrationError if a film led to too few views although the board is in it: it says what the board did."""
    refused = any(isinstance(each, Rejected) for each in found.views)
    if len(found.usable) >= MIN_VIEWS or refused:
        return
    counted = ", ".join(f"{count} {what}" for what, count in found.outcomes.most_common()) or "none looked at"
    hint = "show the board to the camera, all of it in focus"
    if found.outcomes[MOVED] or found.outcomes[KNOWN]:
        hint = (
            "hold the board still for a moment in every new place (two pictures running, of those that --every looks "
            "at)"
        )
    raise CalibrationError(
        f"{found.read} pictures ({counted}) gave {len(found.usable)} views of the board, {MIN_VIEWS} are needed at "
        f"least, "
        f"20 or more are good: {hint}"
    )


def _advice(found: Found, coverage: Coverage, model: str) -> tuple[str, bool]:
    """What the verdict on the views so far wants next, and whether it is good."""
    views = found.usable
    if len(views) < FIRST_FIT_VIEWS:
        return (
            "hold the board tilted, each time to another side, all over the picture; keep it still for a moment",
            False,
        )
    try:
        fit = fit_lens(views, found.size, model, with_k3=False)
    except CalibrationError:
        return "tilt the board more, to different sides", False
    blur_px = float(np.median([v.blur_px for v in views]))
    known, tilts = uncertainty(views, fit), tilts_of(fit)
    verdict = judge(fit, known, coverage, tilts, 0.0, blur_px)
    if verdict.grade == GOOD:  # a second fit, and only where it decides
        verdict = judge(fit, known, coverage, tilts, 0.0, blur_px, other=compare_models(views, fit))
    return verdict.reasons[-1] if verdict.reasons else "good", verdict.grade == GOOD

"""Learning where the tags of a leader sit, from a video of it turning in front of a calibrated camera.

``collect_sightings`` finds the tags' corners; ``learn_body`` lets every frame's pose of the body and every tag's pose
on it be what explains all corners best (bundle adjustment), and hangs the result on the body's base frame: on the
turning axis, or on one tag whose place is known; ``write_leader_body`` writes the YAML.
"""

from pilotfish.calibration.body.base_frame import KnownTag, TurningCentre
from pilotfish.calibration.body.leader_file import write_leader_body
from pilotfish.calibration.body.learn import LearnedBody, LearnedTag, learn_body
from pilotfish.calibration.body.sightings import Collected, Sightings, TagSizes, collect_sightings

__all__ = [
    "Collected",
    "KnownTag",
    "LearnedBody",
    "LearnedTag",
    "Sightings",
    "TagSizes",
    "TurningCentre",
    "collect_sightings",
    "learn_body",
    "write_leader_body",
]

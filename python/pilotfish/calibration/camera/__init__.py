"""Calibrating a camera with a printed board: focal length, principal point, distortion, and what they are worth.

``open_pictures`` and ``every_picture`` or ``worthwhile_pictures`` find a board (``BoardDetector``);
``calibrate_camera`` fits a lens, leaves out what does not fit, tests it on views that it has not seen and gives a
verdict; ``write_calibration`` writes the file that a coordinator reads, and checks that it is read as it is meant.
"""

from pilotfish.calibration.camera.board_spelling import board_of
from pilotfish.calibration.camera.calibrate import CameraCalibration, calibrate_camera
from pilotfish.calibration.camera.calibration_file import write_calibration
from pilotfish.calibration.camera.collect import Found, Progress, check_film, every_picture, worthwhile_pictures
from pilotfish.calibration.camera.detector import BoardDetector
from pilotfish.calibration.camera.fit import Fit, fit_best, fit_lens
from pilotfish.calibration.camera.lens import MODELS, Lens
from pilotfish.calibration.camera.other_model import OtherModel, compare_models
from pilotfish.calibration.camera.pictures import CAMERA, FOLDER, VIDEO, open_pictures
from pilotfish.calibration.camera.verdict import AGAIN, GOOD, USABLE, Verdict
from pilotfish.calibration.camera.views import BoardView, Rejected

__all__ = [
    "AGAIN",
    "CAMERA",
    "FOLDER",
    "GOOD",
    "MODELS",
    "USABLE",
    "VIDEO",
    "BoardDetector",
    "BoardView",
    "CameraCalibration",
    "Fit",
    "Found",
    "Lens",
    "OtherModel",
    "Progress",
    "Rejected",
    "Verdict",
    "board_of",
    "calibrate_camera",
    "check_film",
    "compare_models",
    "every_picture",
    "fit_best",
    "fit_lens",
    "open_pictures",
    "worthwhile_pictures",
    "write_calibration",
]

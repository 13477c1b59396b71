"""Pictures to rehearse a calibration with, and the truth that it should find: of boards, of a robot that turns and
drives before a tag, of a leader that turns.

Boards are drawn here, through a lens that is written out once more; tags by ``pilotfish.sim.Renderer``. What is written
as truth is of the same kind as what the calibration writes: a camera's calibration, a mounting, a leader.
"""

from pilotfish.calibration.rehearsal.board_picture import BoardPose, PictureFlaws, board_texture, render_board
from pilotfish.calibration.rehearsal.board_poses import board_poses
from pilotfish.calibration.rehearsal.differences import (
    Difference,
    board_middles,
    body_differences,
    camera_differences,
    check_comparable,
    mounting_differences,
)
from pilotfish.calibration.rehearsal.mounting_drive import DriveSettings, MountingDrive, drive_shots, plan_drive
from pilotfish.calibration.rehearsal.outlets import Pose, Shot, write_film, write_folder, write_log
from pilotfish.calibration.rehearsal.true_camera import TrueCamera, read_true_camera, write_true_camera
from pilotfish.calibration.rehearsal.true_mounting import read_true_mounting, write_true_mounting
from pilotfish.calibration.rehearsal.turning_leader import TurningLeader, plan_turn, turn_shots, with_wrong_faces

__all__ = [
    "BoardPose",
    "Difference",
    "DriveSettings",
    "MountingDrive",
    "PictureFlaws",
    "Pose",
    "Shot",
    "TrueCamera",
    "TurningLeader",
    "board_middles",
    "board_poses",
    "board_texture",
    "body_differences",
    "camera_differences",
    "check_comparable",
    "drive_shots",
    "mounting_differences",
    "plan_drive",
    "plan_turn",
    "read_true_camera",
    "read_true_mounting",
    "render_board",
    "turn_shots",
    "with_wrong_faces",
    "write_film",
    "write_folder",
    "write_log",
    "write_true_camera",
    "write_true_mounting",
]

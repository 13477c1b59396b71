"""Pictures to rehearse a calibration with: of boards, of a robot that turns and drives before a tag, of a leader that
turns; with the truth that a calibration should find.

``render_board`` and ``board_poses`` are for boards, whose lens is written out once more in ``lens``; tags are drawn by
``pilotfish.sim.Renderer``.
"""

from pilotfish.calibration.rehearsal.board_picture import BoardPose, PictureFlaws, board_texture, render_board
from pilotfish.calibration.rehearsal.board_poses import board_poses

__all__ = ["BoardPose", "PictureFlaws", "board_poses", "board_texture", "render_board"]

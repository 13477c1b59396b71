"""Corners of boards in pictures: how exactly they are found, and what is said of pictures without the board."""

import cv2
import numpy as np
import pytest
from board_views import CHARUCO, CHESSBOARD
from rendered_boards import TrueCamera, corners_seen, poses, render

from pilotfish.calibration.board import Board
from pilotfish.calibration.camera import BoardDetector, BoardView, Rejected, board_of
from pilotfish.calibration.camera.corner_fit import fit_corners
from pilotfish.errors import PilotfishError

CAMERA = TrueCamera()


def picture(board, seed=1, number=0, **how):
    pose = poses(board, CAMERA, number + 1, seed, spread=0.3)[number]
    return render(board, CAMERA, pose, seed=seed, **how), corners_seen(board, CAMERA, pose)


@pytest.mark.parametrize("board", [CHARUCO, CHESSBOARD], ids=["charuco", "chessboard"])
def test_corners_are_found_to_hundredths_of_a_pixel(board):
    errors, opencv = [], []
    for number in range(3):
        image, true = picture(board, number=number)
        view = BoardDetector(board).detect(image)
        assert isinstance(view, BoardView), view
        if board.kind == "chessboard":  # it looks the same when turned by half a turn
            true = min(true, true[::-1], key=lambda each: np.abs(each[view.ids] - view.corners_px).max())
        errors.append(view.corners_px - true[view.ids])
        rough = cv2.cornerSubPix(
            image, true[view.ids].astype(np.float32).reshape(-1, 1, 2), (5, 5), (-1, -1), (3, 40, 1e-3)
        )
        opencv.append(rough.reshape(-1, 2) - true[view.ids])
    # Noise of 2 gray levels on edges of 190: the fit's own bound is near 0.005 px; cornerSubPix reaches 0.02 to 0.2.
    rms = np.sqrt((np.concatenate(errors) ** 2).mean())
    assert rms < 0.02
    assert rms < 0.7 * np.sqrt((np.concatenate(opencv) ** 2).mean())


@pytest.mark.parametrize("shift", [(0.0, 0.0), (0.3, -0.45), (-0.5, 0.5)])
@pytest.mark.parametrize("sigma_px", [0.5, 1.5])
def test_a_corner_drawn_by_its_formula_is_found_where_it_was_drawn(shift, sigma_px):
    # An independent drawing: each pixel is the mean of 8 x 8 samples of sharp squares, blurred by scipy.
    from scipy.ndimage import gaussian_filter

    n, size = 8, 41
    u = (np.arange(size * n) + 0.5) / n - 0.5
    x, y = np.meshgrid(u - 20.0 - shift[0], u - 20.0 - shift[1])
    angle = np.radians(12.0)
    a, b = x * np.cos(angle) + y * np.sin(angle), -x * np.sin(angle) + y * np.cos(angle)
    sharp = np.where((a > 0) == (b > 0), 40.0, 200.0)
    image = gaussian_filter(sharp, sigma_px * n).reshape(size, n, size, n).mean(axis=(1, 3))
    edges = 18.0 * np.array([[[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]])
    found = fit_corners(np.rint(image).astype(np.uint8), np.array([[20.0, 20.0]]), edges)
    assert found.fitted.all()
    np.testing.assert_allclose(found.corners_px[0], np.array([20.0, 20.0]) + shift, atol=0.01)
    # A pixel's own width adds its variance, 1 / 12.
    np.testing.assert_allclose(found.sigma_px[0], np.sqrt(sigma_px**2 + 1 / 12), rtol=0.05)


def test_what_is_no_corner_is_not_fitted():
    rng = np.random.default_rng(1)
    noise = np.clip(rng.normal(120, 3, (60, 60)), 0, 255).astype(np.uint8)
    edges = np.tile(np.array([[20.0, 0.0], [0.0, 20.0]]), (2, 1, 1))
    found = fit_corners(noise, np.array([[30.0, 30.0], [1.0, 1.0]]), edges)
    assert not found.fitted.any()


def test_a_mirrored_picture_is_said_to_be_mirrored():
    image, _ = picture(CHARUCO)
    refused = BoardDetector(CHARUCO).detect(image[:, ::-1].copy(), "selfie.png")
    assert isinstance(refused, Rejected)
    assert (refused.name, refused.why) == ("selfie.png", "mirrored")


@pytest.mark.parametrize(
    ("told", "shown", "said"),
    [
        (Board("charuco", 7, 5, 0.03, 0.022, "DICT_4X4_100"), CHARUCO, "7 x 5 squares and markers 0 to 16"),
        (Board("charuco", 6, 8, 0.03, 0.022, "DICT_4X4_100"), CHARUCO, "6 x 8 squares"),
        (Board("chessboard", 8, 6, 0.03), CHESSBOARD, "a chessboard of 9 x 7 squares was seen"),
    ],
)
def test_a_board_of_another_size_is_said_to_be_one(told, shown, said):
    image, _ = picture(shown)
    refused = BoardDetector(told).detect(image)
    assert isinstance(refused, Rejected)
    assert (refused.why, said in refused.detail) == ("another board", True), refused


def test_an_older_layout_is_recognised():
    from pilotfish.calibration.camera.detector import opencv_board

    drawn = opencv_board(CHARUCO, legacy=True).generateImage((480, 360), marginSize=20)
    refused = BoardDetector(CHARUCO).detect(drawn)
    assert isinstance(refused, Rejected)
    assert "OpenCV before 4.6" in refused.detail


def test_a_part_of_a_charuco_board_is_enough_and_a_corner_of_it_is_not():
    image, _ = picture(CHARUCO)
    view = BoardDetector(CHARUCO).detect(np.where(np.arange(640) < 330, image, 120).astype(np.uint8))
    assert isinstance(view, BoardView)
    assert 7 <= len(view) < 35
    empty = BoardDetector(CHARUCO).detect(np.full((480, 640), 120, np.uint8))
    assert isinstance(empty, Rejected)
    assert empty.why == "no board"


def test_markers_of_another_size_than_told_are_noticed():
    from pilotfish.calibration.camera.verdict import marker_note

    image, _ = picture(CHARUCO)
    told_wrong = Board("charuco", 8, 6, 0.03, 0.015, "DICT_4X4_100")
    share = BoardDetector(CHARUCO).detect(image).marker_share
    assert marker_note(CHARUCO, [share]) is None
    assert "0.50" in marker_note(told_wrong, [share])


@pytest.mark.parametrize("text", ["charuco:8x6:30mm:22mm", "charuco:8x6:3cm:0.022m:DICT_4X4_100"])
def test_a_board_can_be_spelled_in_one_word(text):
    assert board_of(text) == CHARUCO


@pytest.mark.parametrize(
    "text",
    [
        "charuco:8x6",
        "charuco:8x6:30:22",
        "chessboard:9x7:25mm:1mm",
        "charuco:8x6:30mm:29mm",
        "chessboard:2x2:25mm",
        "x",
    ],
)
def test_a_board_that_is_none_is_refused(text):
    with pytest.raises(PilotfishError, match=r"board|x"):
        board_of(text)

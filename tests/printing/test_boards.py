"""Calibration boards: what OpenCV finds on the printed page is what its own description of the board says."""

from __future__ import annotations

import numpy as np
import pytest
from rasters import pages_of, rim, ruler_mm, run, words_of

from pilotfish.calibration.board import Board, read_board
from pilotfish.errors import ConfigError
from pilotfish.printing import board_pages, parse_paper, write_pdf

cv2 = pytest.importorskip("cv2")
DPI = 150

CHARUCO = [
    (Board("charuco", 8, 6, 0.03, 0.022, "DICT_4X4_100"), "A4"),
    (Board("charuco", 5, 7, 0.03, 0.022, "DICT_5X5_50"), "A4"),
    (Board("charuco", 7, 5, 0.03, 0.024, "DICT_6X6_250"), "Letter"),
    (Board("charuco", 9, 4, 0.02, 0.015, "DICT_7X7_1000"), "Letter"),
]
CHESSBOARDS = [(Board("chessboard", 10, 7, 0.025), "A4"), (Board("chessboard", 7, 9, 0.025), "Letter")]


def printed(tmp_path, board, paper, dpi=DPI):
    write_pdf(board_pages(board, parse_paper(paper)), tmp_path / "board.pdf", title="board")
    (page,) = pages_of(tmp_path / "board.pdf", dpi)
    return page


def opencv_board(board):
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary))
    return cv2.aruco.CharucoBoard((board.columns, board.rows), board.square_m, board.marker_m, dictionary)


def in_mm(points_px, page, paper):
    """From the paper's top left corner, whose pixel centres are at whole numbers, stretched to whole pixels."""
    size = np.array([paper.width_m, paper.height_m]) * 1e3
    size = size if (page.shape[1] > page.shape[0]) == (size[0] > size[1]) else size[::-1]
    return (points_px.reshape(-1, 2) + 0.5) * size / page.shape[::-1]


@pytest.mark.parametrize(("board", "paper"), CHARUCO)
def test_opencv_finds_every_corner_of_a_charuco_board_where_its_description_has_it(tmp_path, board, paper):
    page = printed(tmp_path, board, paper)
    described = opencv_board(board)
    corners, ids, _, markers = cv2.aruco.CharucoDetector(described).detectBoard(page)
    assert sorted(markers.ravel()) == list(range(board.marker_count))
    assert sorted(ids.ravel()) == list(range((board.columns - 1) * (board.rows - 1)))
    found = in_mm(corners, page, parse_paper(paper))
    expected = described.getChessboardCorners()[ids.ravel(), :2] * 1e3
    np.testing.assert_allclose(found - found.mean(axis=0), expected - expected.mean(axis=0), atol=0.1)


@pytest.mark.parametrize(("board", "paper"), CHARUCO)
def test_a_charuco_board_is_drawn_as_opencv_draws_it(tmp_path, board, paper):
    """The page, warped onto OpenCV's own picture of the board."""
    page = printed(tmp_path, board, paper)
    corners, ids, _, _ = cv2.aruco.CharucoDetector(opencv_board(board)).detectBoard(page)
    side_px = 120
    own = opencv_board(board).generateImage((board.columns * side_px, board.rows * side_px), marginSize=0)
    own_corners = opencv_board(board).getChessboardCorners()[ids.ravel(), :2] / board.square_m * side_px - 0.5
    homography, _ = cv2.findHomography(corners.reshape(-1, 2), own_corners)
    seen = cv2.warpPerspective(page, homography, (own.shape[1], own.shape[0]))
    # Edges of the two may be a pixel apart; areas may not.
    differs = cv2.erode(((seen < 128) != (own < 128)).astype(np.uint8), np.ones((5, 5)))
    assert differs.sum() == 0


@pytest.mark.parametrize(("board", "paper"), CHESSBOARDS)
def test_opencv_finds_every_corner_of_a_chessboard_at_its_distance(tmp_path, board, paper):
    page = printed(tmp_path, board, paper)
    found, corners = cv2.findChessboardCornersSB(page, board.inner_corners, flags=cv2.CALIB_CB_ACCURACY)
    assert found
    grid = in_mm(corners, page, parse_paper(paper)).reshape(board.rows - 1, board.columns - 1, 2)
    for axis in (0, 1):
        steps = np.linalg.norm(np.diff(grid, axis=axis), axis=-1)
        assert steps == pytest.approx(board.square_m * 1e3, abs=0.1)


@pytest.mark.parametrize(("board", "paper"), CHARUCO + CHESSBOARDS)
def test_the_page_has_a_ruler_its_parameters_and_a_white_rim(tmp_path, board, paper):
    page = printed(tmp_path, board, paper, 600)
    assert ruler_mm(page) == pytest.approx(100.0, abs=0.1)
    assert (rim(page) == 255).all()
    (said,) = words_of(tmp_path / "board.pdf")
    assert f"{board.columns} x {board.rows} squares of {board.square_m * 1e3:g} mm" in said
    if board.kind == "charuco":
        assert f"markers of {board.marker_m * 1e3:g} mm, {board.dictionary}" in said


def test_a_board_that_is_too_large_is_refused_with_the_largest_squares_that_fit():
    with pytest.raises(ConfigError, match=r"8 x 6 squares of 40 mm need 320 mm x 240 mm .* A4; .* are 30.2 mm"):
        board_pages(Board("chessboard", 8, 6, 0.04), parse_paper("A4"))
    assert board_pages(Board("chessboard", 8, 6, 0.0302), parse_paper("A4"))
    with pytest.raises(ConfigError):
        board_pages(Board("chessboard", 8, 6, 0.0303), parse_paper("A4"))


@pytest.mark.parametrize(
    ("options", "board"),
    [
        (["charuco"], Board("charuco", 8, 6, 0.03, 0.022, "DICT_4X4_100")),
        (
            ["charuco", "--square", "24mm", "--dictionary", "DICT_5X5_100"],
            Board("charuco", 8, 6, 0.024, 0.0176, "DICT_5X5_100"),
        ),
        (["chessboard", "--columns", "7", "--rows", "10", "--square", "0.02"], Board("chessboard", 7, 10, 0.02)),
    ],
)
def test_the_command_writes_the_sheet_and_its_description(tmp_path, options, board):
    result, said = run("tags", "--board", *options, "--out", tmp_path / "new" / "board.pdf")
    assert result.exit_code == 0, said
    assert read_board(tmp_path / "new" / "board.yaml") == board
    assert f"{board.columns} x {board.rows} squares" in words_of(tmp_path / "new" / "board.pdf")[0]


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (["circles"], 64, "'circles' is not one of 'charuco', 'chessboard'"),
        (["charuco", "--columns", "3"], 64, "board.columns: 3; allowed: a whole number of squares, 4 to 40"),
        (["charuco", "--square", "30"], 64, "did you mean 30mm?"),
        (["charuco", "--marker", "29mm"], 64, "board.marker_m: 0.029; allowed: a length of 0.012 to 0.027 m"),
        (["charuco", "--dictionary", "DICT_9X9"], 64, "board.dictionary: 'DICT_9X9'; allowed: one of DICT_4X4_50"),
        (["chessboard", "--marker", "20mm"], 64, "a chessboard has no markers"),
        (["charuco", "--square", "50mm"], 64, "the largest squares that do are 30.2 mm"),
        (["charuco", "--ids", "3"], 64, "--ids cannot be used with --board"),
        (["charuco", "--size", "0.1", "--tilt-deg", "3"], 64, "--size, --tilt-deg cannot be used with --board"),
    ],
)
def test_a_slip_is_named(tmp_path, options, code, said):
    result, printed_words = run("tags", "--board", *options, "--out", tmp_path / "board.pdf")
    assert result.exit_code == code
    assert said in printed_words
    assert not list(tmp_path.iterdir())

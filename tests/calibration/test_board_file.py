"""The file of a calibration board: what is written is read back, and what is wrong is named."""

from __future__ import annotations

import numpy as np
import pytest

from pilotfish.calibration.board import DICTIONARIES, Board, read_board, write_board
from pilotfish.errors import ConfigError, MissingFileError

CHARUCO = Board("charuco", 8, 6, 0.03, 0.022, "DICT_4X4_100")


@pytest.mark.parametrize(
    "board",
    [CHARUCO, Board("chessboard", 9, 7, 0.025), Board("charuco", 4, 40, 1 / 30, 1 / 45, "DICT_7X7_1000")],
)
def test_a_board_that_was_written_is_read_back_to_the_last_digit(tmp_path, board):
    write_board(board, tmp_path / "new" / "board.yaml")
    assert read_board(tmp_path / "new" / "board.yaml") == board


def test_the_file_of_the_documentation_is_read(tmp_path):
    line = "board: {kind: charuco, columns: 8, rows: 6, square_m: 0.03, marker_m: 0.022, dictionary: DICT_4X4_100}\n"
    (tmp_path / "board.yaml").write_text(line)
    assert read_board(tmp_path / "board.yaml") == CHARUCO
    write_board(CHARUCO, tmp_path / "board.yaml")
    assert (tmp_path / "board.yaml").read_text() == line


@pytest.mark.parametrize(
    ("slip", "key", "said"),
    [
        ({"kind": "circles"}, "board.kind", "'circles'; allowed: one of charuco, chessboard"),
        ({"columns": 3}, "board.columns", "3; allowed: a whole number of squares, 4 to 40"),
        ({"rows": 41}, "board.rows", "41; allowed: a whole number of squares, 4 to 40"),
        ({"rows": 6.0}, "board.rows", "6.0; allowed: a whole number"),
        ({"columns": True}, "board.columns", "True; allowed: a whole number"),
        ({"square_m": 30}, "board.square_m", "30; allowed: a length of 0.002 to 0.5 m"),
        ({"square_m": ".nan"}, "board.square_m", "nan; allowed: a length"),
        ({"square_m": "30mm"}, "board.square_m", "'30mm'; allowed: a length"),
        ({"marker_m": 0.028}, "board.marker_m", "0.028; allowed: a length of 0.012 to 0.027 m, 0.4 to 0.9 of square_m"),
        ({"dictionary": "DICT_3X3_50"}, "board.dictionary", "'DICT_3X3_50'; allowed: one of DICT_4X4_50"),
        # 20 x 11 squares have 110 white ones.
        ({"columns": 20, "rows": 11}, "board.dictionary", "'DICT_4X4_100'; allowed: one with 110 markers or more"),
        ({"colour": "red"}, "board.colour", "unknown key of a charuco; known are kind, columns"),
        ({"kind": "chessboard"}, "board.marker_m", "unknown key of a chessboard"),
        ({"marker_m": None}, "board.marker_m", "missing"),
    ],
)
def test_a_slip_is_named_with_file_key_value_and_what_is_allowed(tmp_path, slip, key, said):
    values = {"kind": "charuco", "columns": 8, "rows": 6, "square_m": 0.03, "marker_m": 0.022}
    values |= {"dictionary": "DICT_4X4_100"} | slip
    text = ", ".join(f"{name}: {'null' if value is None else value}" for name, value in values.items())
    (tmp_path / "board.yaml").write_text(f"board: {{{text}}}\n")
    with pytest.raises(ConfigError) as refused:
        read_board(tmp_path / "board.yaml")
    assert refused.value.key == key
    assert str(refused.value).startswith(f"{tmp_path / 'board.yaml'}: {key}: ")
    assert said in str(refused.value)


@pytest.mark.parametrize("key", ["kind", "columns", "rows", "square_m", "marker_m", "dictionary"])
def test_a_missing_key_is_named(tmp_path, key):
    write_board(CHARUCO, tmp_path / "board.yaml")
    lines = (tmp_path / "board.yaml").read_text().removeprefix("board: {").removesuffix("}\n").split(", ")
    kept = ", ".join(line for line in lines if not line.startswith(f"{key}:"))
    (tmp_path / "board.yaml").write_text(f"board: {{{kept}}}\n")
    with pytest.raises(ConfigError, match=rf"board\.{key}: (is )?missing"):
        read_board(tmp_path / "board.yaml")


@pytest.mark.parametrize("text", ["", "7", "[]", "board: 7", "board:", "plank: {}", "board: {", "a: b: c", "board: []"])
def test_what_is_no_board_file_is_refused_with_its_name(tmp_path, text):
    (tmp_path / "odd.yaml").write_text(text)
    with pytest.raises(ConfigError, match=r"odd\.yaml: (board|no YAML)"):
        read_board(tmp_path / "odd.yaml")


def test_what_is_no_file_is_refused(tmp_path):
    for path in (tmp_path, tmp_path / "nowhere.yaml"):
        with pytest.raises(MissingFileError):
            read_board(path)


def test_a_chessboard_refuses_markers():
    with pytest.raises(ConfigError, match=r"board\.marker_m: 0\.02; allowed: nothing"):
        Board("chessboard", 8, 6, 0.03, 0.02)


def test_the_corners_are_those_that_opencv_numbers():
    cv2 = pytest.importorskip("cv2")
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, CHARUCO.dictionary))
    oracle = cv2.aruco.CharucoBoard((CHARUCO.columns, CHARUCO.rows), CHARUCO.square_m, CHARUCO.marker_m, dictionary)
    np.testing.assert_allclose(CHARUCO.corners_m(), oracle.getChessboardCorners(), atol=1e-7)
    assert len(oracle.getIds()) == CHARUCO.marker_count
    assert CHARUCO.inner_corners == (7, 5)


def test_every_dictionary_is_one_of_opencv_s_with_that_many_markers_of_that_size():
    cv2 = pytest.importorskip("cv2")
    for name, (bits, size) in DICTIONARIES.items():
        oracle = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))
        assert (oracle.markerSize, oracle.bytesList.shape[0]) == (bits, size)

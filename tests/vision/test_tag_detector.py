"""TagDetector: corners in Pilotfish's pixels, gates that count, and pictures that must not kill it."""

import subprocess
import sys

import numpy as np
import pytest
from pinhole_drawing import Photography, corners_px, draw, leader_pose, pose, rotation

from pilotfish.core import BodyTag, CameraModel
from pilotfish.vision import TagDetector, TagDetectorConfig, TagFamily
from tag_families import FAMILIES

CAMERA = CameraModel(width=320, height=240, fx=600, fy=600, cx=159.5, cy=119.5)


def flat_picture(tag_id=7, cell_px=12, flipped_cells=(), white=220, black=30):
    """An upright tag on white, cell by cell. The data cells of tag36h11 are [2:8, 2:8] of its bitmap."""
    cells = TagFamily("tag36h11").bitmap(id=tag_id).copy()
    for row, column in flipped_cells:
        cells[row, column] = 255 - cells[row, column]
    tag = np.where(np.kron(cells, np.ones((cell_px, cell_px))) > 0, white, black)
    return np.pad(tag, 40, constant_values=white).astype(np.uint8)


@pytest.fixture(scope="module")
def rolled_tags():
    """40 tags turned all ways, at all sub-pixel places: [(picture, true corners)]."""
    rng = np.random.default_rng(1)
    tag, pictures = BodyTag(id=3, size_m=0.16), []
    for _ in range(40):
        distance = rng.uniform(0.7, 1.3)
        x, y, z = distance, *(rng.uniform(-0.04, 0.04, 2) * distance)
        cMo = pose(rotation("z", rng.uniform(-np.pi, np.pi))) @ leader_pose(x, y, rng.uniform(-1, 1), z)
        picture = draw(CAMERA, [(tag, cMo)], Photography(blur_sigma_px=0.7))
        pictures.append((picture, corners_px(CAMERA, cMo, tag)))
    return pictures


@pytest.mark.parametrize("decimation", [1.0, 1.5, 2.0, 3.0, 4.0])
def test_corners_are_counted_from_the_centre_of_the_top_left_pixel(rolled_tags, decimation):
    # libapriltag counts from that pixel's corner, half a pixel away. One corner is off by 0.04 px (standard
    # deviation, measured); the four of a tag move together at worst, so the mean of 40 tags has 0.04 /
    # sqrt(40) = 0.006 px. Three of these are far from the 0.5 px of a wrong convention, whatever the
    # decimation. As each corner is compared with its own truth on tags turned all ways, this pins the order
    # of the corners too.
    detector = TagDetector(config=TagDetectorConfig(decimation=decimation))
    errors = []
    for picture, truth in rolled_tags:
        errors += [tag.corners_px - truth for tag in detector.detect(picture).tags]
    assert len(errors) >= 36
    assert np.abs(np.mean(errors, axis=(0, 1))).max() < 0.02
    assert np.sqrt(np.mean(np.square(errors))) < 0.08


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_reads_its_own_first_and_last_tag(family):
    source, detector = TagFamily(family), TagDetector(family)
    for tag_id in (0, source.size - 1):
        tag, cMo = BodyTag(id=tag_id, size_m=0.1), leader_pose(0.8, 0.0, 0.4)
        found = detector.detect(draw(CAMERA, [(tag, cMo)], family=family)).tags
        assert [sighting.id for sighting in found] == [tag_id]
        # Below one pixel: the family's own border is measured, not the next ring of cells.
        assert np.abs(found[0].corners_px - corners_px(CAMERA, cMo, tag)).max() < 1.0


def test_a_flipped_bit_is_refused_unless_one_corrected_bit_is_accepted():
    picture = flat_picture(tag_id=7, flipped_cells=[(4, 4)])
    refused = TagDetector(config=TagDetectorConfig(max_hamming=0)).detect(picture)
    assert (refused.tags, refused.refused_hamming, refused.refused_ids) == ([], 1, [7])
    accepted = TagDetector(config=TagDetectorConfig(max_hamming=1)).detect(picture)
    assert [(tag.id, tag.hamming) for tag in accepted.tags] == [(7, 1)]
    assert accepted.refused_hamming == 0


def test_the_margin_gate_lies_at_the_decision_margin():
    picture = flat_picture(white=140, black=100)
    margin = TagDetector(config=TagDetectorConfig(min_decision_margin=0.0)).detect(picture).tags[0].decision_margin
    # A bit differs from the threshold by half the contrast, 20, and sharpening by 1/4 of the Laplacian adds
    # up to as much again (a cell with four other neighbours: 4 x 40 x 0.25 = 40 more).
    assert 20 <= margin <= 60
    below = TagDetector(config=TagDetectorConfig(min_decision_margin=margin - 0.1)).detect(picture)
    assert [tag.id for tag in below.tags] == [7]
    above = TagDetector(config=TagDetectorConfig(min_decision_margin=margin + 0.1)).detect(picture)
    assert (above.tags, above.refused_margin, above.refused_ids) == ([], 1, [7])


@pytest.mark.parametrize("decimation", [1.0, 2.0])
@pytest.mark.parametrize("blur_sigma_px", [0.0, 1.5])
def test_the_pixels_are_only_read(decimation, blur_sigma_px):
    picture = flat_picture()
    before = picture.copy()
    config = TagDetectorConfig(decimation=decimation, blur_sigma_px=blur_sigma_px)
    assert len(TagDetector(config=config).detect(picture).tags) == 1
    assert np.array_equal(picture, before)


def test_noise_of_every_allowed_small_size_is_survived():
    # In a process of its own: libapriltag would take this one down with it.
    script = """
import numpy as np
from pilotfish.vision import TagDetector, TagDetectorConfig
rng = np.random.default_rng(0)
for decimation in (1.0, 1.5, 2.0, 3.0, 4.0):
    for blur in (0.0, 1.9):
        detector = TagDetector(config=TagDetectorConfig(decimation=decimation, blur_sigma_px=blur))
        for width in range(16, 65):
            for height in range(16, 65, 1 if blur == 0.0 else 7):
                picture = rng.integers(0, 256, (height, width), dtype=np.uint8)
                if (width + height) % 2:  # blocks of black and gray, in which quads are found
                    blocks = np.kron(picture[::4, ::4] & 128, np.ones((4, 4), np.uint8))
                    picture = np.ascontiguousarray(blocks[:height, :width])
                assert detector.detect(picture).input.name == "none"
print("survived")
"""
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert (run.returncode, run.stdout) == (0, "survived\n"), run.stderr


def test_no_tag_is_read_from_noise():
    rng = np.random.default_rng(2)
    detector = TagDetector()
    for _ in range(20):
        assert detector.detect(rng.integers(0, 256, (240, 320), dtype=np.uint8)).tags == []


@pytest.mark.parametrize(
    ("family", "config", "key"),
    [
        ("tag99h1", {}, "leader.family"),
        (
            "tag36h11",
            {"decimation": 2.5},
            "vision.decimation",
        ),  # libapriltag would misplace the quads by a quarter
        ("tagStandard52h13", {"max_hamming": 2}, "vision.max_hamming"),  # its table would take 3 GB
    ],
)
def test_a_configuration_that_cannot_work_is_refused_by_its_key(family, config, key):
    with pytest.raises(ValueError, match=f"^{key}: "):
        TagDetector(family, config=TagDetectorConfig(**config))


@pytest.mark.parametrize(("key", "value"), [("decimation", 4.5), ("max_hamming", 3), ("blur_sigma_px", float("nan"))])
def test_a_parameter_out_of_range_is_refused_by_its_key(key, value):
    with pytest.raises(ValueError, match=f"^{key}: "):
        TagDetectorConfig(**{key: value})


def test_only_a_gray_picture_is_taken():
    for picture in (
        np.zeros((48, 64)),
        np.zeros((48, 64, 3), np.uint8),
        np.zeros((48, 64), np.uint8)[:, ::2],
    ):
        with pytest.raises(ValueError, match="gray image"):
            TagDetector().detect(picture)


def test_a_bitmap_outside_the_family_is_an_index_error():
    with pytest.raises(IndexError, match="0 to 586"):
        TagFamily("tag36h11").bitmap(id=587)

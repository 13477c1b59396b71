"""The benchmark's own parts: its frames carry the truth they claim, and its figures are what their names say."""

import json
import math
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import typer

from bench.vision import drive, scenes, sequences, stages, without_leader
from bench.vision.accuracy import frames_of_cell
from bench.vision.answers import Answer, errors_of, heading_of, normal_of
from bench.vision.cli import app
from bench.vision.goals import at_most, below, wrong_leader_goals
from bench.vision.lens import visp_coefficients
from bench.vision.runs import BURST, Contest, compare, compare_in_turns
from bench.vision.stages import stage_times
from bench.vision.summary import as_json, figures_of, percentile, ratio, share_beyond
from bench.vision.units import fraction, mm
from bench.vision.visp_images import medians
from pilotfish.vision import TagDetector

ROOT = Path(__file__).parents[2]

SEQUENCES = {
    "0.65 m": (scenes.VGA, lambda seed: frames_of_cell(scenes.VGA, 0.65, 4, seed)),
    "2.44 m, large frames": (scenes.HD, lambda seed: frames_of_cell(scenes.HD, 2.44, 2, seed)),
    "lens": (sequences.DISTORTED, lambda seed: sequences.through_lens(4, seed)),
    "head-on": (scenes.VGA, lambda seed: sequences.head_on(4, seed)),
    "drive": (scenes.VGA, lambda seed: list(drive.drive(4, seed))),
}


# --- frames ------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SEQUENCES)
def test_the_same_seed_gives_the_same_frames_and_another_seed_gives_others(name):
    _, frames = SEQUENCES[name]
    first, again, other = frames(3), frames(3), frames(4)
    assert all(
        np.array_equal(a.image, b.image) and np.array_equal(a.cMt, b.cMt) for a, b in zip(first, again, strict=True)
    )
    assert not any(np.array_equal(a.image, b.image) for a, b in zip(first, other, strict=True))
    assert [picture.utime for picture in first] == [scenes.utime_of(k) for k in range(len(first))]


@pytest.mark.parametrize("name", [name for name in SEQUENCES if name != "drive"])
def test_the_truth_puts_the_corners_where_a_detector_sees_them(name):
    # Half a pixel in u or v would be a mix-up of conventions, so half of that tells the two cases apart. libapriltag is
    # good to a tenth; through the lens edges are bowed, and straight lines fitted to them meet up to 0.2 px off.
    camera, frames = SEQUENCES[name]
    offsets = []
    for picture in frames(3):
        (tag,) = [tag for tag in TagDetector().detect(picture.image).tags if tag.id == scenes.TAG_ID]
        offsets.append(tag.corners_px - scenes.corners_px(camera, picture.cMt))
    assert np.abs(np.mean(offsets, axis=(0, 1))).max() < 0.25
    assert np.abs(offsets).max() < 0.6


def test_motion_blur_leaves_the_truth_in_the_middle_of_the_exposure():
    # Averaged symmetrically around the frame's time, a blurred tag stays where it was at that time. One end of the
    # exposure alone would be off by a quarter of the motion between frames: up to 2 px here.
    offsets = []
    for picture in drive.drive(20, 6):
        seen = [tag for tag in TagDetector().detect(picture.image).tags if tag.id == scenes.TAG_ID]
        offsets += [tag.corners_px - scenes.corners_px(scenes.VGA, picture.cMt) for tag in seen]
    assert len(offsets) >= 10
    assert np.abs(np.mean(offsets, axis=(0, 1))).max() < 0.2


def test_a_fifth_of_the_drive_is_hidden_a_tenth_or_more():
    hidden = drive.occlusions(1000, np.random.default_rng(1))
    assert np.count_nonzero(hidden) == 200
    assert hidden[hidden > 0].min() >= 0.1
    assert hidden.max() <= 1.0
    # No leader passes in one frame only: 200 single frames would have 200 beginnings.
    assert np.count_nonzero(np.diff(np.r_[0, hidden > 0]) == 1) < 100


@pytest.mark.parametrize("share", [0.25, 1.0])
def test_a_patch_covers_its_share_of_the_sheet(share):
    # A sheet of 40 x 20 px (pixels 10..50 and 5..25, both included: 41 x 21): a quarter, rounded to whole rows.
    sheet = np.array([[10.0, 25.0], [50.0, 25.0], [50.0, 5.0], [10.0, 5.0]])
    for seed in range(8):
        gray = np.full((40, 80), 255.0)
        drive.cover(gray, sheet, share, np.random.default_rng(seed))
        covered = gray != 255
        assert covered[5:26, 10:51].sum() == covered.sum()
        assert covered.sum() / (41 * 21) == pytest.approx(share, abs=0.03)


def test_a_tag_pose_has_its_distance_and_its_angle_to_the_ray():
    # With pitch and roll zero the normal is turned by yaw from the ray, wherever the tag is.
    for azimuth, elevation, yaw in ((0.0, 0.0, 0.0), (0.3, -0.2, 0.7), (-0.4, 0.1, -1.0)):
        cMt = scenes.tag_pose(1.7, azimuth_rad=azimuth, elevation_rad=elevation, yaw_rad=yaw)
        position = cMt[:3, 3]
        assert np.linalg.norm(position) == pytest.approx(1.7)
        assert np.arctan2(position[0], position[2]) == pytest.approx(azimuth)
        assert np.arcsin(-position[1] / 1.7) == pytest.approx(elevation)
        assert -normal_of(cMt) @ position / 1.7 == pytest.approx(np.cos(yaw))


def test_the_sweep_is_even_and_reaches_both_ends():
    values = np.array([scenes.triangle(phase) for phase in np.linspace(0, 1, 2001)[:-1]])
    assert values.min() == pytest.approx(-1, abs=1e-3)
    assert values.max() == pytest.approx(1, abs=1e-3)
    # Uniform on [-1, 1]: a quarter of the values in each quarter of the range.
    assert np.histogram(values, bins=4, range=(-1, 1))[0] / 2000 == pytest.approx([0.25] * 4, abs=0.01)


@pytest.mark.parametrize("distance_m", [0.65, 1.1, 2.44, 5.0])
def test_a_cells_leader_stays_in_the_frame_near_its_distance_and_moves_like_a_robot(distance_m):
    poses = scenes.Motion(distance_m).poses(300, np.random.default_rng(5))
    distances = [np.linalg.norm(cMt[:3, 3]) for cMt in poses]
    assert np.abs(np.array(distances) / distance_m - 1).max() < 0.021
    corners = np.array([scenes.corners_px(scenes.VGA, cMt, scenes.TAG_SIZE_M * 10 / 8) for cMt in poses])
    assert corners.min() > 0
    assert (corners.max(axis=(0, 1)) < [639, 479]).all()
    steps = np.linalg.norm(np.diff([cMt[:3, 3] for cMt in poses], axis=0), axis=1) * scenes.FRAME_RATE_HZ
    assert steps.max() < 0.6
    assert steps.max() > 0.15


def test_frames_without_a_leader_have_none_and_the_others_do():
    pieces = without_leader.prepared(scenes=3, seed=2)
    for index, (is_leader, image) in enumerate(without_leader.frames(2 * without_leader.PERIOD, pieces, seed=2)):
        assert is_leader == (index % without_leader.PERIOD == 0)
        ids = [tag.id for tag in TagDetector().detect(image).tags]
        assert (scenes.TAG_ID in ids) == is_leader


# --- figures -----------------------------------------------------------------------------------------------------


def test_errors_are_of_the_distance_to_the_tag_and_of_its_visible_normal():
    truth = scenes.tag_pose(2.0)
    # 3 m along x and 4 m along z are 5 m away; turned by 20 degrees about the vertical.
    answer = scenes.tag_pose(2.0, yaw_rad=np.radians(20.0))
    answer[:3, 3] = [3.0, 0.0, 4.0]
    errors = errors_of(Answer(1, answer), truth)
    assert errors.distance_m == pytest.approx(3.0)
    assert errors.normal_deg == pytest.approx(20.0)
    assert abs(errors.heading_deg) == pytest.approx(20.0)


def test_the_side_on_which_a_baseline_has_its_z_axis_does_not_matter():
    truth = scenes.tag_pose(2.0, yaw_rad=0.5, azimuth_rad=0.2)
    theirs = truth @ np.diag([1.0, -1.0, -1.0, 1.0])
    errors = errors_of(Answer(1, theirs), truth)
    assert (errors.distance_m, errors.normal_deg, errors.heading_deg) == pytest.approx((0, 0, 0), abs=1e-5)


def test_the_heading_read_from_a_pose_is_the_heading_of_the_leader():
    # The leader of scenes wears its tag on the rear. Base: x ahead, y left; level camera: right is -y, ahead is x.
    for heading in (-0.8, 0.0, 0.6):
        bMo = np.eye(4)
        bMo[:2, :2] = [[np.cos(heading), -np.sin(heading)], [np.sin(heading), np.cos(heading)]]
        bMo[:3, 3] = [2.0, 0.3, 0.0]
        bMc = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
        cMt = np.linalg.inv(bMc) @ bMo @ scenes.LEADER.tags[0].oMt
        assert heading_of(cMt) == pytest.approx(heading)


def test_a_filtered_heading_counts_instead_of_the_poses_and_wraps_around():
    truth = scenes.tag_pose(2.0)
    assert errors_of(Answer(1, truth, heading_rad=2 * np.pi - 0.1), truth).heading_deg == pytest.approx(
        -np.degrees(0.1)
    )


def test_figures_by_hand():
    # True distance 1 m. Answers: +1 mm, -3 mm, +200 mm (more than a tenth: not seen), none. So 2 of 4 are seen.
    # |errors| are 1, 3, 200: median 3, 95th percentile 3 + 0.9 * 197 = 180.3 (linear between the 2nd and the 3rd, at
    # index 1.9); median of +1, -3, +200 is +1. Times 1, 2, 3, 10 ms: median 2.5. One of three normals is 30° off.
    truth = scenes.tag_pose(1.0)
    poses = [scenes.tag_pose(1.001), scenes.tag_pose(0.997), scenes.tag_pose(1.2, yaw_rad=np.radians(30))]
    answers = [Answer(ms * 1_000_000, cMt, found_by="track") for ms, cMt in zip((1, 2, 3), poses, strict=True)]
    figures = figures_of([*answers, Answer(10_000_000)], [truth] * 4)
    assert figures.frames == 4
    assert figures.seen == 0.5
    assert figures.median_mm == pytest.approx(3.0)
    assert figures.p95_mm == pytest.approx(180.3)
    assert figures.bias_mm == pytest.approx(1.0)
    assert figures.normals_wrong == pytest.approx(1 / 3)
    assert figures.headings_wrong == pytest.approx(1 / 3)
    assert figures.median_ms == 2.5
    assert figures.found_by == {"track": 3}


def test_who_never_sees_the_leader_has_no_errors_and_meets_no_goal():
    figures = figures_of([Answer(1)], [scenes.tag_pose(1.0)])
    assert figures.seen == 0.0
    assert math.isnan(figures.median_mm)
    assert json.loads(json.dumps(as_json(figures), allow_nan=False))["median_mm"] is None
    assert not below("error", "baseline", 1.0, figures.median_mm).met
    assert not below("error", "baseline", figures.median_mm, 1.0).met


def test_percentiles_shares_and_ratios():
    assert percentile(np.array([1.0, 2.0, 3.0]), 50) == 2.0
    assert math.isnan(percentile(np.array([]), 50))
    assert share_beyond([5.0, -11.0, 10.0, math.nan], 10.0) == pytest.approx(1 / 3)  # at the limit is not beyond it
    assert ratio(1.0, 4.0) == 0.25
    assert math.isnan(ratio(1.0, 0.0))


def test_a_goal_is_met_up_to_its_bound():
    assert at_most("time", 0.5, "half", "baseline", 2.0, 1.0, mm).met
    assert not at_most("time", 0.5, "half", "baseline", 2.0, 1.01, mm).met
    assert not below("error", "baseline", 1.0, 1.0).met  # as good is not better
    assert fraction(1 / 200) == "1/200"
    assert fraction(1.5) == "1.50"


def test_a_tracker_that_never_saw_the_leader_proves_nothing():
    good = without_leader.Verdict(frames=95, wrong=0, shown=5, seen=5)
    assert [goal.met for goal in wrong_leader_goals(good)] == [True]
    assert [goal.met for goal in wrong_leader_goals(replace(good, seen=0))] == [False]
    assert [goal.met for goal in wrong_leader_goals(replace(good, wrong=1))] == [False]


def test_the_median_over_the_tags_counts_a_missed_tag():
    figures = figures_of([Answer(1, scenes.tag_pose(1.002))], [scenes.tag_pose(1.0)])
    missed = figures_of([Answer(1)], [scenes.tag_pose(1.0)])
    assert medians({0: {"tracker": figures}, 1: {"tracker": figures}})["tracker"] == pytest.approx(2.0)
    assert math.isnan(medians({0: {"tracker": figures}, 1: {"tracker": missed}})["tracker"])


def test_all_eyes_see_the_same_frames_each_first_in_its_turn():
    calls = []

    class Tracker:
        def __init__(self, name):
            self.name = name

        def track(self, image, utime):
            calls.append((self.name, int(image[0, 0]), utime))
            return Answer(1)

    count = 2 * BURST + 1  # two bursts, and one of a single frame
    pictures = [scenes.Picture(np.full((1, 1), k, np.uint8), scenes.tag_pose(1.0), k) for k in range(count)]
    figures = compare([Tracker("a"), Tracker("b"), Tracker("c")], pictures)
    assert "".join(name for name, _, _ in calls[::BURST][:6]) == "abcbca"
    assert "".join(name for name, _, _ in calls[-3:]) == "cab"
    for tracker in "abc":
        assert [(shade, utime) for name, shade, utime in calls if name == tracker] == [(k, k) for k in range(count)]
    assert {name: of_tracker.frames for name, of_tracker in figures.items()} == {"a": count, "b": count, "c": count}


def test_contests_take_turns_burst_by_burst_until_the_longest_ends():
    calls = []

    class Tracker:
        name = "tracker"

        def __init__(self, contest):
            self.contest = contest

        def track(self, image, utime):
            calls.append(self.contest)
            return Answer(1)

    def pictures(count):
        return [scenes.Picture(np.zeros((1, 1), np.uint8), scenes.tag_pose(1.0), k) for k in range(count)]

    figures = compare_in_turns(
        {
            "long": Contest([Tracker("long")], pictures(2 * BURST + 1)),
            "short": Contest([Tracker("short")], pictures(BURST)),
        }
    )
    assert calls == ["long"] * BURST + ["short"] * BURST + ["long"] * (BURST + 1)
    assert {name: by_tracker["tracker"].frames for name, by_tracker in figures.items()} == {
        "long": 2 * BURST + 1,
        "short": BURST,
    }


def test_the_first_frames_of_the_bursts_have_a_figure_of_their_own():
    # Bursts of three frames: 9, 1, 1 ms. Median 1 ms, of the first ones 9 ms.
    answers = [Answer(elapsed_ns) for elapsed_ns in [9_000_000, 1_000_000, 1_000_000] * 5]
    figures = figures_of(answers, [scenes.tag_pose(1.0)] * 15, burst=3)
    assert (figures.median_ms, figures.cold_ms) == (1.0, 9.0)


def test_a_lens_of_one_coefficient_is_visps_own():
    # distorted = undistorted (1 + k1 r^2) is ViSP's formula for kud: the fit is exact. The other way, to first order,
    # kdu = -k1; the next term, 3 k1^2 r^4, is below a tenth of it for r up to 0.35 and k1 = 0.05.
    lens = scenes.camera_of(320, 240, 600.0, k1=0.05)
    kud, kdu = visp_coefficients(lens)
    assert kud == pytest.approx(0.05, abs=1e-9)
    assert kdu == pytest.approx(-0.05, rel=0.1)


# --- the command -------------------------------------------------------------------------------------------------


def test_the_command_explains_itself():
    done = subprocess.run(
        [sys.executable, "bench/vision", "--help"], cwd=ROOT, capture_output=True, text=True, timeout=60
    )
    assert done.returncode == 0, done.stderr
    for word in ("--quick", "--part", "--out", "ViSP", "Examples"):
        assert word in done.stdout


def test_the_commands_in_its_readme_are_understood():
    text = (ROOT / "bench" / "README.md").read_text()
    lines = re.findall(r"^scripts/bench vision(.*)$", text, flags=re.MULTILINE)
    assert len(lines) >= 3
    for line in lines:
        arguments = line.split("#")[0].partition(" -- ")[2].split()
        typer.main.get_command(app).make_context("bench/vision", arguments)


def test_the_stages_of_a_tracked_frame_do_not_detect_and_those_of_an_acquired_one_do():
    counted = []
    times = stage_times(2, 1, lambda: counted.append(1))
    assert len(counted) == 2 * len(stages.DISTANCES_M) * len(stages.MODES)
    near = {mode: times[mode][1.1] for mode in stages.MODES}
    assert set(near["tracked"]) == {"predict", "detect", "search", "align", "read", "pose", "heading"}
    assert near["tracked"]["detect"] < 0.05 * near["acquired"]["detect"]
    assert all(times[mode][1.1]["align"] > 0.0 for mode in stages.MODES)

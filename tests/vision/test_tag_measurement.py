"""TagTracker: the corners are where the geometry puts them, as exactly as it says, whatever family, lens and light.

Most pictures are the simulator's, whose edges are exact means over the pixels' areas. Noise is 3 gray levels on a
contrast of 190 unless stated otherwise. What limits a corner: along an edge of n pixels, blurred with sigma = 0.76 px
(0.7 px and the pixel's own width), the place of the edge is known to

    noise / contrast sqrt(2 sqrt(pi) sigma / n) = 3 / 190 sqrt(2.7 / n) = 0.026 px / sqrt(n)

(the Fisher information of one line across is the integral of the squared slope, contrast^2 / (2 sqrt(pi) sigma)). A
tag36h11 with cells of c px has some 100 edges of c px each in two directions, so all that moves in one direction hangs
on n = 50 c pixels; a corner is extrapolated from the eight parameters of a homography, which at the rim costs about
sqrt(8 / 2) = 2 times the error of a mean, and about sqrt(2) more as 300 samples are taken and not all pixels.

    c = 15 px (0.65 m): 0.0027 px;  9 px (1.1 m): 0.0035 px;  4 px (2.44 m): 0.005 px;  2 px (5 m): 0.007 px

Two to four of these is what may be asked for where cells are large; where they are as small as the blur, neighbouring
edges hide each other's flanks and turned tags have cells half as wide: see the bounds.
"""

import numpy as np
import pytest
from pinhole_drawing import blurred
from rendered_leaders import BODY, CAMERA, found, leader_at, look, render, squared_in_sigmas, true_corners
from scipy import stats

from pilotfish.core import BodyTag, CameraModel, LeaderBody
from pilotfish.vision import TagFamily
from tag_families import FAMILIES

WIDE = CameraModel(width=640, height=480, fx=420, fy=430, cx=330, cy=230, k1=-0.28, k2=0.08, p1=0.006, p2=-0.004)
COUNT = 80


def off_by_a_quarter_of_a_cell(rng, corners, cells_at_border=8):
    """Every corner moved by itself, up to a quarter of the shortest cell along each axis."""
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1)
    return corners + rng.uniform(-0.25, 0.25, (4, 2)) * sides.min() / cells_at_border


def turned_leader(rng, distance, most_deg=60):
    """Anywhere in the picture, its tag seen under any angle up to `most_deg`."""
    bearing = rng.uniform(-0.25, 0.25)
    heading = bearing + np.radians(rng.uniform(-most_deg, most_deg))
    return leader_at(distance, bearing, heading, rng.uniform(-0.1, 0.1) * distance)


@pytest.fixture(scope="module")
def looks():
    """{distance: [(error of the corners (8,), their covariance (8, 8))]} of COUNT pictures each."""
    all_of = {}
    for distance in (0.65, 1.1, 2.44, 5.0):
        rng, all_of[distance] = np.random.default_rng(round(100 * distance)), []
        for k in range(COUNT):
            cMo = turned_leader(rng, distance)
            truth = true_corners(cMo)
            image = render([(BODY, cMo)], k, clutter_seed=1 + k % 4)
            answer = look(image, off_by_a_quarter_of_a_cell(rng, truth))
            if found(answer):
                all_of[distance].append(((answer.tag.corners_px - truth).ravel(), answer.covariance_px2))
    return all_of


@pytest.mark.parametrize(("distance", "bound_px"), [(0.65, 0.015), (1.1, 0.015), (2.44, 0.02), (5.0, 0.04)])
def test_corners_are_found_from_a_quarter_of_a_cell_away(looks, distance, bound_px):
    # Four of the limits in the header at 0.65 to 2.44 m; at 5 m six: there a cell is 2.4 px, 1.2 px in a tag turned by
    # 60 degrees, beside a blur of 0.76 px. A guess off by a quarter of a cell is off by 3.7 to 0.6 px.
    errors = np.array([error for error, _ in looks[distance]])
    assert len(errors) >= 0.98 * COUNT
    assert np.sqrt(np.mean(errors**2)) < bound_px
    # No bias: the mean of all coordinates is nought within what is left of their errors. (They are not independent; a
    # shift of the whole tag is one number, so it counts per picture.)
    shift = errors.reshape(-1, 4, 2).mean(axis=1)
    assert (np.abs(shift.mean(axis=0)) < 4 * shift.std(axis=0) / np.sqrt(len(shift)) + 0.001).all()


@pytest.mark.parametrize("distance", [0.65, 1.1, 2.44])
def test_the_covariance_of_the_corners_is_true(looks, distance):
    # e^T C^-1 e is chi-squared with 8 degrees of freedom, the sum over n pictures with 8 n. Two-sided, 99.9 %: of three
    # such tests one in 300 would fail by chance, and the seeds are fixed.
    squared = [squared_in_sigmas(error, covariance) for error, covariance in looks[distance]]
    low, high = stats.chi2.interval(0.999, 8 * len(squared))
    assert low < np.sum(squared) < high


def test_where_cells_are_as_small_as_the_blur_the_covariance_errs_on_the_safe_side(looks):
    # At 5 m what the noise does is less than what the fit's Gaussian cannot follow in the shape of the blur. That part
    # is the same for all edges of one picture, and the covariance holds a bound for it and not its variance: so the
    # upper bound of chi-squared holds, and the lower one only up to a factor of two.
    squared = [squared_in_sigmas(error, covariance) for error, covariance in looks[5.0]]
    assert np.sum(squared) < stats.chi2.ppf(0.9995, 8 * len(squared))
    assert np.mean(squared) > 8 / 2


@pytest.mark.parametrize(("distance", "heading_deg"), [(2.0, 60), (2.44, 60), (2.0, 70)])
def test_a_tag_seen_from_the_side_is_used_from_top_to_bottom(distance, heading_deg):
    # Cells of 2.5 to 3.1 px by 5 to 6: more pixels than there is room for, so some are left out. Were it the last rows,
    # the lower corners would be extrapolated and unsure, 1.4 to 2.9 times as much as the upper ones; as it is evenly,
    # only the template's own unevenness is left.
    cMo = leader_at(distance, heading_rad=np.radians(heading_deg))
    truth, ratios = true_corners(cMo), []
    for k in range(8):
        answer = look(render([(BODY, cMo)], k), truth + 0.1)
        deviations = np.sqrt(np.diag(answer.covariance_px2)).reshape(4, 2)
        lower = truth[:, 1] > truth[:, 1].mean()
        ratios.append(deviations[lower].mean() / deviations[~lower].mean())
    assert 0.87 < np.median(ratios) < 1.15


@pytest.mark.parametrize("family_name", FAMILIES)
def test_every_family_is_measured_and_knows_how_well(family_name):
    # Cells of 8 px: some 4 px where turned by 50 degrees. The smaller families have half as many edges as tag36h11,
    # whose bound at 2.44 m is 0.02 px; sqrt(2) of that.
    family = TagFamily(family_name)
    side_m = 8 * family.cells_at_border / CAMERA.fx
    rng, squared = np.random.default_rng(5), []
    errors = []
    for k in range(40):
        tag = BodyTag(id=int(rng.integers(min(family.size, 30))), size_m=side_m)
        cMo = turned_leader(rng, 1.0, most_deg=50)
        truth = true_corners(cMo, tag)
        guess = off_by_a_quarter_of_a_cell(rng, truth, family.cells_at_border)
        answer = look(render([(LeaderBody([tag], family=family_name), cMo)], k), guess, tag=tag, family=family_name)
        assert found(answer), answer
        assert answer.tag.hamming == 0
        errors.append((answer.tag.corners_px - truth).ravel())
        squared.append(squared_in_sigmas(errors[-1], answer.covariance_px2))
    assert np.sqrt(np.mean(np.square(errors))) < 0.028
    # Whose cells are free or few leans more on the model of the light and the blur: accurate to three tenths of a
    # sigma (1.3^2), where a covariance that took neighbouring samples for independent ones was off by twice that.
    assert 0.5 < np.mean(squared) / 8 < 1.3**2


def test_distortion_is_handled_on_points():
    # Out to the corners of the picture, where the lens moves points by 80 px. With the right model the bound of 0.015
    # px holds; a pinhole's model of the same picture is off by as much as the lens bends the tag within itself.
    rng, errors, squared, naive = np.random.default_rng(2), [], [], []
    while len(errors) < 40:
        bearing, distance = rng.uniform(-0.55, 0.55), rng.uniform(0.5, 1.2)
        heading = bearing + np.radians(rng.uniform(-50, 50))
        cMo = leader_at(distance, bearing, heading, rng.uniform(-0.3, 0.3) * distance)
        truth = true_corners(cMo, camera=WIDE)
        if truth.min() < 10 or (truth.max(axis=0) > [629, 469]).any():
            continue
        image = render([(BODY, cMo)], len(errors), camera=WIDE)
        guess = off_by_a_quarter_of_a_cell(rng, truth)
        answer = look(image, guess, camera=WIDE)
        assert found(answer), answer
        errors.append((answer.tag.corners_px - truth).ravel())
        squared.append(squared_in_sigmas(errors[-1], answer.covariance_px2))
        pinhole = CameraModel(width=640, height=480, fx=420, fy=430, cx=330, cy=230)
        straight = look(image, guess, camera=pinhole)
        if found(straight):
            naive.append((straight.tag.corners_px - truth).ravel())
    assert np.sqrt(np.mean(np.square(errors))) < 0.015
    assert np.sum(squared) < stats.chi2.ppf(0.9995, 8 * len(squared))
    assert not naive or np.sqrt(np.mean(np.square(naive))) > 10 * np.sqrt(np.mean(np.square(errors)))


def test_uneven_light_moves_no_corner():
    # A lamp at one side: 20 % brighter at one rim of the tag than in its middle, 20 % darker at the other. Where white
    # is 40 % brighter a threshold halfway between the tag's mean levels lies a tenth of the contrast off, 0.1 x 1.9 px
    # of the ramp (from 10 to 90 %: 2.56 x 0.76 px): 0.2 px. The bound is that of even light.
    rng, errors, squared = np.random.default_rng(3), [], []
    columns, rows = np.meshgrid(np.arange(CAMERA.width), np.arange(CAMERA.height))
    for k in range(30):
        cMo = leader_at(1.1, 0.0, rng.uniform(-0.7, 0.7))
        truth = true_corners(cMo)
        middle, side_px, angle = truth.mean(axis=0), 87.0, rng.uniform(0, 2 * np.pi)
        along = (columns - middle[0]) * np.cos(angle) + (rows - middle[1]) * np.sin(angle)
        lit = 0.8 * (1 + 0.4 * along / side_px) * render([(BODY, cMo)], k, noise_sigma=0.0)
        image = np.clip(np.rint(lit + rng.normal(0, 3, lit.shape)), 0, 255).astype(np.uint8)
        answer = look(image, off_by_a_quarter_of_a_cell(rng, truth))
        assert found(answer), answer
        errors.append((answer.tag.corners_px - truth).ravel())
        squared.append(squared_in_sigmas(errors[-1], answer.covariance_px2))
    assert np.sqrt(np.mean(np.square(errors))) < 0.015 / 0.8  # the contrast is 0.8 of what it was
    low, high = stats.chi2.interval(0.999, 8 * len(squared))
    assert low < np.sum(squared) < high


@pytest.mark.parametrize("sigma_px", [0.3, 0.5, 0.7, 1.0, 1.5, 2.0])
def test_the_blur_that_is_measured_is_the_blur_that_is_there(sigma_px):
    # Drawn sharp, blurred here. A Gaussian sampled at whole pixels has the variance of its samples, not sigma^2; the
    # square pixel adds 1/12. What is fitted is a Gaussian to a shape that is none while it is as narrow as a pixel; it
    # may take up to twice a pixel's own variance more (1/6 px^2). Wide blur reaches over the cells of 9 px: 7 %.
    offsets = np.arange(-8, 9)
    weights = np.exp(-0.5 * (offsets / sigma_px) ** 2)
    variance = (weights * offsets**2).sum() / weights.sum() + 1 / 12
    rng, measured = np.random.default_rng(6), []
    for k in range(6):
        cMo = leader_at(1.1, 0.05 * k - 0.1, 0.15 * k - 0.4)
        sharp = render([(BODY, cMo)], k, blur_sigma_px=0.0, noise_sigma=0.0).astype(float)
        image = np.clip(np.rint(blurred(sharp, sigma_px) + rng.normal(0, 3, sharp.shape)), 0, 255).astype(np.uint8)
        answer = look(image, true_corners(cMo))
        assert found(answer), answer
        measured.append((answer.appearance.blur_u_px2, answer.appearance.blur_v_px2))
    assert np.mean(measured, axis=0) == pytest.approx([variance] * 2, rel=0.07, abs=1 / 6)


@pytest.mark.parametrize("smear_px", [3, 5, 7])
def test_a_sideways_smear_is_seen_as_one(smear_px):
    # A shutter open while the picture moves by n pixels: the mean of n shifted pictures, whose variance along rows is
    # (n^2 - 1) / 12 more. A Gaussian through a box comes out wider than its variance (the box's flanks are straight):
    # up to a third here. Along columns nothing has changed.
    still_px2 = 0.7**2 + 1 / 12
    smeared_px2 = still_px2 + (smear_px**2 - 1) / 12
    rng, measured = np.random.default_rng(7), []
    for k in range(6):
        cMo = leader_at(0.65, 0.02 * k, 0.1 * k)
        still = render([(BODY, cMo)], k, noise_sigma=0.0).astype(float)
        shifts = range(-(smear_px // 2), smear_px // 2 + 1)
        smeared = np.mean([np.roll(still, shift, axis=1) for shift in shifts], axis=0)
        image = np.clip(np.rint(smeared + rng.normal(0, 3, still.shape)), 0, 255).astype(np.uint8)
        answer = look(image, true_corners(cMo))
        assert found(answer), answer
        measured.append((answer.appearance.blur_u_px2, answer.appearance.blur_v_px2))
    along_rows, along_columns = np.mean(measured, axis=0)
    assert smeared_px2 < along_rows < 4 / 3 * smeared_px2
    assert along_columns == pytest.approx(still_px2, abs=1 / 6)


def test_a_tag_that_is_not_near_the_guess_is_looked_for_within_the_search():
    # 20 px aside a guess is more than two cells off at 1.1 m: without a search nothing is there, with one it is found
    # as exactly as from nearby.
    cMo = leader_at(1.1, 0.0, 0.3)
    image, truth = render([(BODY, cMo)], 1), true_corners(cMo)
    aside = truth + np.array([20, -12])
    assert not found(look(image, aside))
    answer = look(image, aside, search_px=30.0)
    assert found(answer)
    assert np.abs(answer.tag.corners_px - truth).max() < 0.05

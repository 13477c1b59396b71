"""One tag in front of a camera, and the corners of its black square measured in the picture to sub-pixel accuracy.

Nothing of the renderer's geometry is used. A side of the black square is found row by row (or column by column): if
a pixel's gray is the mean over its area, then the sum of (gray - black) / (white - black) over a run of pixels
across the edge IS the length of the run's white part. Every such point is taken back to the undistorted image plane,
where the side is a straight line; two lines meet in a corner.
"""

import functools
import pickle

import numpy as np

from pilotfish import core, sim

SIZE_M = 0.16
WHITE, BLACK = 255.0, 0.0
SHARP = sim.Imperfections(blur_sigma_px=0.0, noise_sigma=0.0, clutter=0.0)
# AprilTag's order, in the tag's frame: bottom left, bottom right, top right, top left.
CORNERS_T = np.array([[-1, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]]) * SIZE_M / 2


def rotation(yaw_rad=0.0, tilt_rad=0.0, roll_rad=0.0):
    """About the camera's down, right and forward axes."""
    cy, sy, ct, st, cr, sr = (f(a) for a in (yaw_rad, tilt_rad, roll_rad) for f in (np.cos, np.sin))
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_x = np.array([[1, 0, 0], [0, ct, -st], [0, st, ct]])
    about_z = np.array([[cr, -sr, 0], [sr, cr, 0], [0, 0, 1]])
    return about_y @ about_x @ about_z


def tag_pose(distance_m, yaw_deg=0.0, tilt_deg=0.0, roll_deg=0.0, x_m=0.0, y_m=0.0):
    """cMt: a tag seen head-on if all angles are zero."""
    cMt = np.eye(4)
    cMt[:3, :3] = rotation(*np.radians([yaw_deg, tilt_deg, roll_deg]))
    cMt[:3, 3] = [x_m, y_m, distance_m]
    return cMt


def tag_body(tag_id=0, **look):
    body = sim.RobotBody(white_gray=WHITE, black_gray=BLACK, **look)
    body.leader = core.LeaderBody([core.BodyTag(id=tag_id, size_m=SIZE_M)])
    return body


def body_pose(cMt):
    """cMo for a body whose only tag hangs at its origin."""
    return cMt @ np.linalg.inv(core.BodyTag(size_m=SIZE_M).oMt)


def render_tag(camera, cMt, imperfections=SHARP, **look):
    return renderer_of(camera, imperfections).render([(tag_body(**look), body_pose(cMt))])


@functools.lru_cache(maxsize=8)
def _renderer(camera, pickled_imperfections):
    return sim.Renderer(camera, pickle.loads(pickled_imperfections))


def renderer_of(camera, imperfections=SHARP):
    return _renderer(camera, pickle.dumps(imperfections))  # what can be changed is no key


def corners_in_camera(cMt):
    return CORNERS_T @ cMt[:3, :3].T + cMt[:3, 3]


def undistorted(camera, pixels):
    """(N, 2) pixels to the plane Z = 1, by fixed-point iteration on OpenCV's model, written out on purpose."""
    target = (pixels - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    point = target.copy()
    for _ in range(30):
        x, y = point.T
        r2 = x * x + y * y
        radial = 1 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3))
        shift = np.stack(
            [
                2 * camera.p1 * x * y + camera.p2 * (r2 + 2 * x * x),
                camera.p1 * (r2 + 2 * y * y) + 2 * camera.p2 * x * y,
            ],
            axis=1,
        )
        point = (target - shift) / radial[:, None]
    return point


def measured_corners(image, camera, expected_px):
    """Corners (4, 2) on the plane Z = 1 as the picture has them; `expected_px` only says where to look."""
    lines = []
    for k in range(4):
        points = _edge_points(image.astype(float), np.roll(expected_px, -k, axis=0))
        lines.append(_fitted_line(undistorted(camera, points)))
    meet = [np.cross(lines[k - 1], lines[k]) for k in range(4)]
    return np.array([m[:2] / m[2] for m in meet])


def _edge_points(image, square):
    """(N, 2) points of the edge from square[0] to square[1], one for each row that it crosses, or, if it is nearer to
    level, for each column."""
    a, b = square[0], square[1]
    if abs(b[0] - a[0]) > abs(b[1] - a[1]):
        return _edge_points(image.T, square[:, ::-1])[:, ::-1]
    slope = (b[0] - a[0]) / (b[1] - a[1])
    # Half the run: in one row the edge wanders by half the slope to each side, and one pixel more must be plainly
    # black and plainly white. It must not reach much further: the cells beside the edge are narrow.
    reach = abs(slope) / 2 + 1.0
    inward = 1.0 if _inside(square, (a + b) / 2 + [0.1, 0.0]) > 0 else -1.0
    rows = np.arange(np.ceil(min(a[1], b[1])), np.floor(max(a[1], b[1])) + 1)
    u = a[0] + slope * (rows - a[1])
    # Near the ends the run would leave the black border, or the next side would come into it.
    blackest = u + inward * (reach + 1.0)
    usable = np.min([_inside(square, np.stack([blackest, rows + dv], axis=1)) for dv in (-0.5, 0.5)], axis=0) > 0.2
    points = []
    for row, middle in zip(rows[usable].astype(int), u[usable], strict=True):
        first, last = round(middle - reach), round(middle + reach)
        white = ((image[row, first : last + 1] - BLACK) / (WHITE - BLACK)).sum()
        points.append((first - 0.5 + white if inward > 0 else last + 0.5 - white, row))
    assert len(points) >= 4, "the edge is too short to be measured"
    return np.array(points, dtype=float)


def _inside(square, points):
    """How far each point is inside the square [px]; negative outside."""
    centre = square.mean(axis=0)
    distances = []
    for k in range(4):
        along = square[(k + 1) % 4] - square[k]
        normal = np.array([-along[1], along[0]]) / np.linalg.norm(along)
        distances.append((points - square[k]) @ normal * np.sign(normal @ (centre - square[k])))
    return np.min(distances, axis=0)


def _fitted_line(points):
    """(a, b, c) with a x + b y + c = 0, the total least squares line."""
    mean = points.mean(axis=0)
    _, _, directions = np.linalg.svd(points - mean)
    return np.array([*directions[1], -directions[1] @ mean])

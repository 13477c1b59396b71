"""A camera drawn with NumPy, so that vision is not tested with the simulator's own renderer.

Every pixel is the mean of samples x samples rays, on a grid so sheared that no two share a row or a column:
an upright edge is placed to 1 / samples^2 of a pixel, not to 1 / samples. A ray's pixel is undistorted by
fixed-point iteration, met with each tag's plane, and takes the gray level of the cell that it hits, the
nearest plane first. The only thing taken from the product is the tag's bitmap, which is libapriltag's;
projection, distortion and body geometry are written out again. Pixel (u, v) covers [u - 0.5, u + 0.5] x [v -
0.5, v + 0.5]: its centre is at (u, v).
"""

from dataclasses import dataclass

import numpy as np

from bench.vision.camera_chain import convolved
from pilotfish.core import BodyTag, CameraModel, Lens
from pilotfish.vision import TagFamily

# Camera at the base's origin, level, looking ahead: its right is -y of the base, its down is -z, its forward
# is x.
LARGEST_ANGLE_RAD = np.radians(89.0)
RAYS_AT_ONCE = 2**14  # some rows of the picture, so that what is computed of them stays in the processor's cache
BASE_FROM_CAMERA = np.array([[0.0, 0, 1, 0], [-1, 0, 0, 0], [0, -1, 0, 0], [0, 0, 0, 1]])


def rotation(axis: str, angle_rad: float) -> np.ndarray:
    c, s = np.cos(angle_rad), np.sin(angle_rad)
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


def pose(rotation_matrix=None, translation=(0.0, 0.0, 0.0)) -> np.ndarray:
    matrix = np.eye(4)
    if rotation_matrix is not None:
        matrix[:3, :3] = rotation_matrix
    matrix[:3, 3] = translation
    return matrix


def leader_pose(x_m: float, y_m: float, heading_rad: float, height_m: float = 0.0) -> np.ndarray:
    """cMo of a leader at (x, y) with that heading, seen by a camera that is mounted at the base's origin."""
    return np.linalg.inv(BASE_FROM_CAMERA) @ pose(rotation("z", heading_rad), (x_m, y_m, height_m))


def tag_on_body(tag: BodyTag) -> np.ndarray:
    """oMt, from its definition: x right and y down as one reads it, z into the wall."""
    assert (tag.tilt_rad, tag.roll_rad) == (0.0, 0.0), "not needed here"
    into_wall = -np.array([np.cos(tag.facing_rad), np.sin(tag.facing_rad), 0.0])
    down = np.array([0.0, 0.0, -1.0])
    right = np.cross(down, into_wall)
    return pose(np.column_stack([right, down, into_wall]), tag.position_m)


def fisheye_angle(camera: CameraModel, angle: np.ndarray) -> np.ndarray:
    """Kannala and Brandt: where in the picture, in focal lengths from its middle, a direction at this angle lies."""
    t2 = angle * angle
    return angle * (1 + t2 * (camera.k1 + t2 * (camera.k2 + t2 * (camera.k3 + t2 * camera.k4))))


def fisheye_slope(camera: CameraModel, angle: np.ndarray) -> np.ndarray:
    """Its derivative."""
    t2 = angle * angle
    return 1 + t2 * (3 * camera.k1 + t2 * (5 * camera.k2 + t2 * (7 * camera.k3 + t2 * 9 * camera.k4)))


def distort(camera: CameraModel, points: np.ndarray) -> np.ndarray:
    x, y = points[..., 0], points[..., 1]
    r2 = x * x + y * y
    if camera.lens == Lens.kannala_brandt:
        r = np.sqrt(np.maximum(r2, 1e-24))
        return points * (fisheye_angle(camera, np.arctan(r)) / r)[..., None]
    radial = 1 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3))
    return np.stack(
        [
            x * radial + 2 * camera.p1 * x * y + camera.p2 * (r2 + 2 * x * x),
            y * radial + camera.p1 * (r2 + 2 * y * y) + 2 * camera.p2 * x * y,
        ],
        axis=-1,
    )


def project(camera: CameraModel, points_c: np.ndarray) -> np.ndarray:
    normalized = points_c[..., :2] / points_c[..., 2:3]
    return distort(camera, normalized) * [camera.fx, camera.fy] + [camera.cx, camera.cy]


def undistort(camera: CameraModel, pixels: np.ndarray) -> np.ndarray:
    target = (pixels - [camera.cx, camera.cy]) / [camera.fx, camera.fy]
    if camera.lens == Lens.kannala_brandt:
        wanted = np.maximum(np.linalg.norm(target, axis=-1), 1e-12)
        angle = np.minimum(wanted, LARGEST_ANGLE_RAD)
        for _ in range(20):  # Newton's: twice as many digits each time, and checked
            residual = fisheye_angle(camera, angle) - wanted
            if np.abs(residual).max() < 1e-14:
                return target * (np.tan(angle) / wanted)[..., None]
            angle = np.clip(angle - residual / fisheye_slope(camera, angle), 0.0, LARGEST_ANGLE_RAD)
        raise AssertionError("the distortion cannot be inverted here")
    if not any((camera.k1, camera.k2, camera.k3, camera.p1, camera.p2)):
        return target
    points = target.copy()
    for _ in range(60):
        residual = target - distort(camera, points)
        if np.abs(residual).max() < 1e-9:
            return points
        points = points + residual
    raise AssertionError("the distortion cannot be inverted here")


def corners_px(camera: CameraModel, cMo: np.ndarray, tag: BodyTag) -> np.ndarray:
    """(4, 2): where the black square's corners are, bottom left first, counter-clockwise as one reads it."""
    h = tag.size_m / 2
    corners_t = np.array([[-h, h, 0, 1], [h, h, 0, 1], [h, -h, 0, 1], [-h, -h, 0, 1]])
    return project(camera, (corners_t @ (cMo @ tag_on_body(tag)).T)[:, :3])


@dataclass
class Photography:
    """What stands between the scene and the pixels."""

    samples: int = 4
    white: float = 220.0
    black: float = 30.0
    background: float = 110.0
    clutter: int = 0  # boxes of any gray behind the tags
    blur_sigma_px: float = 0.0
    noise_sigma: float = 0.0
    seed: int = 0


def blurred(image: np.ndarray, sigma_px: float) -> np.ndarray:
    reach = int(np.ceil(4 * sigma_px))
    offsets = np.arange(-reach, reach + 1)
    kernel = np.exp(-0.5 * (offsets / sigma_px) ** 2)
    kernel /= kernel.sum()
    return convolved(image, kernel)


def draw(
    camera: CameraModel,
    tags: list[tuple[BodyTag, np.ndarray]],
    photography: Photography | None = None,
    family: str = "tag36h11",
) -> np.ndarray:
    """The picture (H, W) uint8 of `tags`, pairs of a tag and the pose cMo of the body that wears it."""
    photography = photography or Photography()
    rng = np.random.default_rng(photography.seed)
    image = np.full((camera.height, camera.width), photography.background)
    for _ in range(photography.clutter):
        left, top = rng.integers(0, [camera.width, camera.height])
        width, height = rng.integers(5, 120, size=2)
        image[top : top + height, left : left + width] = rng.uniform(0, 255)
    source = TagFamily(family)
    depth = lambda pair: np.linalg.norm((pair[1] @ tag_on_body(pair[0]))[:3, 3])  # noqa: E731
    for tag, cMo in sorted(tags, key=depth, reverse=True):
        _draw_tag(image, camera, cMo @ tag_on_body(tag), tag, source, photography)
    if photography.blur_sigma_px > 0:
        image = blurred(image, photography.blur_sigma_px)
    if photography.noise_sigma > 0:
        image = image + rng.normal(0, photography.noise_sigma, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def _draw_tag(image, camera, cMt, tag, source, photography):
    if cMt[:3, 2] @ cMt[:3, 3] <= 0:
        return  # its printed side looks away
    cells = source.bitmap(id=tag.id).astype(float) / 255
    cell_m = tag.size_m / source.cells_at_border
    half_m = cells.shape[0] * cell_m / 2
    levels = photography.black + (photography.white - photography.black) * cells

    outline = np.linspace(-half_m, half_m, 9)
    border_t = [(a, b, 0, 1) for a in outline for b in outline]
    border_c = (np.array(border_t) @ cMt.T)[:, :3]
    assert border_c[:, 2].min() > 0.01, "the tag reaches behind the camera"
    border_px = project(camera, border_c)
    first = np.clip(np.floor(border_px.min(axis=0)).astype(int) - 2, 0, [camera.width, camera.height])
    last = np.clip(np.ceil(border_px.max(axis=0)).astype(int) + 3, 0, [camera.width, camera.height])
    if (last <= first).any():
        return
    # A point (a, b, 0) of the tag is seen along cMt (a, b, 0): columns x, y and the translation are the
    # homography.
    plane = np.linalg.inv(cMt[:3][:, [0, 1, 3]])
    rows = max(1, RAYS_AT_ONCE // (photography.samples**2 * (last[0] - first[0])))
    for top in range(first[1], last[1], rows):
        part = (slice(top, min(top + rows, last[1])), slice(first[0], last[0]))
        rays_x, rays_y, by_pixel = _rays(camera, part, photography.samples)
        a, b, depth = (row[0] * rays_x + row[1] * rays_y + row[2] for row in plane)
        column, row = (np.floor(c / depth / cell_m + cells.shape[0] / 2).astype(int) for c in (a, b))
        on_tag = (column >= 0) & (column < cells.shape[0]) & (row >= 0) & (row < cells.shape[0])
        level = levels[np.clip(row, 0, cells.shape[0] - 1), np.clip(column, 0, cells.shape[0] - 1)]
        covered = on_tag.reshape(by_pixel).mean(axis=(1, 3))
        light = (level * on_tag).reshape(by_pixel).mean(axis=(1, 3))
        image[part] = image[part] * (1 - covered) + light


def _rays(camera, part, n):
    """x and y at z = 1 of n x n rays for every pixel of that part (slices of rows and columns), and their shape."""
    shape = (part[0].stop - part[0].start, n, part[1].stop - part[1].start, n)
    rows, columns = np.arange(shape[0] * n)[:, None], np.arange(shape[2] * n)
    u = part[1].start - 0.5 + (columns + (rows % n + 0.5) / n) / n
    v = part[0].start - 0.5 + (rows + (columns % n + 0.5) / n) / n
    rays = undistort(camera, np.stack([u, v], axis=-1))
    return rays[..., 0], rays[..., 1], shape

"""A printed tag in linear light, ray by ray. Shares no code with Pilotfish's renderer: of the product only the tag's
bitmap is used, which is libapriltag's.

Light is counted in units of white paper in full light. Pixel (u, v) covers [u - 0.5, u + 0.5] x [v - 0.5, v + 0.5].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pilotfish import core, vision

SAMPLES = 4  # a side: 16 rays a pixel, on a grid so sheared that no two share a row or a column
RAYS_AT_ONCE = 2**14  # some rows of the picture, so that what is computed of them stays in the processor's cache


@dataclass(frozen=True)
class Sheet:
    """A tag of family 36h11, printed on paper that is glued to a board."""

    tag_id: int = 5
    size_m: float = 0.16
    ring_cells: float = 1.0  # how wide the paper's white ring is
    white: float = 0.85  # reflectance
    black: float = 0.05
    board: float = 0.25
    board_half_m: float = 0.13
    radius_m: float = np.inf  # the sheet is bent around an upright cylinder, away from the camera
    speckles: int = 0  # spots without toner on the black
    speckle_m: float = 0.004
    seed: int = 1  # of the speckles


@dataclass(frozen=True)
class Lighting:
    """What falls on the sheet. Positions are on it, in metres from the tag's middle, x right and y down."""

    gradient: float = 0.0  # change of the light over 0.16 m, along x and y
    shadow: float = 1.0  # light that is left in the shadow: 1 for none
    shadow_at_m: float = 0.0  # where its edge is
    shadow_angle_rad: float = 0.5  # direction across the edge, from x
    penumbra_m: float = 0.002  # standard deviation of the edge
    highlight: float = 0.0  # light added at its middle
    highlight_at_m: tuple[float, float] = (0.0, 0.0)
    highlight_sigma_m: float = 0.03

    def on(self, x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(factor of the reflectance, light added to it) there."""
        factor = 1.0 + self.gradient * (x + 0.5 * y) / 0.16
        if self.shadow < 1.0:
            across = x * np.cos(self.shadow_angle_rad) + y * np.sin(self.shadow_angle_rad) - self.shadow_at_m
            lit = 1.0 / (1.0 + np.exp(-1.702 * np.clip(across / self.penumbra_m, -30, 30)))  # nearly the normal's
            factor = factor * (self.shadow + (1.0 - self.shadow) * lit)
        if self.highlight <= 0.0:
            return factor, np.zeros_like(x)
        squared = (x - self.highlight_at_m[0]) ** 2 + (y - self.highlight_at_m[1]) ** 2
        return factor, self.highlight * np.exp(-0.5 * squared / self.highlight_sigma_m**2)


def backdrop(camera: core.CameraModel, rng: np.random.Generator) -> np.ndarray:
    """(H, W + 200) linear light: boxes of any brightness, to be panned over."""
    light = np.full((camera.height, camera.width + 200), 0.2)
    for _ in range(60):
        width, height = (rng.uniform(0.02, 0.35, 2) * camera.width).astype(int) + 2
        left, top = int(rng.integers(-width, light.shape[1])), int(rng.integers(-height, camera.height))
        light[max(top, 0) : top + height, max(left, 0) : left + width] = rng.uniform(0.02, 0.9)
    return light


def show(
    light: np.ndarray,
    camera: core.CameraModel,
    cMt: np.ndarray,
    sheet: Sheet,
    lighting: Lighting | None = None,
    rows: tuple[int, int] | None = None,
) -> None:
    """Puts the sheet, at cMt (4, 4), into the picture `light` (H, W), or into rows rows[0] to before rows[1]."""
    lighting = lighting or Lighting()
    first, last = _bounds(camera, cMt, sheet)
    if rows is not None:
        first[1], last[1] = max(first[1], rows[0]), min(last[1], rows[1])
    if (last <= first).any():
        return
    rows = max(1, RAYS_AT_ONCE // (SAMPLES * SAMPLES * (last[0] - first[0])))
    for top in range(first[1], last[1], rows):
        _show_rows(light, camera, cMt, sheet, lighting, (first[0], last[0]), (top, min(top + rows, last[1])))


def _show_rows(
    light: np.ndarray,
    camera: core.CameraModel,
    cMt: np.ndarray,
    sheet: Sheet,
    lighting: Lighting,
    across: tuple[int, int],
    down: tuple[int, int],
) -> None:
    """Of the picture only the columns and rows from the first to before the last of `across` and `down`."""
    n = SAMPLES
    shape = (down[1] - down[0], n, across[1] - across[0], n)
    columns, rows = np.arange(shape[2] * n), np.arange(shape[0] * n)[:, None]
    u = across[0] - 0.5 + (columns + (rows % n + 0.5) / n) / n
    v = down[0] - 0.5 + (rows + (columns % n + 0.5) / n) / n
    s, y, hit = _met(*_ray(camera, u, v), cMt, sheet.radius_m)
    on_board = hit & (np.abs(s) < sheet.board_half_m) & (np.abs(y) < sheet.board_half_m)
    factor, added = lighting.on(s, y)
    shine = np.where(on_board, _reflectance(sheet, s, y) * factor + added, 0.0)
    covered = on_board.reshape(shape).mean(axis=(1, 3))
    part = (slice(*down), slice(*across))
    light[part] = light[part] * (1.0 - covered) + shine.reshape(shape).mean(axis=(1, 3))


def _reflectance(sheet: Sheet, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    cell_m = sheet.size_m / 8
    bitmap = vision.TagFamily("tag36h11").bitmap(id=sheet.tag_id) > 127  # (10, 10), with its white ring of one cell
    column, row = (np.floor(c / cell_m + 5).astype(int) for c in (x, y))
    white = bitmap[np.clip(row, 0, 9), np.clip(column, 0, 9)]
    paint = np.where(white, sheet.white, sheet.black)
    spots = np.random.default_rng(sheet.seed).uniform(-0.5, 0.5, (sheet.speckles, 2)) * sheet.size_m
    for spot in spots:
        paint[np.hypot(x - spot[0], y - spot[1]) < sheet.speckle_m] = sheet.white
    paper_m = sheet.size_m / 2 + sheet.ring_cells * cell_m
    return np.where((np.abs(x) < paper_m) & (np.abs(y) < paper_m), paint, sheet.board)


def _met(
    ray_x: np.ndarray, ray_y: np.ndarray, cMt: np.ndarray, radius_m: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(x along the sheet, y, whether it is met) of rays (x, y, 1) in the camera frame."""
    start = -cMt[:3, :3].T @ cMt[:3, 3]
    d = [ray_x * cMt[0, i] + ray_y * cMt[1, i] + cMt[2, i] for i in range(3)]
    if np.isinf(radius_m):
        reach = -start[2] / d[2]
        return start[0] + reach * d[0], start[1] + reach * d[1], reach > 0
    # x^2 + (z - R)^2 = R^2, the nearer of both points.
    a = d[0] ** 2 + d[2] ** 2
    b = start[0] * d[0] + (start[2] - radius_m) * d[2]
    root = b * b - a * (start[0] ** 2 + (start[2] - radius_m) ** 2 - radius_m**2)
    reach = (-b - np.sqrt(np.maximum(root, 0.0))) / a
    x, y, z = (start[i] + reach * d[i] for i in range(3))
    return radius_m * np.arctan2(x, radius_m - z), y, (root > 0) & (reach > 0)


def _ray(camera: core.CameraModel, u: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x and y at z = 1 of what pixels (u, v) see: the lens undone by fixed-point iteration."""
    xd, yd = (u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy
    x, y = xd, yd
    for _ in range(12 if any((camera.k1, camera.k2, camera.k3, camera.p1, camera.p2)) else 0):
        r2 = x * x + y * y
        radial = 1 + r2 * (camera.k1 + r2 * (camera.k2 + r2 * camera.k3))
        x = (xd - 2 * camera.p1 * x * y - camera.p2 * (r2 + 2 * x * x)) / radial
        y = (yd - camera.p1 * (r2 + 2 * y * y) - 2 * camera.p2 * x * y) / radial
    return x, y


def _bounds(camera: core.CameraModel, cMt: np.ndarray, sheet: Sheet) -> tuple[np.ndarray, np.ndarray]:
    """(first, last) pixel (u, v) of the part of the picture that the board may cover."""
    h = sheet.board_half_m
    depth = 0.0 if np.isinf(sheet.radius_m) else sheet.radius_m * (1 - np.cos(h / sheet.radius_m))
    corners = np.array([[x, y, z] for x in (-h, h) for y in (-h, h) for z in (0.0, depth)])
    points = corners @ cMt[:3, :3].T + cMt[:3, 3]
    size = np.array([camera.width, camera.height])
    if points[:, 2].min() < 0.02:
        return np.zeros(2, int), size
    seen = np.array([camera.project(point) for point in points])
    return (
        np.clip(np.floor(seen.min(axis=0)).astype(int) - 2, 0, size),
        np.clip(np.ceil(seen.max(axis=0)).astype(int) + 3, 0, size),
    )

"""From linear light to the bytes that a camera delivers: what happens to a picture between the lens and the program.

    light -> lens (defocus, vignetting, flare) -> electrons (shot and read noise, full well)
          -> [Bayer, and its interpolation] -> gamma -> [sharpening] -> [JPEG]

Shares no code and no assumption with Pilotfish's renderer, which blurs and adds white noise in gray levels: here an
edge is blurred before the gamma bends it, noise grows with light, and what Bayer, sharpening and JPEG leave is
correlated.
"""

from __future__ import annotations

import io
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from PIL import Image

BAYER_GAINS = np.array([0.55, 1.0, 0.65])  # of a red, green, blue pixel to white light
LUMA = np.array([0.299, 0.587, 0.114])


@dataclass(frozen=True)
class Chain:
    """A camera's settings."""

    exposure: float = 0.75  # of the full well, that white paper (1.0) in full light fills
    blur_px: float = 0.7  # standard deviation of the lens's Gaussian part
    defocus_px: float = 0.0  # radius of its disc
    vignetting: float = 0.2  # light lost in the corners
    flare: float = 0.01  # of the mean light, spread over the picture
    full_well: float = 8000.0  # electrons at white
    read_noise: float = 5.0  # electrons
    bayer: bool = False
    srgb: bool = True
    sharpening: float = 0.0  # of the difference from a 3 x 3 mean
    jpeg: int | None = None  # quality

    def photograph(self, light: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        """(H, W) uint8 of linear light (H, W)."""
        seen = self._through_lens(light)
        linear = self._on_sensor(seen, rng)
        levels = 255.0 * (_srgb(linear) if self.srgb else linear)
        if self.sharpening > 0.0:
            levels = levels + self.sharpening * (levels - convolved(levels, np.ones(3) / 3))
        image = np.clip(np.rint(levels), 0, 255).astype(np.uint8)
        if self.jpeg is None:
            return image
        file = io.BytesIO()
        Image.fromarray(image).save(file, "JPEG", quality=self.jpeg)
        return np.asarray(Image.open(file))

    def _through_lens(self, light: np.ndarray) -> np.ndarray:
        seen = light
        if self.defocus_px > 0.0:
            seen = _by_disc(seen, self.defocus_px)
        offsets = np.arange(-int(np.ceil(4 * self.blur_px)), int(np.ceil(4 * self.blur_px)) + 1)
        kernel = np.exp(-0.5 * (offsets / self.blur_px) ** 2)
        seen = convolved(seen, kernel / kernel.sum())
        height, width = seen.shape
        v, u = np.ogrid[0:height, 0:width]
        r2 = ((u - width / 2) ** 2 + (v - height / 2) ** 2) / (width**2 + height**2) * 4
        return seen * (1 - self.vignetting * r2) + self.flare * seen.mean()

    def _on_sensor(self, seen: np.ndarray, rng: np.random.Generator) -> np.ndarray:
        def exposed(share: np.ndarray) -> np.ndarray:
            electrons = share * self.full_well
            noise = rng.normal(0, 1, share.shape) * np.sqrt(np.maximum(electrons, 0) + self.read_noise**2)
            return np.clip((electrons + noise) / self.full_well, 0, 1)

        share = seen * self.exposure
        if not self.bayer:
            return exposed(share)
        colour = _bayer_colour(seen.shape)
        raw = exposed(share * BAYER_GAINS[colour])
        # White balance, then the mean of what there is of each colour in the 3 x 3 around a pixel (bilinear).
        tent = np.array([0.5, 1.0, 0.5])
        planes = []
        for i, gain in enumerate(BAYER_GAINS):
            there = (colour == i).astype(float)
            plane = convolved(raw * there, tent) / convolved(there, tent)
            planes.append(np.minimum(plane / gain, 1.0))
        return sum(weight * plane for weight, plane in zip(LUMA, planes, strict=True))


def _bayer_colour(shape: tuple[int, int]) -> np.ndarray:
    """(H, W) of 0 red, 1 green, 2 blue: RGGB."""
    v, u = np.ogrid[0 : shape[0], 0 : shape[1]]
    return (v % 2) + (u % 2)


def _srgb(linear: np.ndarray) -> np.ndarray:
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def convolved(image: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    """With the kernel along rows and along columns."""
    reach = len(kernel) // 2
    padded = np.pad(image, reach, mode="edge")
    rows = _weighted(kernel, (padded[:, i : i + image.shape[1]] for i in range(len(kernel))))
    return _weighted(kernel, (rows[i : i + image.shape[0]] for i in range(len(kernel))))


def _weighted(weights: np.ndarray, images: Iterable[np.ndarray]) -> np.ndarray:
    """The weighted sum, without a new image for every term."""
    total = None
    for weight, image in zip(weights, images, strict=True):
        if total is None:
            total, term = weight * image, np.empty(image.shape)
        else:
            total += np.multiply(weight, image, out=term)
    return total


def _by_disc(image: np.ndarray, radius_px: float) -> np.ndarray:
    reach = int(np.ceil(radius_px))
    fine = (np.arange(-10 * reach - 5, 10 * reach + 5) + 0.5) / 10
    disc = (np.hypot(*np.meshgrid(fine, fine)) < radius_px).astype(float)
    side = 2 * reach + 1
    kernel = disc.reshape(side, 10, side, 10).mean(axis=(1, 3))
    kernel /= kernel.sum()
    padded = np.pad(image, reach, mode="edge")
    blurred = np.zeros_like(image)
    for j in range(side):
        for i in range(side):
            blurred += kernel[j, i] * padded[j : j + image.shape[0], i : i + image.shape[1]]
    return blurred

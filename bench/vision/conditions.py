"""What the camera chains are shown: cameras, prints and light that Pilotfish does not model, and where the tag is."""

from __future__ import annotations

import math
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from bench.vision import printed_sheet
from bench.vision.camera_chain import Chain
from bench.vision.printed_sheet import Lighting, Sheet
from bench.vision.scenes import FRAME_RATE_HZ, TAG_ID, TAG_SIZE_M, VGA, Motion, Picture, camera_of, corners_px, tag_pose
from pilotfish import core

TYPICAL = Chain()
WEBCAM = Chain(blur_px=0.8, defocus_px=1.0, full_well=2500, read_noise=8, bayer=True, sharpening=1.0, jpeg=70)
ROLLING = camera_of(640, 480, 600.0, readout_s=0.03)
LENS = camera_of(640, 480, 600.0, k1=-0.25, k2=0.08)
FAR_M = (0.65, 1.1, 2.44, 5.0, 8.0)
NEAR_M = (0.65, 1.1, 2.44)
BURST, PAUSE_S = 8, 1.0  # frames that follow one another; then the leader is lost and has moved on
ROLLING_SHUTTER = "rolling shutter"
BAND_ROWS = 4  # that a rolling shutter exposes at once
EVEN = Lighting()
SHEET = Sheet(tag_id=TAG_ID, size_m=TAG_SIZE_M)


@dataclass(frozen=True)
class Condition:
    """A camera and what it looks at. Light that has a place on the sheet wanders over it."""

    name: str
    chain: Chain = TYPICAL
    sheet: Sheet = SHEET
    lighting: Lighting = EVEN
    camera: core.CameraModel = VGA
    distances_m: tuple[float, ...] = NEAR_M
    sideways_radps: float = 0.0  # the tag goes from side to side as fast as that; 0: as a leader indoors
    nearing: bool = False  # the tag comes so near that it is partly outside the picture

    @property
    def in_one_go(self) -> bool:
        """Without pauses in which the leader is lost."""
        return self.nearing or self.camera.readout_s > 0

    def pictures(self, distance_m: float, count: int, seed: int) -> Iterator[Picture]:
        """`count` frames of a leader that moves about at that distance. Same seed: same bytes."""
        rng = np.random.default_rng([seed, zlib.crc32(self.name.encode()), round(1000 * distance_m)])
        path = _nearing(distance_m, rng) if self.nearing else self._motion(distance_m).path(rng)
        behind = printed_sheet.backdrop(self.camera, rng)
        phases = rng.uniform(0, 2 * np.pi, 4)
        sheet = replace(self.sheet, seed=int(rng.integers(1000)))
        for index in range(count):
            t = index / FRAME_RATE_HZ + (0.0 if self.in_one_go else (index // BURST) * PAUSE_S)
            cMt = path(t)
            pan = int(100 + 90 * math.sin(0.7 * t + phases[0]))
            light = behind[:, pan : pan + self.camera.width].copy()
            self._show(light, path, t, sheet, self._light_at(t, phases))
            truth = path(t + self._exposed_after_s(corners_px(self.camera, cMt)[:, 1].mean()))
            yield Picture(self.chain.photograph(light, rng), truth, 1_000_000 + round(t * 1e6))

    def _motion(self, distance_m: float) -> Motion:
        if self.sideways_radps > 0:
            return Motion(distance_m, sideways_mps=self.sideways_radps * distance_m)
        return Motion(distance_m)

    def _exposed_after_s(self, row: float) -> float:
        """After the picture's time, which is that of the middle row."""
        return self.camera.readout_s * ((row + 0.5) / self.camera.height - 0.5)

    def _show(
        self, light: np.ndarray, path: Callable[[float], np.ndarray], t: float, sheet: Sheet, lighting: Lighting
    ) -> None:
        if self.camera.readout_s == 0:
            printed_sheet.show(light, self.camera, path(t), sheet, lighting)
            return
        for row in range(0, self.camera.height, BAND_ROWS):
            cMt = path(t + self._exposed_after_s(row + 0.5 * (BAND_ROWS - 1)))
            printed_sheet.show(light, self.camera, cMt, sheet, lighting, (row, row + BAND_ROWS))

    def _light_at(self, t: float, phases: np.ndarray) -> Lighting:
        across, aside, above = (
            math.sin(rate * t + phase) for rate, phase in zip((2.1, 1.7, 2.3), phases[1:], strict=True)
        )
        half_m = 0.5 * self.sheet.size_m
        return replace(
            self.lighting,
            shadow_at_m=0.8 * half_m * across,
            shadow_angle_rad=self.lighting.shadow_angle_rad + 0.5 * t,
            highlight_at_m=(half_m * aside, half_m * above),
        )


def _nearing(distance_m: float, rng: np.random.Generator) -> Callable[[float], np.ndarray]:
    """cMt (4, 4) by time [s]: from 0.75 m to `distance_m` and on there, swaying: parts of the tag leave the picture."""
    phase = rng.uniform(0, 2 * np.pi, 3)

    def at(t: float) -> np.ndarray:
        return tag_pose(
            max(distance_m, 0.75 - 0.5 * t),
            azimuth_rad=0.30 * math.sin(1.3 * t + phase[0]),
            elevation_rad=0.22 * math.sin(1.1 * t + phase[1]),
            yaw_rad=0.4 * math.sin(1.5 * t + phase[2]),
        )

    return at


CHAINS = (
    Condition("typical", distances_m=FAR_M),
    Condition("webcam", WEBCAM, distances_m=FAR_M),
    Condition("JPEG 90", replace(TYPICAL, jpeg=90), distances_m=FAR_M),
    Condition("JPEG 30", replace(TYPICAL, jpeg=30), distances_m=FAR_M),
    Condition("lens", camera=LENS, distances_m=FAR_M),
    Condition("Bayer", replace(TYPICAL, bayer=True), distances_m=FAR_M),
    Condition("sharpened", replace(TYPICAL, sharpening=1.5), distances_m=FAR_M),
    Condition("low light", replace(TYPICAL, full_well=250, read_noise=4), distances_m=FAR_M),
    Condition("over-exposed", replace(TYPICAL, exposure=1.6), distances_m=FAR_M),
)
SHOWN = (
    Condition("shadow edge", lighting=Lighting(shadow=0.3)),
    Condition("soft shadow", lighting=Lighting(shadow=0.3, penumbra_m=0.02)),
    Condition("half a ring", sheet=replace(SHEET, ring_cells=0.5)),
    Condition("cut close", sheet=replace(SHEET, ring_cells=0.5, board=0.04)),
    Condition("faded print", sheet=replace(SHEET, black=0.35)),
    Condition("white spots", sheet=replace(SHEET, speckles=60)),
    Condition("white-out", replace(TYPICAL, exposure=3.0)),
    Condition("highlight", lighting=Lighting(highlight=1.2)),
    Condition("curved", sheet=replace(SHEET, radius_m=0.35)),
    Condition(ROLLING_SHUTTER, camera=ROLLING, sideways_radps=0.7),
    Condition("partly outside", nearing=True, distances_m=(0.47, 0.38, 0.32)),
)
CONDITIONS = (*CHAINS, *SHOWN)

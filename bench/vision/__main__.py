"""Pilotfish's tracker beside ViSP, AprilTag and OpenCV's ArUco, on the same frames.

Takes: 25 to 45 minutes; 1 with --quick.
"""

import os
import sys
from pathlib import Path

# One thread each: before NumPy, OpenMP (ViSP) or OpenBLAS are loaded.
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"
# `bench` is a package of the repository's root; this folder itself must not be one of the places to import from.
sys.path[0] = str(Path(__file__).resolve().parents[2])

if __name__ == "__main__":
    from bench.vision.cli import app

    app(prog_name="scripts/bench vision --")

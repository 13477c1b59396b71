"""A program that records until it is killed: python killed_writer.py FOLDER. Says how much the disk has taken."""

import sys
from pathlib import Path

from recorded_runs import RecordedRun, drive_at_random

run = RecordedRun(Path(sys.argv[1]))
seed = 0
while True:
    drive_at_random(run, 20, seed)
    seed += 1
    print(run.box.written, flush=True)

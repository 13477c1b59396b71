"""Records onto a disk that never answers: python blocked_disk_writer.py FOLDER. Prints the counters as JSON."""

import json
import os
import sys
from pathlib import Path

from recorded_runs import RecordedRun, drive_at_random

folder = Path(sys.argv[1])
# A file of the far future makes the name of the next one known; that is a pipe without a reader.
(folder / "robot1-99999999999999999-0.lcmlog").touch()
os.mkfifo(folder / "robot1-100000000000000000-0.lcmlog")

run = RecordedRun(folder)
for seed in range(20):
    drive_at_random(run, 50, seed)
    for _ in range(100):
        run.box.message("ROBOT1_IMAGE", bytes(50_000))
print(json.dumps({"written": run.box.written, "dropped": run.box.dropped, "frames": len(run.results)}))

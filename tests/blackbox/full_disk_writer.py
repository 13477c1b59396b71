"""Records more than fits: python full_disk_writer.py FOLDER [largest file in bytes]. Prints what came of it as JSON.

Without a largest file, FOLDER is where a small tmpfs is mounted first (unshare --map-root-user --mount)."""

import json
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

from recorded_runs import RecordedRun, drive_at_random

from pilotfish.black_box import events_in, replay

folder = Path(sys.argv[1])
if len(sys.argv) > 2:
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)  # Python ignores it; a C++ program would be ended by it
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[2]), int(sys.argv[2])))
else:
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=3m", "tmpfs", str(folder)], check=True)

run = RecordedRun(folder, segment_mb=1, total_mb=100)
images, seed = 0, 0
while images < 240 if len(sys.argv) == 2 else run.box.lost < 3:  # 12 MB, or three files
    for _ in range(5 if len(sys.argv) == 2 else 0):
        run.message("ROBOT1_IMAGE", bytes(50_000))
        images += 1
    drive_at_random(run, 20, seed)
    seed += 1
    run.flush()

# A start is recorded behind a gap, at most one a second; then everything fits again.
deadline = time.monotonic() + 20
while run.box.lost > 0 and time.monotonic() < deadline and replay(events_in(folder)).starts < 2:
    drive_at_random(run, 5, seed)
    seed += 1
    time.sleep(0.05)
counters = {"written": run.box.written, "dropped": run.box.dropped, "lost": run.box.lost, "trouble": run.box.trouble}
frames = len(run.results)
run.close()
report = replay(events_in(folder))
files = sorted(folder.glob("*.lcmlog"))
newest = max(event.utime for event in events_in(folder) if hasattr(event, "channel"))
print(
    json.dumps(
        {
            **counters,
            "frames": frames,
            "replayed": report.frames,
            "starts": report.starts,
            "gaps": report.gaps,
            "differences": report.differences,
            "damaged": len(report.damage),
            "bytes": sum(file.stat().st_size for file in files),
            "files": len(files),
            "seconds_old": time.time() - newest * 1e-6,
        }
    )
)

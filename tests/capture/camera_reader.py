"""A program that reads a camera on request, for tests that load a fake one into it. Lines on stdin: ``next``
or ``open``; a line of JSON on stdout for each."""

import json
import sys
import time
import zlib

from pilotfish import capture

NUMBER, WIDTH, HEIGHT, RATE_HZ = (int(word) for word in sys.argv[1:5])


def open_source():
    try:
        return capture.open_camera(NUMBER, width=WIDTH, height=HEIGHT, frame_rate_hz=RATE_HZ)
    except capture.CaptureError as error:
        return str(error)


source = None
for line in sys.stdin:
    if line.strip() == "open":
        source = None  # closed before it is opened again
        source = open_source()
        answer = {"error": source} if isinstance(source, str) else {"described": source.describe()}
    else:
        begin = time.monotonic()
        frame = source.next()
        answer = {"waited_s": time.monotonic() - begin, "why_ended": source.why_ended}
        if frame is not None:
            whole = frame.width > 0
            answer |= {
                "width": frame.width,
                "utime": frame.utime,
                "wall_utime": time.time_ns() // 1000,
                "known_age_us": frame.known_age_us,
                "checksum": zlib.crc32(frame.image.tobytes()) if whole else None,
                "mean": float(frame.image.mean()) if whole else None,
            }
    print(json.dumps(answer), flush=True)

"""Where is the tag, picture by picture? track_images.py FOLDER FOCAL_LENGTH_PX TAG_SIZE_M [ID]"""

import math
import signal
import sys

from pilotfish import capture, core, vision

for number in (signal.SIGINT, signal.SIGPIPE):
    signal.signal(number, signal.SIG_DFL)  # Ctrl-C and `| head` end it, as any program
if len(sys.argv) < 4:
    sys.exit(__doc__)
try:
    focal_length_px, tag_size_m = float(sys.argv[2]), float(sys.argv[3])
    tag_id = int(sys.argv[4]) if len(sys.argv) > 4 else 0
    frames = list(capture.open_images(sys.argv[1]))
    height, width = frames[0].image.shape
    # Without a calibration: square pixels, the optical axis through the middle of the picture, no distortion.
    camera = core.CameraModel(
        width=width,
        height=height,
        fx=focal_length_px,
        fy=focal_length_px,
        cx=(width - 1) / 2,
        cy=(height - 1) / 2,
    )
    # A body of one tag, whose origin is the tag.
    body = core.LeaderBody(tags=[core.BodyTag(id=tag_id, size_m=tag_size_m)])
    observer = vision.LeaderObserver(camera=camera, body=body)
except (OSError, ValueError) as error:
    sys.exit(f"track_images: {error}")

for index, frame in enumerate(frames):
    seen = observer.observe(frame)
    if o := seen.observation:
        print(
            f"{index:4d}: {o.distance_m:.4f} m, bearing {math.degrees(o.bearing_rad):+.2f} deg, "
            f"heading {math.degrees(o.heading_rad):+.2f} deg, {o.reprojection_error_px:.3f} px, by {o.found_by.name}"
        )
    else:
        print(f"{index:4d}: {seen.reason.text}")

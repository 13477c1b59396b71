"""A whole coordinator in your own process: follow_without_lcm.py CONFIG FOLDER. Pictures in, speeds out; no bus."""

import signal
import sys

from pilotfish import capture, coordinator, core

for number in (signal.SIGINT, signal.SIGPIPE):
    signal.signal(number, signal.SIG_DFL)  # Ctrl-C and `| head` end it, as any program
if len(sys.argv) != 3:
    sys.exit(__doc__)
try:
    file = coordinator.load_coordinator(sys.argv[1])
    frames = capture.open_images(sys.argv[2], frame_rate_hz=file.frame_rate_hz)
except (OSError, ValueError) as error:
    sys.exit(f"follow_without_lcm: {error}")
pilot, camera = coordinator.Coordinator(file.coordinator), file.coordinator.camera

for frame in frames:
    # On a robot this is the monotonic clock, read when the picture arrives. Here time passes as the stamps say.
    result = pilot.step(frame, now_us=frame.utime)
    why = f": {result.reason.text}" if result.reason.text else ""
    if result.reason == core.Reason.frame_size_not_calibrated:
        why += f" ({frame.width} x {frame.height}, calibration {camera.width} x {camera.height})"
    distance = f", d = {result.observation.distance_m:.3f} m" if result.observation else ""
    print(
        f"{frame.utime * 1e-6:.3f} s: {result.status.name:9} v = {result.command.linear_mps:+.3f} m/s, "
        f"w = {result.command.angular_radps:+.3f} rad/s{distance}{why}"
    )
# No picture for longer than a measurement is valid: a wheel driver calls this in every period and gets a stop.
end = pilot.command_at(now_us=frame.utime + 200_000)
print(f"later:   {end.status.name:9} v = {end.command.linear_mps:+.3f} m/s")

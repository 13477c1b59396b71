"""What a reason or a counter means to whoever wants to mend it: short texts, by name.

docs/operating-guide.md explains every counter; here stand those that keep a robot from following.
"""

from __future__ import annotations

# reason of a status -> (what it means, what to do)
REASONS: dict[str, tuple[str, str]] = {
    "no_tag_found": (
        "no tag is found in the picture",
        "look at a picture: is the leader in it, lit, sharp, nearer than vision.acquisition_range_m? Is leader: "
        "family the one that was printed?",
    ),
    "tag_refused": (
        "tags of the leader are found and refused",
        "the counters below say by what: tag_margin is contrast (light, glare), tag_residual what covers the tag, "
        "tag_hamming damage of the print",
    ),
    "pose_refused": (
        "the tags do not fit the leader file: no credible pose explains their corners",
        "measure size_m, position_m and facing_deg again (pilotfish learn-body does it from a video), and calibrate "
        "the camera",
    ),
    "frame_too_small": ("the pictures are too small", "use a larger picture and calibrate at that size"),
    "frame_too_large": ("the pictures are too large", "use a smaller picture and calibrate at that size"),
    "frame_truncated": (
        "pictures arrive with fewer bytes than their size promises",
        "look at the camera's program, or at the cable: damaged JPEGs count here too",
    ),
    "frame_stride_invalid": (
        "pictures have a stride shorter than a row",
        "mend row_stride in the camera's program: bytes from one row to the next",
    ),
    "frame_time_not_advancing": (
        "pictures are stamped with times that repeat or go back",
        "stamp every picture with its exposure in microseconds; end a second camera program or a played log on this "
        "channel",
    ),
    "frame_time_implausible": (
        "the pictures' stamps do not fit the time that passes",
        "stamps must be microseconds and not in the future (sudo timedatectl set-ntp true); pilotfish-sim in lock-"
        "step needs --simulated-time at the coordinator",
    ),
    "camera_frozen": (
        "the camera shows the same pixels again and again",
        "plug it in again; for pictures that have no noise by design: safety.noiseless_camera: true",
    ),
    "law_not_finite": (
        "the law failed: it raised, or gave no finite number",
        "this is a fault of the program or of a law of your own: keep the black box and report it",
    ),
    "internal_error": ("the program failed inside", "journalctl -u 'pilotfish-coordinator@*' -n 50, and restart it"),
    "tag_duplicate": (
        "a tag of the leader is seen twice",
        "take the second print of that id out of sight: a reflection or another robot counts too",
    ),
    "tag_outside_frame": (
        "the leader is partly outside the picture",
        "stand farther away or turn the camera (camera.mounting); is the setpoint too near for the lens?",
    ),
    "tag_too_small": (
        "the leader is too far away: its tags are too small to be read",
        "stand nearer, use larger tags, or more pixels",
    ),
    "tag_too_blurred": (
        "the tags are blurred",
        "focus the lens; more light and a shorter exposure (v4l2-ctl --set-ctrl) against motion blur",
    ),
    "tag_size_implausible": (
        "tags have a size that they cannot have at any range",
        "size_m in the leader file is the side of the black square in metres: 0.16, not 16",
    ),
    "leader_behind_camera": (
        "the leader's pose is behind the camera or shows a tag's back",
        "check position_m and facing_deg in the leader file: the rear looks to 180 degrees",
    ),
    "leader_jumped": (
        "the leader is farther from where it was than it can have moved",
        "is a second leader with the same tags, a mirror, or a poster in view?",
    ),
    "picture_repeated": (
        "pictures are repeated",
        "the camera gives fewer pictures than it stamps: a lower frame_rate_hz",
    ),
}

# counter of pilotfish-base -> (what it means, what to do); the most telling first
BASE_COUNTERS: dict[str, tuple[str, str]] = {
    "command_mac_wrong": (
        "commands that were made without its key",
        "key_file of the coordinator and of the base must name copies of one key",
    ),
    "command_simulated": (
        "commands of a simulator or a recording",
        "real wheels ignore them: start the coordinator without --simulated-time, with its camera",
    ),
    "command_foreign": (
        "commands of a second coordinator of this name",
        "end all but one, or give each a name (--name)",
    ),
    "command_expired": (
        "commands whose measurement was too old on arrival",
        "the coordinator is starved or the network holds datagrams up: run both on one computer, with real-time "
        "priority",
    ),
    "command_stale": (
        "commands older than commands.max_command_age_s",
        "run base and coordinator on one computer, with real-time priority",
    ),
    "base_session_wrong": (
        "commands for another run of the base",
        "does the coordinator receive ROBOT_BASE? On another computer both need ttl=1 in --lcm-url; with a key both "
        "need it",
    ),
    "base_mac_wrong": ("states of a base that were made without the key", "give the base the coordinator's key_file"),
    "command_replayed": (
        "recorded commands, or datagrams that came twice",
        "end lcm-logplayer on this bus; is the host in the multicast group twice?",
    ),
    "command_session_ended": (
        "a coordinator continues under a session that was replaced",
        "restart the coordinator",
    ),
    "command_after_gap": (
        "the base did not run for a while",
        "give it real-time priority: ulimit -r, or its systemd unit",
    ),
    "command_out_of_bounds": ("commands that no robot can execute", "compare control.limits with the base's limits"),
    "command_corrupt": ("commands of another version", "install programs of one version"),
    "command_malformed": ("commands without session or counter", "install programs of one version"),
    "another_base": ("a second pilotfish-base of this name", "end one of them"),
    "controller_watchdog": (
        "the motor controller stopped the wheels because no line came for 100 ms",
        "is the computer overloaded? Real-time priority helps",
    ),
    "serial_lost": ("the serial line was unplugged", "check the cable; name it by /dev/serial/by-id/..."),
    "line_checksum_wrong": ("damaged lines from the controller", "check cable, ground and serial.baud"),
}

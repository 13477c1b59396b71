"""What a command is that tells a robot which follows to stand still because no picture came in time."""

NO_PICTURE = ("no_frame", "frame_stale")  # reasons: none came, or it was too old
FOLLOWING = ("tracking", "coasting")  # statuses in which a robot may move

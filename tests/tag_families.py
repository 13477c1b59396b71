"""Every family of tags that libapriltag knows."""

FAMILIES = [
    "tag36h11",
    "tag36h10",
    "tag25h9",
    "tag16h5",
    "tagStandard41h12",
    "tagStandard52h13",
    "tagCircle21h7",
    "tagCircle49h12",
    "tagCustom48h12",
]

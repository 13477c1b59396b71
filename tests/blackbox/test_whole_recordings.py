"""Recordings of every picture, raw on demand, in a ring that is bounded by age as well."""

import os
import time

from recorded_runs import PERIOD_US, RecordedRun

from pilotfish import bus
from pilotfish.black_box import events_in, replay
from pilotfish.black_box.log import files_in
from scenes import leader_pictures


def look_at(run, frames):
    for k, frame in enumerate(frames):
        run.box.picture(frame)
        run.look(frame, 9_000_000 + k * PERIOD_US)
    run.close()


def test_raw_pictures_are_kept_to_the_pixel_and_seen_again_bit_for_bit(tmp_path):
    frames = leader_pictures(25, hidden_from=20)
    look_at(RecordedRun(tmp_path, picture_rate_hz=1000.0, raw_pictures=True), frames)
    (file,) = files_in(tmp_path)
    kept = list(bus.LogReader(str(file), channel="ROBOT1_IMAGE"))
    assert [picture.utime for picture in kept] == [frame.utime for frame in frames]
    assert all((picture.image == frame.image).all() for picture, frame in zip(kept, frames, strict=True))
    report = replay(events_in(tmp_path), from_pixels=True)
    assert report.first_difference is None
    assert (report.frames, report.observations, report.observations_unchecked) == (25, 25, 0)
    assert 0 < report.measured <= 20


def test_every_picture_is_kept_however_fast_they_come(tmp_path):
    frames = leader_pictures(10)
    run = RecordedRun(tmp_path, picture_rate_hz=1000.0)
    for frame in frames:
        run.box.picture(frame)
    run.close()
    assert sum(event.channel == "ROBOT1_IMAGE" for event in events_in(tmp_path)) == 10


def test_one_changed_pixel_of_a_tag_is_found(tmp_path):
    frames = leader_pictures(6)
    look_at(RecordedRun(tmp_path, picture_rate_hz=1000.0, raw_pictures=True), frames)
    (file,) = files_in(tmp_path)
    content = bytearray(file.read_bytes())
    pixels = frames[5].image.tobytes()
    at = content.index(pixels)
    v, u = (int(c) for c in leader_corner(frames[5]))
    content[at + v * 640 + u] ^= 0x7F
    file.write_bytes(content)
    report = replay(events_in(tmp_path), from_pixels=True)
    assert report.differences > 0 and report.first_difference.what == "what was seen"


def leader_corner(frame):
    """Row and column of the pixel nearest to a corner of a tag, where the fit looks."""
    from pilotfish import coordinator
    from pilotfish import data as shipped

    file = coordinator.load_coordinator(shipped.path("config/line.yaml"))
    seen = coordinator.Coordinator(file.coordinator).step(frame, 1_000_000).observation
    return seen.tags[0].corners_px[0][::-1].round()


def test_files_older_than_allowed_are_deleted_when_the_next_is_written(tmp_path):
    for _ in range(3):
        look_at(RecordedRun(tmp_path), leader_pictures(2))
    old, older, recent = files_in(tmp_path)
    two_hours_ago_s = time.time() - 7200.0
    for file in (old, older):
        os.utime(file, (two_hours_ago_s, two_hours_ago_s))
    look_at(RecordedRun(tmp_path, max_age_h=1.0), leader_pictures(2))
    left = files_in(tmp_path)
    assert recent in left and old not in left and older not in left and len(left) == 2


def test_without_a_limit_of_age_old_files_stay(tmp_path):
    look_at(RecordedRun(tmp_path), leader_pictures(2))
    (old,) = files_in(tmp_path)
    os.utime(old, (1_000_000.0, 1_000_000.0))
    look_at(RecordedRun(tmp_path), leader_pictures(2))
    assert old in files_in(tmp_path)

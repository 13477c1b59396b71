"""What is exported for Rerun is read back by Rerun's own reader. Skipped without rerun-sdk (170 MB, an extra of its
own)."""

from __future__ import annotations

import io
import math
import sys

import numpy as np
import pytest
from PIL import Image
from recordings import PERIOD_US, STAMP_US, WALL_US, Writer
from typer.testing import CliRunner

from pilotfish.cli import app
from pilotfish.logs import read_run
from pilotfish.logs.columns import CORNERS
from pilotfish.logs.export import rerun_columns
from pilotfish.logs.export.to_rrd import export_rrd


def test_without_rerun_it_says_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "rerun", None)
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    result = CliRunner().invoke(app, ["export", str(writer.file), "--out", str(tmp_path / "x.rrd")])
    assert result.exit_code == 69
    assert "pip install 'pilotfish[rerun]'" in " ".join(result.output.split())
    assert not (tmp_path / "x.rrd").exists()


@pytest.fixture
def read_back():
    """A function from a file to entity -> component -> [(exposure [us], value)], by rerun.chunk.RrdReader."""
    pytest.importorskip("rerun")
    from rerun.chunk import RrdReader

    def read(file):
        found = {}
        for chunk in RrdReader(str(file)).stream().to_chunks():
            batch = chunk.to_record_batch()
            named = dict(zip(batch.schema.names, batch.columns, strict=True))
            times = named["exposure"].cast("int64").to_pylist() if "exposure" in named else [None] * batch.num_rows
            per_us = 1000 if "exposure" in named and named["exposure"].type.unit == "ns" else 1
            for name, values in named.items():
                rows = zip(times, values.to_pylist(), strict=True)
                own = found.setdefault(chunk.entity_path, {}).setdefault(name, [])
                own += [(t and t // per_us, value) for t, value in rows if value is not None]
        return found

    return read


def scalars(found, entity):
    """(N, 2): exposure [us] and value of a series, in the order of time."""
    return sorted((utime, value[0]) for utime, value in found[entity]["Scalars:scalars"])


def test_every_number_of_every_frame_comes_back_at_its_exposure(recorded, tmp_path, read_back, monkeypatch):
    monkeypatch.setattr(rerun_columns, "ROWS_AT_ONCE", 32)  # in several pieces
    export_rrd(recorded.bus, tmp_path / "x.rrd")
    found, frames = read_back(tmp_path / "x.rrd"), read_run(recorded.bus).robots["robot1"].frames
    for name in ("distance_m", "bearing_rad", "heading_rad", "command_linear_mps", "error_m", "latency_s"):
        known = np.isfinite(frames[name])
        expected = sorted(zip(frames["utime_us"][known].tolist(), frames[name][known].tolist(), strict=True))
        assert scalars(found, f"/robot1/frames/{name}") == expected, name
        assert len(expected) > 60


def test_images_are_those_recorded_each_at_its_stamp(tmp_path, read_back):
    writer, noise = Writer(tmp_path / "run.log"), np.random.default_rng(1)
    gray = noise.integers(0, 255, (48, 64)).astype(np.uint8)
    colour = np.zeros((48, 64, 3), np.uint8)
    colour[:, :, 0] = 200  # of BGR: blue
    writer.image(gray)
    writer.frame()
    writer.passes()
    writer.image(colour)
    writer.passes()
    writer.image(gray, jpeg=True)
    export_rrd(writer.file, tmp_path / "x.rrd")
    image = read_back(tmp_path / "x.rrd")["/robot1/camera/image"]
    raw = {utime: bytes(value[0]) for utime, value in image["Image:buffer"]}
    assert raw[STAMP_US] == gray.tobytes()
    assert np.frombuffer(raw[STAMP_US + PERIOD_US], np.uint8).reshape(48, 64, 3)[0, 0].tolist() == [0, 0, 200]
    ((utime, jpeg),) = image["EncodedImage:blob"]
    assert utime == STAMP_US + 2 * PERIOD_US
    with Image.open(io.BytesIO(bytes(jpeg[0]))) as back:
        assert (back.format, back.size) == ("JPEG", (64, 48))


def test_outlines_are_half_a_pixel_off_because_rerun_counts_from_the_pixel_s_corner(recorded, tmp_path, read_back):
    export_rrd(recorded.box, tmp_path / "x.rrd")
    found, tags = read_back(tmp_path / "x.rrd"), read_run(recorded.box).robots["robot1"].tags
    outlines = dict(found["/robot1/camera/image/tags"]["LineStrips2D:strips"])
    labels = dict(found["/robot1/camera/image/tags"]["LineStrips2D:labels"])
    assert len(outlines) > 60
    for utime, strips in outlines.items():
        rows = np.flatnonzero(tags["utime_us"] == utime)
        corners = np.stack([tags[name][rows] for name in CORNERS], axis=1).reshape(-1, 4, 2)
        closed = np.concatenate([corners, corners[:, :1]], axis=1)
        np.testing.assert_allclose(np.array(strips), closed + 0.5, rtol=0, atol=1e-4)  # 32 bits: 640 px to 6e-5
        assert labels[utime] == [f"id {number}" for number in tags["id"][rows]]


def test_the_leader_s_pose_is_its_distance_bearing_and_heading(recorded, tmp_path, read_back):
    export_rrd(recorded.bus, tmp_path / "x.rrd")
    leader, frames = read_back(tmp_path / "x.rrd")["/robot1/leader"], read_run(recorded.bus).robots["robot1"].frames
    places, turns = dict(leader["Transform3D:translation"]), dict(leader["Transform3D:quaternion"])
    measured = np.flatnonzero(frames["measured"])
    assert len(measured) > 60
    for row in measured:
        utime = int(frames["utime_us"][row])
        ((x, y, z),), ((qx, qy, qz, qw),) = places[utime], turns[utime]  # 32 bits: 2 m to 2e-7
        assert math.hypot(x, y) == pytest.approx(frames["distance_m"][row], abs=1e-6)
        assert math.atan2(y, x) == pytest.approx(frames["bearing_rad"][row], abs=1e-6)
        assert 2 * math.atan2(qz, qw) == pytest.approx(frames["heading_rad"][row], abs=1e-6)
        assert (z, qx, qy) == (0.0, 0.0, 0.0)


def test_a_leader_that_is_lost_is_not_shown_at_its_last_place(tmp_path, read_back):
    writer = Writer(tmp_path / "run.log")
    writer.frame(2.0)
    writer.passes()
    writer.frame(None)
    export_rrd(writer.file, tmp_path / "x.rrd")
    leader = read_back(tmp_path / "x.rrd")["/robot1/leader"]
    assert [utime for utime, value in leader["Transform3D:translation"] if value] == [STAMP_US]
    assert [utime for utime, value in leader["Clear:is_recursive"] if value] == [STAMP_US + PERIOD_US]


def test_events_have_the_wall_clock_and_the_settings_are_there(recorded, tmp_path, read_back):
    from pilotfish import data

    export_rrd(recorded.box, tmp_path / "x.rrd")
    found = read_back(tmp_path / "x.rrd")
    texts = [value[0] for _, value in found["/robot1/events"]["TextLog:text"]]
    assert any(text.startswith("status: ") for text in texts)
    wall_us = [value.value // 1000 for _, value in found["/robot1/events"]["logged"]]
    assert min(wall_us) > WALL_US  # of the run a moment ago, not of the stamps, which begin at 0
    (config,) = [entity for entity in found if entity.startswith("/robot1/settings/start0/config/")]
    assert found[config]["TextDocument:text"][0][1][0] == data.path("config/line.yaml").read_text()


def test_without_images_the_file_has_none(tmp_path, read_back):
    writer = Writer(tmp_path / "run.log")
    writer.image(np.zeros((48, 64), np.uint8))
    writer.frame()
    assert export_rrd(writer.file, tmp_path / "x.rrd", images=False) == 1
    assert "/robot1/camera/image" not in read_back(tmp_path / "x.rrd")


def test_the_command_writes_what_rerun_opens(recorded, tmp_path, read_back):
    result = CliRunner().invoke(
        app, ["export", str(recorded.bus), "--format", "rrd", "--out", str(tmp_path / "my run.rrd")]
    )
    assert result.exit_code == 0, result.output
    assert "frames and images" in result.output
    assert len(read_back(tmp_path / "my run.rrd")) > 20
    assert [file.name for file in tmp_path.iterdir()] == ["my run.rrd"]

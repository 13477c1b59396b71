"""What is exported comes back: bit for bit, by readers of other people."""

from __future__ import annotations

import csv
import json
import math

import av
import lcm
import numpy as np
import pyarrow.parquet
import pytest
from mcap.reader import make_reader
from recordings import PERIOD_US, Writer

from pilotfish.errors import RecordingError
from pilotfish.lcmtypes.bot_core import image_t
from pilotfish.lcmtypes.pilotfish import command_t, observation_t, status_t
from pilotfish.logs import TABLES, read_run
from pilotfish.logs.export.overlay import BAR_PX
from pilotfish.logs.export.to_csv import export_csv
from pilotfish.logs.export.to_mcap import export_mcap
from pilotfish.logs.export.to_mp4 import export_mp4
from pilotfish.logs.export.to_parquet import export_parquet


def events(file, channel, kind):
    log = lcm.EventLog(str(file), "r")
    try:
        return [(one.timestamp, kind.decode(one.data)) for one in log if one.channel == channel]
    finally:
        log.close()


def table_of(run, name):
    """(column, values) with words spelled and None for what is not known."""
    table = getattr(run.robots["robot1"], name)
    for column in table.columns:
        values = (table.words(column.name) if column.kind == "word" else table[column.name]).tolist()
        unknown = {"word": "", "int": -1}.get(column.kind)
        yield column, [None if value == unknown or value != value else value for value in values]


@pytest.mark.parametrize("table", ["frames", "tags", "commands"])
@pytest.mark.parametrize("which", ["box", "bus"])
def test_csv_gives_every_bit_back(recorded, tmp_path, table, which):
    path = getattr(recorded, which)
    count = export_csv(path, tmp_path / "x.csv", table=table, robot="robot1")
    with (tmp_path / "x.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == count > 80
    assert {row["robot"] for row in rows} == {"robot1"}
    parse = {"float": float, "int": int, "bool": lambda text: text == "1", "word": str, "text": str}
    for column, values in table_of(read_run(path), table):
        unknown = False if column.kind == "bool" else None  # of a yes or no an array cannot say that it is not known
        back = [unknown if row[column.name] == "" else parse[column.kind](row[column.name]) for row in rows]
        assert back == values, column.name


@pytest.mark.parametrize("table", ["frames", "tags", "commands"])
def test_parquet_gives_every_bit_back_with_units(recorded, tmp_path, table):
    export_parquet(recorded.box, tmp_path / "x.parquet", table=table)
    file = pyarrow.parquet.read_table(tmp_path / "x.parquet")
    for column, values in table_of(read_run(recorded.box), table):
        assert file[column.name].to_pylist() == values, column.name
        said = file.schema.field(column.name).metadata
        assert said == {b"unit": column.unit.encode(), b"description": column.text.encode()}
    settings = json.loads(pyarrow.parquet.read_metadata(tmp_path / "x.parquet").metadata[b"pilotfish.settings"])
    assert settings["robot1"][0]["program"].startswith("pilotfish ")


def test_parquet_is_written_in_groups_of_rows(tmp_path, monkeypatch):
    monkeypatch.setattr("pilotfish.logs.export.to_parquet.ROWS_PER_GROUP", 10)
    writer = Writer(tmp_path / "run.log")
    for k in range(25):
        writer.frame(1.0 + k)
        writer.passes()
    export_parquet(writer.file, tmp_path / "x.parquet")
    assert pyarrow.parquet.read_metadata(tmp_path / "x.parquet").num_row_groups == 3
    assert pyarrow.parquet.read_table(tmp_path / "x.parquet")["distance_m"].to_pylist() == [1.0 + k for k in range(25)]


def mcap_messages(file):
    """topic -> [(schema name, log time [ns], message)] in the order of the file, by mcap's own reader."""
    found = {}
    with file.open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages(log_time_order=False):
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            found.setdefault(channel.topic, []).append((schema.name, message.log_time, json.loads(message.data)))
    return found


@pytest.mark.parametrize(
    ("channel", "kind"), [("COMMAND", command_t), ("OBSERVATION", observation_t), ("STATUS", status_t)]
)
def test_mcap_gives_every_number_of_every_message_back(recorded, tmp_path, channel, kind):
    export_mcap(recorded.bus, tmp_path / "x.mcap", images=False)
    back = mcap_messages(tmp_path / "x.mcap")[f"ROBOT1_{channel}"]
    sent = events(recorded.bus, f"ROBOT1_{channel}", kind)
    assert [(name, log_time) for name, log_time, _ in back] == [
        (f"pilotfish.{kind.__name__}", 1000 * t) for t, _ in sent
    ]
    compared = 0
    for (_, _, now), (_, was) in zip(back, sent, strict=True):
        for name, type_name in zip(was.__slots__, was.__typenames__, strict=True):
            if type_name in ("double", "float", "int64_t", "int32_t", "int8_t", "string"):
                assert np.array_equal(now[name], getattr(was, name)), name
                compared += np.size(now[name])
    assert compared > 500


def test_mcap_has_what_foxglove_draws(recorded, tmp_path):
    export_mcap(recorded.bus, tmp_path / "x.mcap")
    found = mcap_messages(tmp_path / "x.mcap")
    assert {topic: messages[0][0] for topic, messages in found.items() if topic.startswith("/robot1")} == {
        "/robot1/image_raw": "foxglove.RawImage",
        "/robot1/tags": "foxglove.ImageAnnotations",
        "/robot1/leader_pose": "foxglove.PoseInFrame",
        "/robot1/events": "foxglove.Log",
        "/robot1/frames": "pilotfish.frames",
    }
    frames = read_run(recorded.bus).robots["robot1"].frames
    rows = [message for _, _, message in found["/robot1/frames"]]
    assert [row["distance_m"] or math.nan for row in rows] == pytest.approx(frames["distance_m"], abs=0, nan_ok=True)
    measured = [row for row in rows if row["measured"]]
    for row, (_, _, pose) in zip(measured, found["/robot1/leader_pose"], strict=True):
        where, turn = pose["pose"]["position"], pose["pose"]["orientation"]
        assert math.hypot(where["x"], where["y"]) == pytest.approx(row["distance_m"], abs=1e-12)
        assert math.atan2(where["y"], where["x"]) == pytest.approx(row["bearing_rad"], abs=1e-12)
        assert 2 * math.atan2(turn["z"], turn["w"]) == pytest.approx(row["heading_rad"], abs=1e-12)


def test_images_in_an_mcap_file_have_the_stamps_and_the_bytes_of_the_recorded_ones(recorded, tmp_path):
    import base64

    export_mcap(recorded.bus, tmp_path / "x.mcap")
    found = mcap_messages(tmp_path / "x.mcap")["/robot1/image_raw"]
    for (_, image), (_, _, message) in zip(events(recorded.bus, "ROBOT1_IMAGE", image_t), found, strict=True):
        assert base64.b64decode(message["data"]) == bytes(image.data)
        assert message["timestamp"]["sec"] * 1_000_000 + message["timestamp"]["nsec"] // 1000 == image.utime
        assert (message["width"], message["height"], message["encoding"]) == (640, 480, "mono8")


def test_annotations_are_half_a_pixel_off_because_foxglove_counts_from_the_pixel_s_corner(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    export_mcap(writer.file, tmp_path / "x.mcap")
    ((_, _, message),) = mcap_messages(tmp_path / "x.mcap")["/robot1/tags"]
    (outline,) = message["points"]
    assert outline["points"][0] == {"x": 10.5, "y": 40.5}  # recordings.py: (10, 40), the centre of that pixel
    assert message["texts"][0]["text"] == "id 3"


def test_the_schemas_say_what_the_messages_hold(recorded, tmp_path):
    """Every field of every message is in its schema, with a type that fits."""
    export_mcap(recorded.box, tmp_path / "x.mcap")
    fits = {"number": (int, float), "integer": int, "string": str, "boolean": bool, "array": list, "object": dict}

    def check(schema, value, where):
        if value is None:
            return
        if "type" in schema:
            assert isinstance(value, fits[schema["type"]]), where
        if isinstance(value, dict):
            assert set(schema.get("required", [])) <= set(value) <= set(schema["properties"]), where
            for key, inside in value.items():
                check(schema["properties"][key], inside, f"{where}.{key}")
        elif isinstance(value, list):
            for inside in value:
                check(schema["items"], inside, f"{where}[]")

    with (tmp_path / "x.mcap").open("rb") as stream:
        for schema, channel, message in make_reader(stream).iter_messages():
            check(json.loads(schema.data), json.loads(message.data), channel.topic)


def test_an_mcap_file_of_a_black_box_carries_the_configuration(recorded, tmp_path):
    from pilotfish import data

    export_mcap(recorded.box, tmp_path / "x.mcap")
    with (tmp_path / "x.mcap").open("rb") as stream:
        texts = {one.name.split("/")[2]: one.data.decode() for one in make_reader(stream).iter_attachments()}
    with (tmp_path / "x.mcap").open("rb") as stream:
        (said,) = make_reader(stream).iter_metadata()
    assert texts["config"] == data.path("config/line.yaml").read_text()
    assert "--black-box" in said.metadata["command_line"]


def test_what_is_no_number_becomes_null_and_not_a_broken_file(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame(math.inf)
    writer.passes()
    writer.frame(1.0)
    export_mcap(writer.file, tmp_path / "x.mcap")
    found = mcap_messages(tmp_path / "x.mcap")
    assert [message["distance_m"] for _, _, message in found["ROBOT1_OBSERVATION"]] == [None, 1.0]


def frames_of(file):
    """(times [s], pictures) of a video, by PyAV."""
    with av.open(str(file)) as container:
        stream = container.streams.video[0]
        assert (stream.codec_context.name, stream.codec_context.pix_fmt) == ("h264", "yuv420p")
        frames = [(float(f.pts * stream.time_base), f.to_ndarray(format="rgb24")) for f in container.decode(stream)]
    return np.array([time_s for time_s, _ in frames]), [pixels for _, pixels in frames]


def test_a_video_has_every_recorded_image_at_its_time(recorded, tmp_path):
    count = export_mp4(recorded.bus, tmp_path / "x.mp4")
    stamps = np.array([image.utime for _, image in events(recorded.bus, "ROBOT1_IMAGE", image_t)])
    times_s, pictures = frames_of(tmp_path / "x.mp4")
    assert count == len(times_s) == len(stamps) > 80
    np.testing.assert_allclose(times_s, (stamps - stamps[0]) * 1e-6, rtol=0, atol=1e-6)
    assert pictures[0].shape == (480 + BAR_PX, 640, 3)


def test_the_times_of_a_video_are_the_stamps_also_when_frames_were_dropped(tmp_path):
    writer = Writer(tmp_path / "run.log")
    noise = np.random.default_rng(1)
    expected_s = []
    for us in (0, 33_333, 33_334, 400_000, 41_000):
        writer.passes(us)
        expected_s.append((writer.wall_us - 1_764_000_000_000_000) * 1e-6)
        writer.image(noise.integers(0, 255, (48, 64)).astype(np.uint8))
        writer.frame()
    export_mp4(writer.file, tmp_path / "x.mp4")
    np.testing.assert_allclose(frames_of(tmp_path / "x.mp4")[0], expected_s, rtol=0, atol=1e-6)


def along(corners, inward_px):
    """Points on the four sides of a tag, away from its corners, moved towards its centre by inward_px."""
    middle = corners.mean(axis=0)
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        normal = np.array([b[1] - a[1], a[0] - b[0]]) / np.hypot(*(b - a))
        normal *= np.sign(normal @ (middle - a))
        for share in (0.3, 0.5, 0.7):
            yield a + share * (b - a) + inward_px * normal


def test_the_outline_lies_on_the_edge_of_the_tag(recorded, tmp_path):
    """The picture is gray, so colour is the overlay; and where the overlay is, black square and white ring meet."""
    export_mp4(recorded.bus, tmp_path / "x.mp4")
    run = read_run(recorded.bus).robots["robot1"]
    _, pictures = frames_of(tmp_path / "x.mp4")
    images = events(recorded.bus, "ROBOT1_IMAGE", image_t)
    corners = np.stack([run.tags[f"{axis}{k}_px"] for k in range(4) for axis in "uv"], axis=1).reshape(-1, 4, 2)
    checked = 0
    for (_, image), picture in list(zip(images, pictures, strict=True))[::10]:
        recorded_gray = np.frombuffer(image.data, np.uint8).reshape(480, 640).astype(int)
        colour = picture[:480].astype(int)
        colour = colour[:, :, 0] - colour[:, :, 2]  # vermillion: red 213, blue 0
        for tag in corners[run.tags["utime_us"] == image.utime]:
            if min(np.linalg.norm(tag - np.roll(tag, 1, axis=0), axis=1)) < 30:
                continue  # a tag seen from the side: 4 px to its edge is not 4 px into the black
            u, v = np.round([*along(tag, 0.0)]).astype(int).T
            # Colour has half the resolution: of the 213 of a line beside gray between a quarter and 0.6 is left.
            assert colour[v, u].min() > 40
            u, v = np.round([*along(tag, 8.0)]).astype(int).T
            assert np.abs(colour[v, u]).max() < 40
            (u, v), (x, y) = (np.round([*along(tag, px)]).astype(int).T for px in (3.0, -3.0))
            assert recorded_gray[v, u].mean() + 60 < recorded_gray[y, x].mean()
            checked += 1
    assert checked >= 8


def test_without_an_overlay_the_video_is_the_camera_s(tmp_path):
    writer = Writer(tmp_path / "run.log")
    gray = np.repeat(np.linspace(0, 255, 64).astype(np.uint8)[None], 48, axis=0)
    writer.image(gray)
    writer.frame()
    export_mp4(writer.file, tmp_path / "x.mp4", overlay=False)
    (picture,) = frames_of(tmp_path / "x.mp4")[1]
    assert picture.shape == (48, 64, 3)
    assert np.abs(picture[:, :, 1].astype(int) - gray).mean() < 4  # H.264 is lossy


def test_colour_jpegs_odd_sizes_and_damaged_images_become_a_video(tmp_path):
    writer = Writer(tmp_path / "run.log")
    colour = np.zeros((47, 63, 3), np.uint8)
    colour[:, :, 0] = 200  # red in a JPEG, blue in BGR
    writer.image(colour, jpeg=True)
    writer.passes()
    writer.image(colour)
    writer.passes()
    broken = image_t()
    broken.utime, broken.width, broken.height, broken.row_stride = writer.stamp_us, 63, 47, 63
    broken.pixelformat, broken.data, broken.size = image_t.PIXEL_FORMAT_GRAY, b"abc", 3
    writer.write("IMAGE", broken)
    assert export_mp4(writer.file, tmp_path / "x.mp4", overlay=False) == 2
    _, (red, blue) = frames_of(tmp_path / "x.mp4")
    assert red.shape == (48, 64, 3)
    assert red[20, 30, 0] > 150 > red[20, 30, 2]
    assert blue[20, 30, 2] > 150 > blue[20, 30, 0]


def test_a_recording_without_images_says_who_keeps_them(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    with pytest.raises(RecordingError, match="lcm-logger keeps all"):
        export_mp4(writer.file, tmp_path / "x.mp4")
    assert list(tmp_path.glob("*mp4*")) == list(tmp_path.glob(".*part")) == []


def test_a_table_without_rows_is_refused_with_those_that_have_some(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    with pytest.raises(RecordingError, match=r"tables with rows: frames \(1\)"):
        export_csv(writer.file, tmp_path / "x.csv", table="wheels")
    assert [file.name for file in tmp_path.iterdir()] == ["run.log"]


def test_an_export_that_fails_leaves_what_was_there(tmp_path):
    writer = Writer(tmp_path / "run.log")
    writer.frame()
    (tmp_path / "x.csv").write_text("precious")
    with pytest.raises(RecordingError):
        export_csv(writer.file, tmp_path / "x.csv", table="wheels")
    assert (tmp_path / "x.csv").read_text() == "precious"


def test_every_column_of_every_table_has_a_name_with_its_unit_or_none():
    endings = {"s": "_s", "us": "_us", "m": "_m", "rad": "_rad", "m/s": "_mps", "rad/s": "_radps", "px": "_px"}
    endings |= {"ms": "_ms", "Hz": "_hz"}
    for columns in TABLES.values():
        for column in columns:
            assert column.unit not in endings or column.name.endswith(endings[column.unit]), column.name
    assert PERIOD_US == 33_333


def test_memory_of_a_stream_does_not_grow_with_the_run(tmp_path):
    """Ten times the frames: not twice the memory."""
    import tracemalloc

    peaks = []
    for count in (200, 2000):
        writer = Writer(tmp_path / f"{count}.log")
        for _ in range(count):
            writer.frame()
            writer.passes()
        export_csv(writer.file, tmp_path / "warm.csv")
        tracemalloc.start()
        export_csv(writer.file, tmp_path / "x.csv")
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 2 * peaks[0]

"""The section `black_box` of the coordinator's file."""

import pytest
from recorded_runs import CONFIG_PATH

from pilotfish import coordinator
from pilotfish import data as shipped


def load(tmp_path, section):
    text = shipped.path("config/line.yaml").read_text().replace("../", f"{shipped.root()}/")
    (tmp_path / "config.yaml").write_text(f"{text}\nblack_box: {section}\n")
    return coordinator.load_coordinator(str(tmp_path / "config.yaml")).black_box


def test_without_the_section_nothing_is_recorded():
    assert coordinator.load_coordinator(CONFIG_PATH).black_box.directory == ""


def test_folder_and_sizes_are_read(tmp_path):
    box = load(tmp_path, "{directory: /var/lib/pilotfish, total_mb: 200, segment_mb: 20, picture_rate_hz: 0.5}")
    assert (box.directory, box.total_mb, box.segment_mb, box.picture_rate_hz) == ("/var/lib/pilotfish", 200, 20, 0.5)


@pytest.mark.parametrize(
    ("section", "key"),
    [
        ("{total_mb: 30, segment_mb: 20}", "black_box.total_mb"),  # one file and no room for the next
        ("{segment_mb: 0}", "black_box.segment_mb"),
        ("{directory: [a]}", "black_box.directory"),
        ("{picture_rate_hz: -1}", "black_box.picture_rate_hz"),
        ("{total: 5}", "black_box.total"),
    ],
)
def test_what_cannot_be_is_refused_with_its_key(tmp_path, section, key):
    with pytest.raises(ValueError, match=key.replace(".", r"\.")):
        load(tmp_path, section)

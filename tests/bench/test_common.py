"""What the benchmarks share does what its words say."""

import math
from pathlib import Path

import yaml

from bench.common.configuration import shipped_coordinator
from bench.common.processes import process, work
from bench.common.statistics import quantile
from pilotfish import data


def test_quantiles_are_values_that_were_measured():
    values = [float(n) for n in range(1, 1001)]
    assert [quantile(values, share) for share in (0.5, 0.99, 0.999, 1.0)] == [500.0, 990.0, 999.0, 1000.0]
    assert quantile([3.0, 1.0, 2.0], 0.5) == 2.0
    assert quantile([], 0.5) == math.inf


def test_the_shipped_configuration_names_the_same_files_from_anywhere():
    config, source = shipped_coordinator(), data.path("config/line.yaml")
    as_shipped = yaml.safe_load(source.read_text())
    for ours, theirs in (
        (config["leader"], as_shipped["leader"]),
        (config["fuzzy"], as_shipped["fuzzy"]),
        (config["camera"].pop("calibration"), as_shipped["camera"].pop("calibration")),
    ):
        assert Path(ours).is_absolute()
        assert Path(ours).samefile(source.parent / theirs)
    assert {**config, "leader": 0, "fuzzy": 0} == {**as_shipped, "leader": 0, "fuzzy": 0}


def test_a_process_ends_with_its_block_even_if_it_would_work_for_ever():
    with process(work) as busy:
        assert busy.is_alive()
        pid = busy.pid
    assert not busy.is_alive()
    assert not Path(f"/proc/{pid}").exists()

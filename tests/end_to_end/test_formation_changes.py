"""A formation that changes its shape while the real programs drive it, over LCM."""

import numpy as np
import pytest

from pilotfish.formation.file import read_formation
from pilotfish.formation.measures import errors
from pilotfish.formation.run import play


def test_a_chain_takes_up_a_new_spacing_that_is_sent_to_it_while_it_drives(tmp_path):
    """Lock-step waits for the answers to pictures, not for setpoints, so a change comes some pictures later; how much
    depends on the machine, so the run is long enough for 3 s of delay. After it the error is that of a step of 0.2 m,
    which is 5 mm after some 2.5 s."""
    change = {"at_s": 1.0, "spacing_m": 1.2}
    content = {"name": "mine", "shape": "chain", "robots": 3, "spacing_m": 1.0, "duration_s": 8.0, "changes": [change]}
    run = play(read_formation(content, tmp_path / "mine.yaml"), transport="lcm")
    for robot, recording in run.recordings.items():
        setpoint_m = run.distance_setpoint_m[robot]
        assert set(setpoint_m) == {1.0, 1.2}
        changed_s = recording.time_s[np.argmax(setpoint_m == 1.2)]
        assert 1.0 <= changed_s < 4.0
        assert recording.true_distance_m[-1] == pytest.approx(1.2, abs=0.005)
        assert abs(errors(run, robot)[0][-1]) < 0.005
        assert np.mean(recording.status == "tracking") > 0.95

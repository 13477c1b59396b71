"""While C++ works, other Python threads run: every long call lets go of the interpreter's lock.

No thread is interrupted here (sys.setswitchinterval), so that another one gets a turn only where a call lets it.
"""

import sys
import threading
import time

import pytest
from long_calls import CAMERA, of_control, of_coordinator, of_files, of_recording, of_sim, of_vision

from pilotfish import control, coordinator, core, data, fuzzy

CALLS = 5000  # one that is over before the other thread has woken up says nothing: again
NEVER_S = 1000.0


class Counting:
    """A thread that counts, and gives the lock back after each number."""

    def __init__(self):
        self.count, self.running = 0, True
        self.thread = threading.Thread(target=self._run, daemon=True)

    def _run(self):
        while self.running:
            self.count += 1
            time.sleep(0)

    def __enter__(self):
        self.before = sys.getswitchinterval()
        sys.setswitchinterval(NEVER_S)
        self.thread.start()
        return self

    def __exit__(self, *_):
        self.running = False
        sys.setswitchinterval(self.before)
        self.thread.join()


def lets_others_run(call):
    with Counting() as other:
        for _ in range(CALLS):
            before = other.count
            call()
            if other.count > before:
                return True
    return False


def held(calls):
    return [name for name, call in calls if not lets_others_run(call)]


def test_what_python_does_itself_lets_nobody_else_run():
    assert not lets_others_run(lambda: sum(range(1000)))


@pytest.mark.parametrize("calls", [of_sim, of_vision, of_control, of_coordinator])
def test_others_run_while_a_module_works(calls):
    assert held(calls()) == []


@pytest.mark.parametrize("calls", [of_files, of_recording])
def test_others_run_while_files_are_read_and_written(calls, tmp_path):
    assert held(calls(tmp_path)) == []


class Following:
    """A law in Python, which C++ calls where it does not hold the lock."""

    def follow(self, observation, setpoint, dt_s):
        return core.Twist(linear_mps=0.1 * (observation.distance_m - setpoint.distance_m))


def test_laws_in_python_are_made_called_and_forgotten_by_many_threads_at_once():
    made = control.LawDescription(name="mine", text="a law", make=lambda parameters, limits: Following())
    law = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
    follower = control.FollowerConfig(law=law, laws=[*control.built_in_laws(), made], active_law="mine")
    config = coordinator.CoordinatorConfig()
    config.camera, config.leader, config.control = CAMERA, core.LeaderBody([core.BodyTag()]), follower
    said = []

    def drive():
        for _ in range(5):
            driver = coordinator.Coordinator(config)
            for utime in range(33_333, 20 * 33_333, 33_333):
                result = driver.step_observation(utime, core.Observation(utime=utime, distance_m=1.2), utime)
            said.append(result.status)

    threads = [threading.Thread(target=drive) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert said == [core.Status.tracking] * 20


def test_a_law_that_cannot_be_made_says_so():
    def fails(parameters, limits):
        raise RuntimeError("no such law today")

    made = control.LawDescription(name="mine", text="a law", make=fails)
    law = fuzzy.load_controller(data.path("fuzzy/coordination.yaml"))
    config = control.FollowerConfig(law=law, laws=[made], active_law="mine")
    with pytest.raises(RuntimeError, match="no such law today"):
        control.Follower(config)

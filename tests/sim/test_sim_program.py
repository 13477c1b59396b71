"""The simulator's program on a real bus, with a coordinator played by the test."""

import csv
import signal
import subprocess
import threading
import time

import lcm
import pytest
import yaml

from pilotfish import bus, sim
from pilotfish import data as shipped
from pilotfish.core import Twist
from pilotfish.harness.child import Child
from pilotfish.harness.executables import SIM, find_executable
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.bot_core.image_t import image_t
from pilotfish.lcmtypes.bot_core.pose_t import pose_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t
from pilotfish.lcmtypes.pilotfish.setpoint_t import setpoint_t
from pilotfish.lcmtypes.pilotfish.status_t import status_t
from pilotfish.operating import new_key
from scripted_coordinator import ScriptedCoordinator as GatedCoordinator

LINE = shipped.path("scenarios/line.yaml")
WITHIN_S = 30.0


class ScriptedCoordinator:
    """Answers every picture of robot1 with a command that depends on nothing but the picture's utime.
    `ignore(utime, copy)` says which pictures it pretends not to have got, `ignored_setpoints` how many setpoints it
    does not obey. What it keeps and its session are in its status, all the time."""

    session = 2**62 + 1

    def __init__(self, url, ignore=lambda utime, copy: False, heartbeat=False, ignored_setpoints=0):
        self.bus = lcm.LCM(url)
        self.ignore = ignore
        self.heartbeat = heartbeat
        self.received = []  # channels and utimes, in order
        self.pose_utimes = []
        self.poses_before = {}  # how many poses had come when a picture came
        self.setpoints = []  # messages, whatever they say
        self.kept = setpoint_t()  # the last one obeyed
        self.ignored_setpoints = ignored_setpoints
        self._stop = threading.Event()
        self.bus.subscribe("ROBOT1_IMAGE", self._image)
        self.bus.subscribe("ROBOT1_SETPOINT", self._setpoint)
        self.bus.subscribe("LEADER_POSE", lambda _, data: self.pose_utimes.append(pose_t.decode(data).utime))
        self._thread = threading.Thread(target=self._run)

    @staticmethod
    def answer(utime):
        k = round((utime - sim.START_UTIME) * 30 / 1e6)
        return Twist(linear_mps=0.1 + 0.01 * (k % 7), angular_radps=-0.2 + 0.05 * (k % 5))

    def pictures(self):
        return [utime for what, utime in self.received if what == "image"]

    def send(self, utime, twist):
        message = command_t()
        message.utime, message.linear_mps, message.angular_radps = (
            utime,
            twist.linear_mps,
            twist.angular_radps,
        )
        message.status = command_t.STATUS_TRACKING
        message.session, message.mac = self.session, bytes(32)
        self.bus.publish("ROBOT1_COMMAND", message.encode())

    def _image(self, _, data):
        utime = image_t.decode(data).utime
        copy = self.pictures().count(utime)
        self.poses_before[utime] = len(self.pose_utimes)
        self.received.append(("image", utime))
        if not self.ignore(utime, copy):
            self.send(utime, self.answer(utime))

    def _setpoint(self, _, data):
        message = setpoint_t.decode(data)
        self.received.append(("setpoint", message.utime))
        self.setpoints.append(message)
        obeyed = message.session == self.session and message.counter > self.kept.counter
        if obeyed and len(self.setpoints) > self.ignored_setpoints:
            self.kept = message

    def _say_status(self):
        message = status_t()
        message.session, message.setpoint_counter = self.session, self.kept.counter
        message.setpoint_distance_m, message.setpoint_bearing_rad = self.kept.distance_m, self.kept.bearing_rad
        message.setpoint_run = self.kept.run
        self.bus.publish("ROBOT1_STATUS", message.encode())

    def _run(self):
        while not self._stop.is_set():
            self.bus.handle_timeout(20)
            self._say_status()
            if self.heartbeat:
                self.send(0, Twist())

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join()


def sim_command(url, *options, scenario=LINE):
    return [find_executable(SIM), "--scenario", scenario, "--lcm-url", url, *options]


def play(tmp_path, *options, scenario=LINE, **played):
    """(CompletedProcess, ScriptedCoordinator, bytes of the recording)."""
    url, record = private_lcm_url(), tmp_path / "record.csv"
    with ScriptedCoordinator(url, **played) as coordinator:
        command = sim_command(url, "--record", record, *options, scenario=scenario)
        done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=60, check=False)
    return done, coordinator, record.read_bytes() if record.exists() else b""


def rows(recording):
    return list(csv.DictReader(recording.decode().splitlines()))


def edited(tmp_path, change):
    content = yaml.safe_load(LINE.read_text())
    for robot in content["robots"]:
        for section, key in (("body", "leader"), ("camera", "calibration"), (None, "coordinator")):
            place = robot.get(section, {}) if section else robot
            if key in place:
                place[key] = str((LINE.parent / place[key]).resolve())
    change(content)
    file = tmp_path / "edited.yaml"
    file.write_text(yaml.safe_dump(content))
    return file


def test_a_run_in_lockstep_is_the_same_to_the_last_bit_even_if_pictures_get_lost(tmp_path):
    quiet, coordinator, recording = play(tmp_path, "--lockstep", "--duration-s", "1.0")
    assert quiet.returncode == 0, quiet.stderr
    assert coordinator.pictures() == [sim.START_UTIME + round(k * 1e6 / 30) for k in range(30)]
    # Every fifth picture is missed once, so it has to be sent again.
    lossy, coordinator, recording_lossy = play(
        tmp_path,
        "--lockstep",
        "--duration-s",
        "1.0",
        ignore=lambda utime, copy: copy == 0 and (utime // 33_333) % 5 == 0,
    )
    assert lossy.returncode == 0, lossy.stderr
    assert len(coordinator.pictures()) > 30
    assert recording_lossy == recording


def test_a_run_in_lockstep_is_the_world_with_these_commands(tmp_path):
    _, _, recording = play(tmp_path, "--duration-s", "1.0")
    world = sim.World(sim.load_scenario(LINE))
    for k, row in enumerate(rows(recording)):
        world.advance_to(k / 30)
        twist = ScriptedCoordinator.answer(world.utime)
        expected = sim.recording_row(world, "robot1", command=twist, status="tracking")
        assert ",".join(row.values()) == expected.strip()
        # One frame of latency: this answer acts when the next picture is taken.
        world.command("robot1", twist, world.time_s + world.scenario.robot("robot1").camera.latency_s)
    assert k == 29


def test_the_setpoint_of_the_scenario_comes_before_the_first_picture(tmp_path):
    _, coordinator, _ = play(tmp_path, "--duration-s", "0.2")
    assert coordinator.received[0][0] == "setpoint"
    kept = coordinator.kept
    assert (kept.distance_m, kept.bearing_rad, kept.run) == (1.1, pytest.approx(-0.174533, abs=1e-6), True)


@pytest.mark.parametrize("mode", ["--lockstep", "--realtime"])
def test_no_picture_goes_out_before_the_coordinator_shows_the_setpoint(tmp_path, mode):
    done, coordinator, _ = play(tmp_path, mode, "--duration-s", "0.2", heartbeat=True, ignored_setpoints=3)
    assert done.returncode == 0, done.stderr
    before_the_first_picture = [what for what, _ in coordinator.received].index("image")
    assert before_the_first_picture >= 4
    counters = [message.counter for message in coordinator.setpoints]
    assert counters == sorted(set(counters))  # each copy rises, so that none looks like a replay


def test_a_second_run_is_obeyed_by_the_same_coordinator(tmp_path):
    url = private_lcm_url()
    with ScriptedCoordinator(url) as coordinator:
        for _ in range(2):
            command = sim_command(url, "--duration-s", "0.2", "--wait-s", "5")
            done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=60, check=False)
            assert done.returncode == 0, done.stderr
    counters = [message.counter for message in coordinator.setpoints]
    assert len(counters) >= 2
    assert counters == sorted(set(counters))


def test_a_coordinator_that_does_not_take_the_setpoint_is_named(tmp_path):
    done, coordinator, _ = play(tmp_path, "--wait-s", "0.5", heartbeat=True, ignored_setpoints=10**9)
    assert done.returncode == 70
    assert "robot1 does not show the setpoint it was sent" in done.stderr
    assert coordinator.pictures() == []


def test_with_a_key_the_simulator_and_the_coordinator_accept_each_other(tmp_path):
    new_key(tmp_path / "key")
    key = bus.load_key(str(tmp_path / "key"))
    url = private_lcm_url()
    for options, code in ((["--key", tmp_path / "key"], 0), ([], 70)):
        with GatedCoordinator(url, key=key, answers_pictures=True) as robot:
            command = sim_command(url, "--duration-s", "0.2", "--wait-s", "2" if code else "20", *options)
            done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=60, check=False)
            assert done.returncode == code, done.stderr
            assert robot.setpoint.distance_m == (1.1 if code == 0 else 1.0)
    assert "setpoint_mac_wrong" in done.stderr


def test_poses_are_published_at_every_exposure(tmp_path):
    _, coordinator, _ = play(tmp_path, "--duration-s", "0.5")
    assert coordinator.pose_utimes == [sim.START_UTIME + round(k * 1e6 / 30) for k in range(15)]


def test_dropped_frames_are_not_waited_for(tmp_path):
    file = edited(tmp_path, lambda c: c["robots"][1]["camera"].update(drop_probability=0.3))
    done, coordinator, recording = play(tmp_path, "--duration-s", "2.0", scenario=file)
    assert done.returncode == 0, done.stderr
    delivered = [row["delivered"] == "1" for row in rows(recording)]
    assert len(delivered) == 60
    assert len(set(coordinator.pictures())) == sum(delivered) < 60
    # The last command still holds.
    for before, row in zip(rows(recording), rows(recording)[1:], strict=False):
        if row["delivered"] == "0":
            assert row["command_linear_mps"] == before["command_linear_mps"]


def test_commands_to_other_pictures_do_not_count_as_answers(tmp_path):
    done, _, recording = play(tmp_path, "--duration-s", "0.5", heartbeat=True)
    assert done.returncode == 0, done.stderr
    assert all(float(row["command_linear_mps"]) >= 0.1 for row in rows(recording))


def test_in_real_time_the_scenario_takes_as_long_as_it_says(tmp_path):
    started = time.monotonic()
    done, coordinator, recording = play(tmp_path, "--realtime", "--duration-s", "1.5", heartbeat=True)
    assert time.monotonic() - started >= 1.5 - 1 / 30
    assert done.returncode == 0, done.stderr
    pictures = coordinator.pictures()
    assert pictures == sorted(set(pictures))
    assert len(rows(recording)) >= len(pictures) > 0
    exposures = {sim.START_UTIME + round(k * 1e6 / 30) for k in range(45)}
    assert set(pictures) <= exposures


def test_in_real_time_a_picture_does_not_wait_for_the_next_one_to_be_rendered(tmp_path):
    # The latency is one period: the picture of exposure k is due when exposure k + 1 begins, whose poses go out before
    # its picture is rendered. It had waited for both: 5 to 12 ms that no configuration names.
    done, coordinator, _recording = play(tmp_path, "--realtime", "--duration-s", "1.5", heartbeat=True)
    assert done.returncode == 0, done.stderr
    exposed = {utime: k + 1 for k, utime in enumerate(coordinator.pose_utimes)}
    in_time = [coordinator.poses_before[utime] <= exposed[utime] for utime in coordinator.pictures()]
    assert sum(in_time) >= 0.8 * len(in_time) > 0


def test_without_a_coordinator_it_gives_up_and_says_who_is_missing(tmp_path):
    url = private_lcm_url()
    for mode in ("--lockstep", "--realtime"):
        done = subprocess.run(
            [str(c) for c in sim_command(url, mode, "--wait-s", "0.3")],
            capture_output=True, text=True, timeout=30, check=False,
        )  # fmt: skip
        assert done.returncode == 70
        assert "robot1" in done.stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.parametrize("mode", ["--lockstep", "--realtime"])
def test_a_signal_ends_it_in_order(tmp_path, mode, number):
    url, record = private_lcm_url(), tmp_path / "record.csv"
    with ScriptedCoordinator(url, heartbeat=True) as coordinator:
        with Child(sim_command(url, mode, "--record", record), tmp_path, "sim") as child:
            child.wait_until(lambda: len(coordinator.pictures()) > 3, WITHIN_S, "some pictures")
            child.process.send_signal(number)
            assert child.process.wait(WITHIN_S) == 0
        assert "stopped after" in child.stderr()
    assert rows(record.read_bytes())


def test_a_bad_scenario_ends_with_78_and_the_key(tmp_path):
    file = edited(tmp_path, lambda c: c["robots"][1]["drive"].update(top_speed=1.0))
    command = sim_command("memq://", scenario=file)
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=30, check=False)
    assert done.returncode == 78
    assert "robots[1].drive.top_speed" in done.stderr


@pytest.mark.parametrize(
    ("options", "code"),
    [
        (["--scenario", LINE, "--lcm-url", "nonsense://"], 69),
        (["--scenario", LINE, "--lcm-url", "memq://", "--record", "/nowhere/record.csv"], 69),
        (["--scenario", "/nowhere/scenario.yaml"], 78),
        (["--scenario", LINE, "--duration-s", "0.001"], 78),
        (["--scenario", LINE, "--realtime", "--lockstep"], 64),
        ([], 64),
        (["--help"], 0),
    ],
)
def test_each_kind_of_end_has_its_exit_code(options, code):
    command = [str(word) for word in [find_executable(SIM), *options]]
    assert subprocess.run(command, capture_output=True, timeout=30, check=False).returncode == code

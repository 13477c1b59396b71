"""Stop, resume and setpoints as an operator gives them, to a coordinator that obeys as the real one does."""

import math
import stat

import pytest
from typer.testing import CliRunner

from pilotfish import bus, core
from pilotfish.cli import app
from pilotfish.errors import ConfigError, OperatorError, SilentRobotError
from pilotfish.harness.ports import private_lcm_url
from pilotfish.operating import Operator, new_key
from scripted_coordinator import ScriptedCoordinator

SHORT_S = 0.4  # for what is going to fail; what works takes a beat or two of 10 ms, and has three seconds


@pytest.fixture
def url():
    return private_lcm_url()


@pytest.fixture
def key_file(tmp_path):
    new_key(tmp_path / "key")
    return tmp_path / "key"


def run(*arguments):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    return result.exit_code, " ".join(result.output.split())


def test_stop_resume_and_a_setpoint_are_obeyed_and_shown(url):
    with ScriptedCoordinator(url) as robot:
        operator = Operator("robot1", lcm_url=url)
        assert not operator.stop().setpoint.run
        assert operator.sent >= 3
        status = operator.set_setpoint(distance_m=1.5, bearing_rad=-0.2)
        assert not status.setpoint.run  # a new setpoint ends no stop
        status = operator.resume()
        assert (status.setpoint.distance_m, status.setpoint.bearing_rad, status.setpoint.run) == (1.5, -0.2, True)
        assert operator.set_setpoint(distance_m=2.0, bearing_rad=0.0).setpoint.run
    assert robot.setpoint.distance_m == 2.0
    assert (
        core.SetpointVerdict.wrong_session not in robot.verdicts[3:]
    )  # only the first stops can come before it is received


@pytest.mark.parametrize("content", [None, "no key at all"])
def test_a_key_that_is_no_key_does_not_keep_a_stop_from_being_sent(url, tmp_path, content):
    if content:
        (tmp_path / "key").write_text(content)
    with ScriptedCoordinator(url) as robot:
        code, said = run("stop", "robot1", "--lcm-url", url, "--key", tmp_path / "key")
        assert not robot.setpoint.run
    assert code == 0, said
    assert "a stop needs no key" in said


def test_go_is_resume(url):
    with ScriptedCoordinator(url) as robot:
        Operator("robot1", lcm_url=url).stop()
        code, said = run("go", "robot1", "--lcm-url", url)
    assert code == 0, said
    assert robot.setpoint.run
    code, said = run("go", "robot1", "--lcm-url", url, "--within-s", SHORT_S)
    assert code == 69
    assert "no coordinator of robot1 answers" in said


def test_a_second_operator_speaks_after_the_first(url):
    with ScriptedCoordinator(url):
        for distance_m in (1.2, 1.3, 1.4):
            status = Operator("robot1", lcm_url=url).set_setpoint(distance_m=distance_m, bearing_rad=0.0)
            assert status.setpoint.distance_m == distance_m


def test_nobody_on_the_bus_is_said_with_the_bus_and_what_to_look_at(url):
    operator = Operator("robot1", lcm_url=url)
    for ask in (operator.resume, lambda w: operator.set_setpoint(distance_m=1.0, bearing_rad=0.0, within_s=w)):
        with pytest.raises(SilentRobotError, match=f"no coordinator of robot1 answers on {url[:25]}"):
            ask(SHORT_S)
    with pytest.raises(SilentRobotError, match=r"\d+ stops were sent, and none was confirmed"):
        operator.stop(SHORT_S)
    assert operator.sent >= 3


def test_a_stop_reaches_a_coordinator_that_says_nothing(url):
    receiver = bus.Bus(url)
    received = []
    receiver.on_setpoint("robot1", received.append)
    with pytest.raises(SilentRobotError):
        Operator("robot1", lcm_url=url).stop(SHORT_S)
    while receiver.handle(50):
        pass
    assert len(received) >= 3
    assert not any(report.setpoint.run for report in received)


def test_wheels_that_stay_stopped_are_no_resumed_robot(url):
    with ScriptedCoordinator(url) as robot:
        operator = Operator("robot1", lcm_url=url)
        robot.base_stopped = True
        operator.stop()
        with pytest.raises(OperatorError, match=r"runs, but its wheels stay stopped: ask once more; .* stopped"):
            operator.resume()
        robot.base_stopped = False
        assert operator.resume().setpoint.run


def test_wheels_that_have_not_stopped_are_no_stopped_robot(url):
    with ScriptedCoordinator(url) as robot:
        operator = Operator("robot1", lcm_url=url)
        robot.base_stopped = False
        operator.listen()
        with pytest.raises(OperatorError, match=r"stops were sent in .* its wheels say: waiting"):
            operator.stop(SHORT_S)
        robot.base_stopped = True
        assert not operator.stop().setpoint.run


def test_a_coordinator_that_does_not_do_it_is_quoted(url):
    with ScriptedCoordinator(url, ignores_setpoints=True):
        operator = Operator("robot1", lcm_url=url)
        with pytest.raises(OperatorError, match=r"stops were sent in .* robot1 says: searching: .* keeps 1.00 m"):
            operator.stop(SHORT_S)
        with pytest.raises(OperatorError, match="not confirmed within"):
            operator.set_setpoint(distance_m=1.5, bearing_rad=0.0, within_s=SHORT_S)


def test_a_refusal_says_why(url):
    with ScriptedCoordinator(url) as robot:
        operator = Operator("robot1", lcm_url=url)
        with pytest.raises(OperatorError, match="refused, because the distance is below its stop distance"):
            operator.set_setpoint(distance_m=0.3, bearing_rad=0.0, within_s=SHORT_S)
        # What was refused before is not the reason now.
        assert operator.set_setpoint(distance_m=0.5, bearing_rad=0.0).setpoint.distance_m == 0.5
        for distance_m, bearing_rad in ((math.nan, 0.0), (1.0, math.inf), (30.0, 0.0), (1.0, 4.0)):
            with pytest.raises(OperatorError):
                operator.set_setpoint(distance_m=distance_m, bearing_rad=bearing_rad, within_s=SHORT_S)
        operator.stop()
        with pytest.raises(OperatorError, match="takes over only what it could keep"):
            operator.set_setpoint(distance_m=0.3, bearing_rad=0.0, within_s=SHORT_S)
    assert robot.setpoint.distance_m == 0.5


def test_with_a_key_anyone_stops_and_only_who_has_it_resumes(url, key_file, tmp_path):
    new_key(tmp_path / "other")
    with ScriptedCoordinator(url, key=bus.load_key(str(key_file))):
        for keys in ({}, {"key_file": tmp_path / "other"}):
            without_key = Operator("robot1", lcm_url=url, **keys)
            assert not without_key.stop().setpoint.run
            with pytest.raises(OperatorError, match="its key is not yours"):
                without_key.resume(SHORT_S)
        assert Operator("robot1", lcm_url=url, key_file=key_file).resume().setpoint.run


def test_another_operators_stop_is_not_ended_by_a_setpoint_that_is_still_being_sent(url):
    """The stop comes while the coordinator refuses (it is too near), so that the operator sends again and again."""

    def stop_after_a_refusal(robot):
        if robot.rejected:
            robot.setpoint = core.Setpoint(distance_m=1.0, run=False)

    with ScriptedCoordinator(url, before_beat=stop_after_a_refusal) as robot:
        with pytest.raises(OperatorError, match="received another setpoint in between"):
            Operator("robot1", lcm_url=url).set_setpoint(distance_m=0.3, bearing_rad=0.0)
        assert not robot.setpoint.run


def test_a_new_key_is_for_its_owner_alone_and_never_written_over_an_old_one(tmp_path):
    code, said = run("key", "new", tmp_path / "key")
    assert (code, said) == (0, f"wrote {tmp_path / 'key'}")
    assert stat.S_IMODE((tmp_path / "key").stat().st_mode) == 0o600
    bus.load_key(str(tmp_path / "key"))
    before = (tmp_path / "key").read_text()
    code, said = run("key", "new", tmp_path / "key")
    assert code == 78
    assert "is there already" in said
    assert (tmp_path / "key").read_text() == before
    assert run("key", "new", tmp_path / "nowhere" / "key")[0] == 74


def test_the_commands_say_what_the_robot_says(url, key_file):
    options = ("--lcm-url", url, "--key", key_file)
    with ScriptedCoordinator(url, key=bus.load_key(str(key_file))):
        code, said = run("setpoint", "robot1", "--distance-m", "1.1", "--bearing-deg", "-10", *options)
        assert (code, said.partition(" (after")[0]) == (
            0,
            "robot1: searching: no frame arrived in time, keeps 1.10 m at -10.0 deg",
        )
        code, said = run("stop", "robot1", "--lcm-url", url)
        assert (code, said.partition(" (after")[0]) == (
            0,
            "robot1: stopped: stop requested, would keep 1.10 m at -10.0 deg",
        )
        code, said = run("resume", "robot1", *options)
        assert code == 0
        assert ", keeps 1.10 m at -10.0 deg" in said
        code, said = run("setpoint", "robot1", "--distance-m", "0.1", "--within-s", SHORT_S, *options)
        assert code == 70
        assert "below its stop distance" in said


@pytest.mark.parametrize("bearing_deg", ["200", "-70.5", "nan"])
def test_a_bearing_out_of_range_is_refused_in_degrees_before_anyone_is_asked(bearing_deg):
    code, said = run("setpoint", "robot1", "--bearing-deg", bearing_deg, "--lcm-url", "nonsense://")
    assert code == 64
    assert f"--bearing-deg: {bearing_deg} is outside [-70, 70]" in said


def test_each_mistake_has_its_exit_code(url, key_file):
    assert run("resume", "robot1", "--lcm-url", url, "--within-s", "0.2")[0] == 69
    assert run("stop", "robot1", "--lcm-url", "nonsense://")[0] == 69
    assert run("stop", "robot 1", "--lcm-url", url)[0] == 64
    key_file.chmod(0o644)
    code, said = run("resume", "robot1", "--lcm-url", url, "--key", key_file)
    assert code == 78
    assert "chmod 600" in said
    with pytest.raises(ConfigError, match="key_file"):
        Operator("robot1", lcm_url=url, key_file=key_file.parent / "nowhere")


@pytest.mark.parametrize("words", [["stop"], ["go"], ["resume"], ["setpoint", "--distance-m", "1"]])
@pytest.mark.parametrize("name", ["a b", "", "../x", "größe"])
def test_what_is_no_robots_name_is_a_wrong_command_line(url, words, name):
    code, said = run(*words, "--lcm-url", url, "--", name)
    assert code == 64
    assert "1 to 32 letters" in said

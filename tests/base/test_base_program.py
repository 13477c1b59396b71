"""pilotfish-base as a robot has it: commands over LCM, a motor controller on a (pseudo) serial line."""

import itertools
import os
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

import pytest
from commander import Commander
from motor_controller import MotorController
from wheels_process import CONFIG, WheelsProcess

from pilotfish import core
from pilotfish.lcmtypes.pilotfish.base_t import base_t
from pilotfish.lcmtypes.pilotfish.command_t import command_t


def moving(controller):
    return lambda: bool(controller.set_points) and controller.set_points[-1].moves


def standing(controller, zeros=5):
    return lambda: len(controller.set_points) >= zeros and not any(s.moves for s in controller.set_points[-zeros:])


def play(commander, recorded, kind):
    """Recorded commands onto the bus, until as many have been refused as `kind`: a datagram may be lost."""
    for data in itertools.islice(itertools.cycle(recorded), 50 * len(recorded)):
        if commander.rejected(kind) >= len(recorded):
            return
        commander.bus.publish("ROBOT1_COMMAND", data)
        commander.listen(0.005)
    raise AssertionError(f"{commander.rejected(kind)} of {len(recorded)} refused as {kind}")


def driven(commander, controller):
    commander.drive_until(moving(controller), "wheels that turn")
    commander.drive_until(lambda: abs(commander.last.linear_mps - 0.3) < 1e-9, "the commanded speed")


def test_it_drives_what_it_is_commanded_within_the_limits_of_acceleration(commander, controller):
    driven(commander, controller)
    assert commander.last.accepted_session == commander.session
    assert commander.last.state == base_t.STATE_DRIVING
    # 0.3 m/s on wheels of 0.05 m: 6 rad/s.
    commander.drive_until(lambda: controller.set_points[-1].left_mradps == 6000, "6 rad/s")
    speeds = [s.left_mradps for s in controller.set_points]
    assert any(0 < speed < 6000 for speed in speeds), "it speeds up and does not jump"
    assert controller.bad_lines == 0


def test_a_command_beyond_the_limits_is_clamped(commander, controller):
    commander.drive_until(lambda: commander.last.linear_mps >= 0.7 - 1e-9, "full speed", linear_mps=5.0)
    commander.drive_until(lambda: commander.counter > 80, "some more", linear_mps=5.0)
    assert max(s.left_mradps for s in controller.set_points) == 14000  # 0.7 m/s over 0.05 m


def test_a_search_for_the_leader_turns_the_wheels_in_place_and_nothing_else_moves_while_it_is_lost(
    commander, controller
):
    commander.status, commander.reason = command_t.STATUS_LOST, int(core.Reason.turning_to_search)
    turning = lambda: bool(commander.received) and abs(commander.last.angular_radps - 0.5) < 1e-9  # noqa: E731
    commander.act_until(turning, "the commanded turn", lambda: commander.command(0.3, 0.5))
    assert all(s.left_mradps <= 0 <= s.right_mradps for s in controller.set_points)
    commander.reason = int(core.Reason.no_tag_found)
    commander.act_until(standing(controller), "wheels that stand", lambda: commander.command(0.3, 0.5))


def test_odometry_comes_from_the_encoders(commander, controller):
    driven(commander, controller)
    commander.drive_until(lambda: commander.poses and commander.poses[-1].pos[0] > 0.2, "0.2 m of way")
    assert abs(commander.poses[-1].pos[1]) < 0.02
    # 1000 ticks a turn where the configuration says 2048: the wheels seem to turn 1000/2048 as fast.
    measured = [m.measured_linear_mps for m in commander.received if m.measured]
    assert statistics.median(measured) == pytest.approx(0.3 * 1000 / 2048, rel=0.4)


def test_without_commands_zeros_keep_going_to_the_wheels(commander, controller):
    driven(commander, controller)
    before = len(controller.set_points)
    commander.listen_until(lambda: len(controller.set_points) >= before + 30, "more lines")
    first_zero = next(k for k, s in enumerate(controller.set_points[before:]) if not s.moves)
    assert not any(s.moves for s in controller.set_points[before + first_zero :]), "zero is final"
    assert commander.last.state == base_t.STATE_WAITING


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGSTOP])
@pytest.mark.fault("coordinator_killed")
def test_when_the_sender_dies_or_is_stopped_the_wheels_are_told_zero(url, robot, controller, how):
    program = [sys.executable, str(Path(__file__).with_name("commander.py")), url, "robot1", "0.3"]
    with subprocess.Popen(program) as sender:
        listener = Commander(url)
        listener.listen_until(moving(controller), "wheels that turn")
        sender.send_signal(how)
        listener.listen_until(standing(controller), "zeros")
        before = len(controller.set_points)
        listener.listen_until(lambda: len(controller.set_points) > before + 20, "more zeros")
        assert not any(s.moves for s in controller.set_points[before:])
        sender.kill()


@pytest.mark.fault("wheels_forged")
def test_recorded_commands_move_nothing(commander, controller, url):
    driven(commander, controller)
    recorded = list(commander.sent)
    commander.listen_until(standing(controller), "zeros")
    before = len(controller.set_points)
    play(commander, recorded, "command_replayed")
    commander.listen_until(lambda: commander.last.accepted_session == 0, "the sender has ended")
    assert not any(s.moves for s in controller.set_points[before:])


@pytest.mark.fault("base_killed", "wheels_forged")
def test_a_recording_of_an_earlier_run_of_the_base_moves_nothing(tmp_path, url, controller, commander, robot):
    driven(commander, controller)
    recorded = list(commander.sent)
    assert robot.terminate() == 0
    with WheelsProcess(tmp_path, url, f"serial:{controller.device}", name="next"):
        old = commander.last.session
        commander.listen_until(lambda: commander.last.session != old, "the next run")
        before = len(controller.set_points)
        play(commander, recorded, "base_session_wrong")
        assert not any(s.moves for s in controller.set_points[before:])


def test_a_second_sender_never_drives(commander, controller, url):
    driven(commander, controller)
    other = Commander(url)
    other.listen_until(lambda: bool(other.received), "the base")
    before = len(controller.set_points)
    while commander.rejected("command_foreign") < 50:
        assert other.counter < 1000
        other.command(-0.5)
        commander.command(0.3)
        commander.listen(0.02)
    assert all(s.left_mradps >= 0 for s in controller.set_points[before:])
    assert commander.last.accepted_session == commander.session


@pytest.mark.fault("wheels_forged")
def test_a_simulated_command_never_moves_real_wheels(commander, controller):
    commander.simulated = True
    commander.drive_until(lambda: commander.rejected("command_simulated") >= 20, "20 refusals")
    assert not any(s.moves for s in controller.set_points)


def test_a_stop_from_anyone_lasts_until_the_obeyed_session_is_resumed(commander, controller, url):
    driven(commander, controller)
    anyone = Commander(url)
    anyone.setpoint(run=False)
    stopped = base_t.STATE_STOPPED
    commander.drive_until(lambda: commander.last.state == stopped and commander.last.stopped, "the stop")
    commander.drive_until(standing(controller), "zeros in spite of commands")
    before = len(controller.set_points)
    for session, counter in ((0, 1), (anyone.session, 1), (commander.last.session, 9)):
        anyone.setpoint(run=True, session=session, counter=counter)
        sent = len(commander.sent)
        commander.drive_until(lambda sent=sent: len(commander.sent) > sent + 5, "some commands")
    assert not any(s.moves for s in controller.set_points[before:])
    resume = anyone.setpoint(run=True, session=commander.session, counter=1)
    commander.drive_until(moving(controller), "resumed")
    anyone.setpoint(run=False)
    commander.drive_until(standing(controller), "stopped again")
    anyone.bus.publish("ROBOT1_SETPOINT", resume)
    commander.drive_until(lambda: commander.rejected("resume_replayed") == 1, "the replay refused")
    assert standing(controller)()


@pytest.mark.fault("wheels_forged")
def test_forged_and_replayed_commands_and_resumes_are_refused_where_a_key_is_configured(tmp_path, url, controller):
    key = bytes(range(32))
    file = tmp_path / "key"
    file.write_text(key.hex() + "\n")
    file.chmod(0o600)
    config = tmp_path / "base.yaml"
    config.write_text(CONFIG.read_text() + f"\nkey_file: {file}\n")
    with WheelsProcess(tmp_path, url, f"serial:{controller.device}", config=config):
        forger, authorised = Commander(url, key=bytes(32)), Commander(url, key=key)
        bare = Commander(url)
        forger.listen_until(lambda: bool(forger.received), "the base")
        while forger.rejected("command_mac_wrong") < 200:
            assert forger.counter < 5000
            forger.command(0.3)
            bare.command(0.3)
            forger.listen(0.005)
        assert not any(s.moves for s in controller.set_points)

        driven(authorised, controller)
        bare.setpoint(run=False)  # a stop needs no key
        authorised.drive_until(standing(controller), "the stop")
        before = len(controller.set_points)
        counter = 0
        while authorised.rejected("setpoint_mac_wrong") < 50:
            counter += 1
            assert counter < 500
            forger.setpoint(run=True, session=authorised.session, counter=counter)
            bare.setpoint(run=True, session=authorised.session, counter=counter)
            authorised.command(0.3)
            authorised.listen(0.02)
        assert not any(s.moves for s in controller.set_points[before:])
        authorised.setpoint(run=True, session=authorised.session, counter=1)
        authorised.drive_until(moving(controller), "the authorised resume")


@pytest.mark.fault("wheels_unplugged")
def test_a_line_that_is_not_read_blocks_nothing_and_gives_no_old_speeds_afterwards(commander, controller, robot):
    driven(commander, controller)
    controller.reads = False
    received = len(commander.received)
    fault = base_t.STATE_FAULT
    commander.drive_until(lambda: commander.last.state == fault, "the fault")
    commander.drive_until(lambda: len(commander.received) > received + 100, "a base that goes on sending")
    commander.listen_until(
        lambda: commander.last.accepted_session == 0, "the end of the sender: no command is good any more"
    )
    before = len(controller.set_points)
    controller.reads = True
    # What waits in the line may begin with lines of before the fault; behind its first zero there is nothing else.
    commander.listen_until(lambda: len(controller.set_points) > before + 40, "lines again")
    moving_ones = [line.moves for line in controller.set_points[before:]]
    assert not any(moving_ones[moving_ones.index(False) :])
    commander.session += 1
    commander.drive_until(lambda: commander.last.state == base_t.STATE_DRIVING, "driving again")


def test_a_controller_that_does_not_answer_is_a_fault_with_zeros(commander, controller):
    driven(commander, controller)
    controller.answers = False
    commander.drive_until(lambda: commander.last.state == base_t.STATE_FAULT, "the fault")
    commander.drive_until(standing(controller), "zeros")
    assert "does not answer" in commander.last.text
    controller.answers = True
    commander.drive_until(moving(controller), "driving again")


def test_garbage_from_the_controller_is_counted_and_harmless(commander, controller):
    controller.chatter = b"\x00\xff$$PFE,*41\r\n$PFE,1,2,3*00\n" + b"$" + b"7" * 200 + b"\n"
    driven(commander, controller)
    commander.drive_until(lambda: commander.rejected("line_too_long") > 10, "some of it counted")
    assert commander.last.state == base_t.STATE_DRIVING


def test_a_pressed_emergency_stop_latches(commander, controller):
    driven(commander, controller)
    controller.faults = 32
    commander.drive_until(lambda: commander.last.state == base_t.STATE_FAULT, "the fault")
    assert "emergency stop" in commander.last.text
    controller.faults = 0
    commander.drive_until(lambda: commander.last.state == base_t.STATE_STOPPED, "released, and still stopped")
    commander.drive_until(standing(controller), "zeros")


@pytest.mark.fault("wheels_unplugged")
def test_an_unplugged_line_is_a_fault_and_is_opened_again(tmp_path, url):
    first, link = MotorController(), tmp_path / "tty"
    link.symlink_to(first.device)
    with first, WheelsProcess(tmp_path, url, f"serial:{link}"):
        commander = Commander(url)
        driven(commander, first)
        first.unplug()
        commander.drive_until(lambda: commander.last.state == base_t.STATE_FAULT, "the fault")
        assert commander.last.linear_mps == 0.0
        with MotorController() as second:
            link.unlink()
            link.symlink_to(second.device)
            commander.drive_until(moving(second), "driving again")


@pytest.mark.parametrize(
    "how", ["SIGTERM", "SIGINT", "SIGHUP", "SIGQUIT", "SIGUSR1", "SIGUSR2", "SIGRTMIN", "SIGRTMAX"]
)
def test_a_signal_ends_it_with_0_and_zeros(robot, commander, controller, how):
    driven(commander, controller)
    robot.process.send_signal(getattr(signal, how))
    commander.drive_until(lambda: robot.process.poll() is not None, "the end")
    assert robot.process.returncode == 0
    commander.listen_until(standing(controller, zeros=3), "zeros as the last lines")


@pytest.mark.parametrize("how", ["SIGSEGV", "SIGABRT", "SIGBUS", "SIGFPE", "SIGILL"])
def test_a_crash_leaves_a_zero_as_the_last_word(robot, commander, controller, how):
    driven(commander, controller)
    robot.process.send_signal(getattr(signal, how))
    commander.drive_until(lambda: robot.process.poll() is not None, "the end")
    assert robot.process.returncode == -getattr(signal, how)
    commander.listen_until(standing(controller, zeros=1), "a zero")


def test_after_sigstop_nothing_that_queued_up_moves_anything(robot, commander, controller):
    """Two seconds of commands wait in the socket; then the sender is gone, and the base goes on."""
    driven(commander, controller)
    robot.process.send_signal(signal.SIGSTOP)
    for _ in range(100):
        commander.command(0.3)
        time.sleep(0.02)
    before = len(controller.set_points)
    robot.process.send_signal(signal.SIGCONT)
    commander.listen_until(lambda: len(controller.set_points) > before + 20, "lines again")
    assert not any(s.moves for s in controller.set_points[before + 1 :]), "one may have been on its way"


def test_a_second_base_of_the_name_ends_with_69(tmp_path, url, robot, commander, controller):
    driven(commander, controller)
    with WheelsProcess(tmp_path, url, "dry_run", name="second") as second:
        commander.drive_until(lambda: second.process.poll() is not None, "the end of the second")
        assert second.process.returncode == 69
        assert "another pilotfish-base" in second.stderr()
    assert commander.last.state == base_t.STATE_DRIVING
    with WheelsProcess(tmp_path, url, f"serial:{controller.device}", "--name", "robot2", name="third") as third:
        commander.drive_until(lambda: third.process.poll() is not None, "the end of the third")
        assert third.process.returncode == 69
        assert "in use by another program" in third.stderr()
    assert moving(controller)()


def test_a_blocked_terminal_stops_nothing(tmp_path, url, controller):
    """stderr is a full pipe without a reader."""
    read_end, write_end = os.pipe()
    os.set_blocking(write_end, False)
    try:
        while True:
            os.write(write_end, b"x" * 65536)
    except BlockingIOError:
        os.set_blocking(write_end, True)
    robot = WheelsProcess(tmp_path, url, f"serial:{controller.device}")
    robot.terminate()
    with subprocess.Popen(robot.command, stderr=write_end, stdout=write_end) as process:
        commander = Commander(url)
        driven(commander, controller)
        commander.listen_until(standing(controller), "zeros")
        driven(commander, controller)
        process.terminate()
        commander.drive_until(lambda: process.poll() is not None, "the end, without a reader")
        assert process.returncode == 0
        assert standing(controller, zeros=1)()
    os.close(read_end)
    os.close(write_end)

"""The wheel driver that ``pilotfish init`` puts into a folder: when the wheels turn, and that they stop by 100 ms."""

import importlib.util
import signal
import subprocess
import sys

import pytest

from pilotfish import bus, core, data
from pilotfish.harness.child import Child
from pilotfish.harness.ports import private_lcm_url

FILE = data.path("robot/wheel_driver.py")
VALID_US = 10**15
DRIVES, STANDS = core.Twist(linear_mps=0.3, angular_radps=0.1), core.Twist()


@pytest.fixture
def driver():
    spec = importlib.util.spec_from_file_location("wheel_driver", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def wheels(driver):
    turned = []
    wheels = driver.Wheels(turned.append)
    wheels.turned = turned
    return wheels


def command(counter, *, session=7, twist=DRIVES, valid_until_us=VALID_US, simulated=False):
    report = bus.CommandReport(utime=0, session=session, counter=counter, valid_until_us=valid_until_us)
    report.command, report.simulated = twist, simulated
    return report


def test_a_command_turns_the_wheels(wheels):
    wheels.command(command(1), 0, 0)
    assert wheels.turned == [DRIVES]


def test_the_wheels_stand_before_100_ms_whenever_the_loop_looks(driver, wheels):
    """The loop looks every LOOP_MS, and once as late again: the deadline leaves room for two periods."""
    wheels.command(command(1), 0, 0)
    wheels.tick(driver.DEADLINE_US - 1)
    assert wheels.turned == [DRIVES]
    wheels.tick(driver.DEADLINE_US)
    assert wheels.turned == [DRIVES, STANDS]
    assert driver.DEADLINE_US + 2 * 1000 * driver.LOOP_MS < 100_000
    wheels.tick(10 * driver.DEADLINE_US)
    assert len(wheels.turned) == 2  # told once


def test_a_measurement_that_becomes_too_old_stops_them_earlier(wheels):
    wheels.command(command(1, valid_until_us=30_000), 0, 0)
    wheels.tick(29_999)
    wheels.tick(30_000)
    assert wheels.turned == [DRIVES, STANDS]


def test_a_command_that_waited_in_the_queue_counts_from_its_arrival(wheels):
    wheels.command(command(1), 0, 90_000)
    assert wheels.turned == [STANDS]


@pytest.mark.parametrize(
    "report", [command(1, simulated=True), command(1, session=0)], ids=["of a simulator", "without a session"]
)
def test_commands_that_are_not_for_real_wheels_turn_nothing(wheels, report):
    wheels.command(report, 0, 0)
    assert wheels.turned == []


def test_counters_must_rise_and_a_second_coordinator_turns_nothing(wheels):
    wheels.command(command(5), 0, 0)
    for other in (command(5), command(4), command(6, session=8)):
        wheels.command(other, 1000, 1000)
    assert wheels.turned == [DRIVES]


def test_after_half_a_second_of_silence_a_restarted_coordinator_drives_and_the_old_session_never_again(wheels):
    wheels.command(command(5), 0, 0)
    wheels.command(command(1, session=8), 600_000, 600_000)
    assert wheels.turned == [DRIVES, DRIVES]
    wheels.command(command(6), 1_300_000, 1_300_000)
    assert len(wheels.turned) == 2


def test_the_program_obeys_real_messages_stops_by_itself_and_when_it_ends(tmp_path):
    url = private_lcm_url()
    with Child([sys.executable, FILE, "robot7", url], tmp_path, "wheels") as child:
        child.wait_until(lambda: "wheels of robot7" in child.stderr(), 20, "being ready")
        sender, counter = bus.Bus(url), 0

        def driving():
            nonlocal counter
            counter += 1
            sender.publish_command("robot7", command(counter, valid_until_us=core.monotonic_now_us() + 80_000))
            return child.stdout().strip().endswith("v = +0.300 m/s, w = +0.100 rad/s")

        child.wait_until(driving, 20, "driving")
        standing = "v = +0.000 m/s, w = +0.000 rad/s"
        child.wait_until(lambda: child.stdout().strip().endswith(standing), 20, "standing, without a command")
        child.wait_until(driving, 20, "driving again")
        child.process.send_signal(signal.SIGTERM)
        assert child.process.wait(20) == 0
        assert child.stdout().strip().endswith(standing)


def test_without_arguments_it_says_the_robot_it_is_for(tmp_path):
    """From the folder of `pilotfish init robot7`."""
    from pilotfish.robot_folder import configs

    file = tmp_path / "wheel_driver.py"
    file.write_text(configs.wheel_driver("robot7"))
    with subprocess.Popen([sys.executable, file], stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stderr.readline().startswith("wheels of robot7 on udpm://")
        finally:
            process.terminate()

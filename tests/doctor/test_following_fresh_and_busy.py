"""A robot that was never started, and one on a computer with too much to do: on messages made here, without a bus."""

import pytest
from test_following_causes import RATE_HZ, SEARCHING, SECONDS, command, status, watched

from pilotfish import core, robot_folder
from pilotfish.doctor.following import judge
from pilotfish.doctor.following.load import Machine, cpu_times, machine_load
from pilotfish.doctor.following.setup import load_setup
from pilotfish.doctor.following.watch import Images
from pilotfish.lcmtypes.pilotfish import stage_t
from pilotfish.watching import ImageHead

STOPPED = int(core.Status.stopped)
QUIET = Machine(cores=2, load_average=0.4, busy_share=0.1, receive_buffer_bytes=4_194_304)
BUSY = Machine(cores=2, load_average=14.39, busy_share=0.99, receive_buffer_bytes=4_194_304)


def stopped(utime=0, counter=0):
    message = status(STOPPED, "stop_requested")
    message.setpoint_run, message.setpoint_counter, message.utime, message.frame_rate_hz = False, counter, utime, 0.0
    return message


def with_images(seen, rate_hz=30.0, channel="ROBOT1_IMAGE"):
    seen.images[channel] = Images()
    for k in range(int(SECONDS * rate_hz)):
        seen.images[channel].heads.append((k / rate_hz, 0, 640, 480))
    return seen


def staged(message, **stages):
    """Counts of a stage in the eleven classes of stage_t."""
    for name, counts in stages.items():
        stage = stage_t()
        stage.name, stage.counts, stage.max_ms = name, [*counts, *[0] * (11 - len(counts))], 99.0
        message.stages.append(stage)
    message.stage_count = len(message.stages)
    return message


@pytest.fixture
def fresh(tmp_path):
    """The configuration that ``pilotfish init --source lcm`` writes."""
    robot_folder.create("robot1", tmp_path / "robot1", robot_folder.Options(source="lcm"))
    return load_setup(tmp_path / "robot1" / "robot1.yaml")


def said(causes):
    return {cause.name: f"{cause.what} -> {cause.do}" for cause in causes}


def test_a_fresh_robot_lacks_pictures_first_and_then_somebody_who_lets_it_drive(fresh):
    diagnosis = judge(watched(stopped(), command(status=STOPPED, reason="stop_requested")), "memq://", fresh)
    causes = said(diagnosis.causes)
    assert list(causes) == ["no_images", "stopped"]
    assert "ROBOT1_IMAGE" in causes["no_images"] and "start the camera's program" in causes["no_images"]
    assert "latched" not in causes["stopped"]
    assert "setpoint.run" in causes["stopped"] and "pilotfish go robot1" in causes["stopped"]
    notes = said(diagnosis.notes)
    assert list(notes) == ["no_base"]  # and no slow camera: there is none
    assert "ROBOT1_BASE" in notes["no_base"]


def test_a_fresh_robot_whose_configuration_is_not_known_is_told_the_same():
    causes = said(judge(watched(stopped(), command(status=STOPPED)), "memq://", None).causes)
    assert list(causes) == ["no_images", "stopped"]
    assert "pilotfish go robot1" in causes["stopped"]


def test_a_stop_of_somebody_is_latched(fresh):
    """A setpoint was taken in this session: the stop is not that of the configuration."""
    by_operator = watched(lambda t: stopped(int(1e6 * t), counter=3), command(status=STOPPED))
    causes = said(judge(by_operator, "memq://", fresh).causes)
    assert list(causes) == ["stopped"]  # pictures come: every status answers a new one
    assert "latched" in causes["stopped"] and "pilotfish resume robot1" in causes["stopped"]


def test_a_camera_of_its_own_that_gives_nothing_is_named(fresh):
    from dataclasses import replace

    diagnosis = judge(watched(stopped(), command(status=STOPPED)), "memq://", replace(fresh, source="camera:2"))
    assert "camera:2" in said(diagnosis.causes)["no_images"]


def no_frame(**values):
    return status(SEARCHING, "no_frame", **values)


def test_pictures_that_are_not_looked_at_in_time_on_a_busy_computer_are_its_load():
    seen = with_images(watched(no_frame(), command(status=SEARCHING, reason="no_frame")))
    causes = said(judge(seen, "memq://", None, machine=BUSY).causes)
    assert list(causes) == ["overloaded"]
    assert "load average 14.4 on 2 cores" in causes["overloaded"] and "99 % busy" in causes["overloaded"]
    assert "rmem_max" not in causes["overloaded"]


def test_a_receive_buffer_that_is_large_enough_is_not_advised_to_be_enlarged():
    seen = with_images(watched(no_frame(), command(status=SEARCHING, reason="no_frame")))
    causes = said(judge(seen, "memq://", None, machine=QUIET).causes)
    assert list(causes) == ["images_lost"]
    assert "rmem_max" not in causes["images_lost"]


@pytest.mark.parametrize("machine", [None, Machine(2, 0.4, 0.1, 212_992)])
def test_one_that_is_small_or_not_known_is(machine):
    seen = with_images(watched(no_frame(), command(status=SEARCHING, reason="no_frame")))
    assert "rmem_max" in said(judge(seen, "memq://", None, machine=machine).causes)["images_lost"]


def test_the_coordinator_s_own_late_beats_are_counted_where_its_computer_is_not_known():
    """Beats are counted since the start of the program: 100 in time at first. From 2.0 s, where the deciding half
    begins, to 3.9 s every status has one more that was 4 to 8 ms late: 19."""
    seen = with_images(
        watched(
            lambda t: staged(no_frame(), beats_late=[100, 0, 0, 0, 0, round(RATE_HZ * t)]),
            command(status=SEARCHING, reason="no_frame"),
        )
    )
    causes = said(judge(seen, "memq://", None).causes)
    assert list(causes) == ["overloaded"]
    assert "19 of 19 commands between pictures left 4 ms late or more" in causes["overloaded"]


def test_a_robot_that_follows_on_a_busy_computer_follows_and_the_load_is_noted():
    diagnosis = judge(watched(status(), command()), "memq://", None, machine=BUSY)
    assert diagnosis.follows
    assert "overloaded" in said(diagnosis.notes)
    assert "overloaded" not in said(judge(watched(status(), command()), "memq://", None, machine=QUIET).notes)


def test_a_processor_that_is_never_idle_is_busy(tmp_path):
    """/proc/stat counts ticks: user nice system idle iowait irq softirq steal. 90 more of work, 10 more of idleness."""

    class Host:
        def __init__(self, idle, user):
            self.texts = {
                "/proc/stat": f"cpu  {user} 0 0 {idle} 0 0 0 0 0 0\ncpu0 1 2 3 4\ncpu1 1 2 3 4\n",
                "/proc/loadavg": "3.50 1.00 0.50 2/300 999",
                "/proc/sys/net/core/rmem_max": "212992",
            }

        def read(self, name):
            return self.texts.get(name)

    before = cpu_times(Host(idle=100, user=100))
    machine = machine_load(Host(idle=110, user=190), before)
    assert machine == Machine(cores=2, load_average=3.5, busy_share=pytest.approx(0.9), receive_buffer_bytes=212_992)


def test_without_proc_nothing_is_said_of_the_computer():
    class Nothing:
        def read(self, name):
            return None

    assert machine_load(Nothing(), cpu_times(Nothing())) is None


def test_a_head_is_still_what_is_made_here():
    """Images.heads are (arrival, utime, width, height), as Images.add writes them."""
    images = Images()
    images.add(1.0, ImageHead(7, 640, 480, 0, b""))
    assert images.heads == [(1.0, 7, 640, 480)]

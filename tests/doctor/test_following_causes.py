"""What the messages of a watch add up to, and which cause is named: on messages made here, without a bus."""

import math
import shutil
import subprocess
import time

import pytest

from pilotfish import core, data
from pilotfish.doctor.following import judge
from pilotfish.doctor.following.advice import BASE_COUNTERS, REASONS
from pilotfish.doctor.following.cause import ids_text
from pilotfish.doctor.following.evidence import collect, risen
from pilotfish.doctor.following.no_coordinator import no_coordinator
from pilotfish.doctor.following.setup import Process, Setup, find_setup, load_setup, running_coordinators
from pilotfish.doctor.following.watch import Watched
from pilotfish.doctor.host import Host
from pilotfish.harness.ports import private_lcm_url
from pilotfish.lcmtypes.pilotfish import base_t, command_t, counter_t, status_t
from pilotfish.watching import Kind, Message, parse

SECONDS = 4.0
RATE_HZ = 10
TRACKING, SEARCHING = int(core.Status.tracking), int(core.Status.searching)


def counted(**counts):
    listed = []
    for name, count in counts.items():
        counter = counter_t()
        counter.name, counter.count = name, count
        listed.append(counter)
    return listed


def status(status=TRACKING, reason="none", error_m=0.0, session=7, **counts):
    message = status_t()
    message.status, message.reason, message.error_m = status, int(core.Reason.__members__[reason]), error_m
    message.session, message.setpoint_run, message.setpoint_distance_m = session, True, 1.0
    message.rejected = counted(**counts)
    message.frame_rate_hz = 30.0
    return message


def command(session=7, linear_mps=0.0, status=TRACKING, reason="none"):
    message = command_t()
    message.session, message.linear_mps = session, linear_mps
    message.status, message.reason = status, int(core.Reason.__members__[reason])
    return message


def base(state, **counts):
    message = base_t()
    message.session, message.state, message.rejected = 3, state, counted(**counts)
    return message


def watched(statuses=(), commands=(), bases=()):
    """Each of them RATE_HZ times a second; a function of the time [s] or one value for all of the watch."""
    result = Watched("robot1", SECONDS, start_s=0.0)
    for kind, make in ((Kind.status, statuses), (Kind.command, commands), (Kind.base, bases)):
        for k in range(int(SECONDS * RATE_HZ) if make else 0):
            value = make(k / RATE_HZ) if callable(make) else make
            if value is not None:
                result.add(Message(k / RATE_HZ, "", "robot1", kind, value))
    return result


def names(watched, setup=None):
    diagnosis = judge(watched, "memq://", setup)
    assert all(cause.what and cause.do for cause in diagnosis.causes)
    return [cause.name for cause in diagnosis.causes]


def only(watched, setup=None):
    (cause,) = judge(watched, "memq://", setup).causes
    return cause


# --- evidence ---------------------------------------------------------------------------------------------------------
def test_a_counter_rises_by_its_last_value_less_its_first():
    assert risen([status(tag_margin=5), status(tag_margin=9), status(tag_margin=12)]) == {"tag_margin": 7}


def test_a_counter_that_appears_rose_from_0_unless_messages_had_no_room_for_it():
    """With "others" in the first message the counter may have been there all along: it rose from when it is seen."""
    assert risen([status(), status(tag_margin=9)]) == {"tag_margin": 9}
    assert risen([status(others=3), status(tag_margin=9), status(tag_margin=10)]) == {"tag_margin": 1}


def test_a_counter_that_does_not_rise_is_not_shown():
    assert risen([status(pose=4)] * 3) == {}


def test_a_restart_counts_from_0():
    """2 in the old session (5 to 7), then 4 in the new one."""
    before, after = [status(pose=5), status(pose=7)], [status(session=8, pose=1), status(session=8, pose=4)]
    assert risen(before + after) == {"pose": 6}


def test_two_sessions_that_take_turns_each_count_for_themselves():
    """1000 to 1005 and 7 to 12, alternately: 10 in all, whatever lies between the two."""
    turns = [status(session=7 + k % 2, rival_commands=(1000, 7)[k % 2] + k // 2) for k in range(12)]
    assert risen(turns) == {"rival_commands": 10}


def test_only_the_second_half_decides():
    """Searching until 1 s, tracking since: it follows."""
    seen = collect(watched(lambda t: status(SEARCHING, "no_tag_found") if t < 1.0 else status(), command()))
    assert seen.status_shares == {"tracking": 1.0}
    assert seen.reason_shares == {"none": 1.0}


def test_shares_and_rates_are_counted():
    """Every second status of the second half is coasting; RATE_HZ messages a second."""
    turns = watched(lambda t: status() if round(t * RATE_HZ) % 2 else status(2, "no_tag_found"), command())
    seen = collect(turns)
    assert seen.status_shares == {"tracking": 0.5, "coasting": 0.5}
    assert seen.status_rate_hz == seen.command_rate_hz == RATE_HZ


def test_numbers_of_a_later_version_are_shown_as_numbers():
    strange = status()
    strange.status, strange.reason = 99, 120
    seen = collect(watched(strange, command()))
    assert (seen.last_status, seen.last_reason) == ("status 99", "reason 120")
    assert names(watched(strange, command()))


# --- causes -----------------------------------------------------------------------------------------------------------
def test_a_robot_that_tracks_follows():
    assert names(watched(status(), command())) == []


@pytest.mark.parametrize("name", [name for name in core.Reason.__members__ if name != "none"])
def test_every_reason_of_a_status_is_a_cause_with_something_to_do(name):
    assert len(names(watched(status(SEARCHING, name), command(status=SEARCHING)))) == 1


def test_advice_is_for_reasons_that_there_are():
    assert set(REASONS) <= set(core.Reason.__members__)


def test_the_most_frequent_reason_comes_first():
    """In the second half: 3 of 4 statuses find no tag, 1 of 4 has a pose that is refused."""
    mixed = watched(
        lambda t: status(SEARCHING, "pose_refused" if round(t * RATE_HZ) % 4 == 0 else "no_tag_found"),
        command(status=SEARCHING),
    )
    assert names(mixed) == ["no_tag_found", "pose_refused"]


def test_two_sessions_that_take_turns_are_two_coordinators_and_one_after_the_other_is_a_restart():
    turns = watched(status(), lambda t: command(session=7 + round(t * RATE_HZ) % 2))
    assert names(turns) == ["two_coordinators"]
    restarted = judge(watched(status(), lambda t: command(session=7 if t < 1.0 else 8)), "memq://", None)
    assert restarted.follows
    assert "restarted" in [note.name for note in restarted.notes]


def test_a_robot_whose_last_word_was_a_stop_is_stopped():
    def stopped(time_s):
        message = status(int(core.Status.stopped), "stop_requested")
        message.setpoint_run, message.utime = False, int(1e6 * time_s)  # it answers new pictures
        return message

    assert names(watched(stopped, command())) == ["stopped"]


def test_a_silent_second_half_is_told():
    assert names(watched(lambda t: status() if t < 1.5 else None, lambda t: command() if t < 1.5 else None)) == [
        "fell_silent"
    ]


@pytest.mark.parametrize("name", BASE_COUNTERS)
def test_a_base_that_refuses_is_told_by_the_counter_that_rises(name):
    refusing = watched(status(), command(linear_mps=0.2), lambda t: base(0, **{name: int(10 * t)}))
    cause = only(refusing)
    assert cause.name == "base_refuses"
    assert f"{name} rose by 39" in cause.what  # 0 at 0.0 s to 39 at 3.9 s


def test_a_counter_of_the_base_that_rises_while_it_drives_is_no_cause():
    assert names(watched(status(), command(linear_mps=0.2), lambda t: base(1, command_replayed=int(t)))) == []


@pytest.mark.parametrize(("state", "name"), [(2, "base_stopped"), (3, "base_fault")])
def test_the_state_of_the_base_is_a_cause(state, name):
    assert names(watched(status(), command(), base(state))) == [name]


def test_a_base_that_waits_for_nothing_is_well():
    """At the setpoint nothing is commanded."""
    assert names(watched(status(), command(), base(0))) == []
    assert names(watched(status(), command(linear_mps=0.2), base(0))) == ["base_waits"]


def test_a_distance_that_stays_while_speed_is_commanded_means_that_the_wheels_stand():
    """0.8 m too far all the time, at 0.4 m/s for 4 s: 1.6 m were commanded."""
    stays = watched(status(error_m=-0.8), command(linear_mps=0.4))
    cause = only(stays)
    assert cause.name == "distance_error"
    assert "0.80 m too far (wanted 1.00 m)" in cause.what and "0.40 m/s" in cause.what
    assert only(watched(status(error_m=-0.8), command())).name == "no_speed_commanded"


def test_a_distance_that_shrinks_is_following():
    assert names(watched(lambda t: status(error_m=-1.6 + 0.3 * t), command(linear_mps=0.4))) == []


def test_the_steady_state_error_of_the_paper_s_law_is_following():
    """0.167 m at 0.2 m/s, as published (README)."""
    assert names(watched(status(error_m=-0.167), command(linear_mps=0.2))) == []


def test_how_much_is_too_far_grows_with_the_distance_to_keep():
    """A quarter of 2 m is 0.5 m: 0.45 m is following there, and is not at 1 m, where 0.3 m are allowed."""

    def kept_at(wanted_m):
        message = status(error_m=-0.45)
        message.setpoint_distance_m = wanted_m
        return watched(message, command(linear_mps=0.4))

    assert names(kept_at(2.0)) == []
    assert names(kept_at(1.0)) == ["distance_error"]


@pytest.mark.parametrize(
    ("ids", "text"),
    [((), "none"), ((5,), "5"), ((0, 1), "0 and 1"), ((2, 0, 1), "0 to 2"), ((0, 1, 2, 7, 9), "0 to 2, 7, 9")],
)
def test_ids_are_said_as_one_says_them(ids, text):
    assert ids_text(ids) == text


# --- messages and processes -------------------------------------------------------------------------------------------
@pytest.mark.parametrize("cut", [0, 7, 8, 20, 39])
def test_what_cannot_be_decoded_is_counted_and_crashes_nothing(cut):
    message = parse("ROBOT1_COMMAND", command().encode()[:cut], 0.0)
    assert message.kind is Kind.unreadable
    nobody = Watched("robot1", 1.0)
    nobody.add(message)
    (cause,) = no_coordinator(nobody, private_lcm_url(), [], Host())
    assert cause.name == "other_version"
    assert "ROBOT1_COMMAND (1)" in cause.what


def test_the_service_that_ended_is_named_with_its_exit_code(machine, said):
    def systemctl(command):
        if "robot1-coordinator" in command[2]:  # of pilotfish init
            return said(0, "LoadState=loaded\nActiveState=failed\nExecMainStatus=78\n")
        return said(0, "LoadState=not-found\nActiveState=inactive\nExecMainStatus=0\n")

    (cause,) = no_coordinator(Watched("robot1", 1.0), "memq://", [], machine(systemctl=systemctl))
    assert cause.name == "no_coordinator"
    assert "its service pilotfish-robot1-coordinator is failed, last exit code 78" in cause.what
    (cause,) = no_coordinator(Watched("robot1", 1.0), "memq://", [], machine())
    assert "service" not in cause.what


def test_foreign_channels_are_none_of_ours():
    assert parse("HELLO", b"", 0.0) is None
    assert parse("_STATUS", b"", 0.0).kind is Kind.other


def test_a_process_says_its_options_in_both_spellings(tmp_path):
    process = Process(1, ("pilotfish-coordinator", "--config", "a.yaml", "--name=robot2"), tmp_path)
    assert (process.option("--config"), process.option("--name"), process.option("--source")) == (
        "a.yaml",
        "robot2",
        None,
    )
    assert find_setup("robot2", process.lcm_url, [process]) is None  # its file is not there


def test_only_a_coordinator_of_that_name_on_that_bus_says_what_is_set(tmp_path):
    """Two robots of one name on two buses of one host; options of the URL do not make another bus."""

    def process(pid, config, *options, default_url=""):
        file = str(data.path(f"config/{config}.yaml"))
        return Process(pid, ("pilotfish-coordinator", "--config", file, *options), tmp_path, default_url)

    one, two = "udpm://239.255.76.67:7701?ttl=0", "udpm://239.255.76.67:7702?ttl=0"
    processes = [
        process(1, "circle", "--lcm-url", one),
        process(2, "second", "--lcm-url", two),  # of robot2
        process(3, "line", default_url=two),
        process(4, "coordinator"),
    ]
    found = {url: find_setup("Robot1", url, processes) for url in (one, f"{two}&recv_buf_size=9", "udpm://", "memq://")}
    assert [setup.file.stem if setup else None for setup in found.values()] == ["circle", "line", "coordinator", None]


def test_a_real_process_says_its_bus(tmp_path):
    words = ["sleep", "60"]
    environment = {"LCM_DEFAULT_URL": "udpm://239.255.76.67:7703?ttl=0"}
    (tmp_path / "pilotfish-coordinator").symlink_to(shutil.which("sleep"))
    words[0] = str(tmp_path / "pilotfish-coordinator")
    with subprocess.Popen(words, env=environment, cwd=tmp_path) as process:
        try:
            own, deadline = None, time.monotonic() + 20.0
            while own is None and time.monotonic() < deadline:  # until it has become the program
                own = next((found for found in running_coordinators(Host()) if found.pid == process.pid), None)
        finally:
            process.kill()
    assert own is not None
    assert own.lcm_url == environment["LCM_DEFAULT_URL"]
    assert own.folder == tmp_path


@pytest.mark.parametrize(
    ("source", "channel"), [("lcm", "ROBOT1_IMAGE"), ("lcm:EYE", "EYE"), ("camera:0", None), ("video:a.mp4", None)]
)
def test_the_channel_of_the_images_is_that_of_the_source(tmp_path, source, channel):
    setup = Setup(tmp_path, "robot1", source, 640, 480, "tag36h11", (0,), "body")
    assert setup.image_channel == channel


def test_numbers_that_are_not_known_are_null_in_json():
    said = judge(watched(status(SEARCHING, "no_frame"), command()), "memq://", None).as_dict()
    assert said["evidence"]["error_first_m"] is None
    assert math.isfinite(said["evidence"]["command_rate_hz"])


# --- of whom it speaks ------------------------------------------------------------------------------------------------
def notes_of(seen, given=None):
    return {note.name: note for note in judge(seen, "memq://", given, given=given).notes}


def test_other_coordinators_that_are_heard_are_named_beside_the_one_it_speaks_of():
    seen = watched(status(), command())
    assert "other_coordinators" not in notes_of(seen)
    for robot in ("robot3", "robot2"):
        seen.add(Message(1.0, "", robot, Kind.status, status()))
    note = notes_of(seen)["other_coordinators"]
    assert note.what == "this is about the coordinator of robot1; on this bus there are also those of robot2, robot3"
    assert "--following robot2" in note.do


def test_a_configuration_of_another_robot_is_told_with_both_names():
    """line.yaml is robot1's."""
    config = data.path("config/line.yaml")
    assert "config_of_another" not in notes_of(watched(status(), command()), load_setup(config, "Robot1"))
    seen = watched(status(), command())
    seen.robot = "robot2"
    note = notes_of(seen, load_setup(config, "robot2"))["config_of_another"]
    assert "about the coordinator of robot2" in note.what
    assert "line.yaml is of robot1" in note.what
    assert "--following robot1" in note.do

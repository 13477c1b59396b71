"""The window that a double click in lcm-spy opens, on a virtual screen, with a robot on the bus."""

import re
import socket
import struct
from pathlib import Path

import pytest
from robot_window import CORNERS_PX, HEIGHT, LIT, OUTLINE, PICTURE, WIDTH, box_of, plain_picture, robot
from spy_screen import LAUNCHER, PATIENCE_S

import robot_on_bus
from pilotfish.harness.child import Child
from pilotfish.harness.ports import private_lcm_url

CHANNELS = ["ROBOT1_COMMAND", "ROBOT1_IMAGE", "ROBOT1_OBSERVATION", "ROBOT1_STATUS"]  # as the table sorts them
IMAGE_ROW, STATUS_ROW = 1, 3


class Watcher:
    """lcm-spy beside a robot."""

    def __init__(self, url, screen, spy, robot):
        self.url, self.screen, self.spy, self.robot = url, screen, spy, robot

    def wait(self, condition, what):
        self.spy.wait_until(condition, PATIENCE_S, what)

    def open(self, row, title="^robot1: tracking"):
        """Double clicks; the window that is then there, below the table of channels."""
        self.screen.click(row, times=2)
        self.wait(lambda: self.screen.windows(title), f"opening a window {title}")
        (window,) = self.screen.windows(title)
        self.screen.xdotool("windowmove", "--sync", window, 0, 200)
        return window

    def close(self, window):
        self.screen.close(window)
        self.wait(lambda: window not in self.screen.windows("."), "closing the window")

    def picture(self):
        """Where the plain picture is on the screen: its box; None if it is not."""
        return box_of(self.screen.pixels(), PICTURE, least=50)

    def lit(self):
        """The cell of the rule that fires fully; the curves at the right have its colour, too."""
        return box_of(self.screen.pixels()[:, :580], LIT, least=8)

    def sockets(self):
        """UDP sockets of lcm-spy: descriptors that are one in /proc/net/udp."""
        udp = {line.split()[9] for line in Path("/proc/net/udp").read_text().splitlines()[1:]}
        mine = Path(f"/proc/{self.spy.process.pid}/fd")
        links = [link.readlink().name for link in mine.iterdir() if link.is_symlink()]
        return sum(re.sub(r"\D", "", link) in udp for link in links if link.startswith("socket:"))


@pytest.fixture(scope="module")
def watcher(screen, plug_in, tmp_path_factory):
    url = private_lcm_url()
    with pytest.MonkeyPatch.context() as environment, robot(url) as robot1:
        environment.setenv("DISPLAY", screen.display)
        # One compiler and the simple collector: a short run takes a third less.
        environment.setenv("JAVA_TOOL_OPTIONS", "-XX:TieredStopAtLevel=1 -XX:+UseSerialGC")
        with Child(["sh", LAUNCHER, "--lcm-url", url], tmp_path_factory.mktemp("spy"), "spy") as spy:
            spy.wait_until(lambda: screen.windows("^LCM Spy$"), PATIENCE_S, "showing its window")
            spy.wait_until(lambda: screen.rows() == len(CHANNELS), PATIENCE_S, "listing all channels")
            yield Watcher(url, screen, spy, robot1)


@pytest.fixture
def window(watcher):
    """Opened by a double click on the status; closed afterwards. The robot is then as it was."""
    before = dict(watcher.robot.messages)
    window = watcher.open(STATUS_ROW)
    yield window
    watcher.robot.messages = before
    watcher.close(window)
    assert "pilotfish" not in watcher.spy.stderr()  # neither what it complains of nor a line of a stack trace


def test_tags_are_outlined_where_they_were_measured(watcher, window):
    watcher.wait(watcher.picture, "showing the picture")
    watcher.wait(lambda: box_of(watcher.screen.pixels(), OUTLINE, least=20), "outlining the tag")
    pixels = watcher.screen.pixels()
    left, top, right, bottom = box_of(pixels, PICTURE, least=50)
    scale = (right - left + 1) / WIDTH
    assert scale == pytest.approx((bottom - top + 1) / HEIGHT, rel=0.01)
    # The tag is a square along rows and columns, so its outline is the box of its four corners; (0, 0) is the centre of
    # the first pixel. A line of 2 px about it: 1 px to each side, and 1 px for rounding. The number below the tag has
    # fewer than 20 pixels in a row.
    us, vs = {u for u, _ in CORNERS_PX}, {v for _, v in CORNERS_PX}
    expected = [(min(us) + 0.5), (min(vs) + 0.5), (max(us) + 0.5), (max(vs) + 0.5)]
    expected = [corner * scale + begin for corner, begin in zip(expected, [left, top, left, top], strict=True)]
    assert list(box_of(pixels, OUTLINE, least=20)) == pytest.approx(expected, abs=2.5)


def test_the_rule_that_fires_is_lit_in_its_row_and_column(watcher, window):
    def lit(rule, *, other_than=None):
        watcher.robot.messages["STATUS"] = robot_on_bus.with_lists(
            robot_on_bus.status(text="tracking"), strengths={rule: 1.0}
        )
        watcher.wait(lambda: watcher.lit() not in (None, other_than), f"lighting rule {rule}")
        return watcher.lit()

    # Rule 31 is the fourth of the fifth row, rule 9 the third of the second. Cells touch: they are as far apart as they
    # are large, with the line between them; what is seen of a cell is 1 px less, and its place is rounded.
    first = lit(31)
    second = lit(9, other_than=first)
    width, height = first.right - first.left + 2, first.bottom - first.top + 2
    assert first.left - second.left == pytest.approx(width, abs=2)
    assert first.top - second.top == pytest.approx(3 * height, abs=4)


def test_the_title_says_the_status_and_its_reason_in_the_coordinators_words(watcher, window):
    text = "lost: a tag of the leader is too blurred"
    watcher.robot.messages["STATUS"] = robot_on_bus.status(text=text, status=3)
    watcher.wait(lambda: watcher.screen.windows(f"^robot1: {text}$"), "saying why")


def test_a_robot_that_falls_silent_is_not_shown_as_live(watcher, window):
    watcher.wait(watcher.picture, "showing the picture")
    watcher.robot.messages = {}
    watcher.wait(lambda: watcher.screen.windows("^robot1: no message for [0-9]+ s$"), "saying that nothing comes")
    watcher.wait(lambda: not watcher.picture(), "greying the picture")
    assert watcher.lit() is None  # nor do rules fire


def test_an_image_opens_the_same_window_and_another_robot_one_of_its_own(watcher, window):
    watcher.screen.click(IMAGE_ROW, times=2)
    with robot(watcher.url, "robot2", STATUS=robot_on_bus.status(text="stopped: stop requested", status=4)):
        watcher.wait(lambda: watcher.screen.rows() == 2 * len(CHANNELS), "listing both robots")
        second = watcher.open(len(CHANNELS) + STATUS_ROW, "^robot2: stopped: stop requested$")
        assert watcher.screen.windows("^(robot1|ROBOT1_)") == [window]
        assert watcher.screen.windows("^robot1: tracking$") == [window]
        watcher.close(second)


def test_a_closed_window_receives_nothing_and_can_be_opened_again(watcher):
    watcher.wait(lambda: watcher.sockets() == 1, "having a socket of its own only")
    for _ in range(2):
        window = watcher.open(IMAGE_ROW)
        watcher.wait(lambda: watcher.sockets() == 2, "listening for the window")
        watcher.wait(watcher.picture, "showing the picture")
        watcher.close(window)
        watcher.wait(lambda: watcher.sockets() == 1, "letting go of the bus")


def test_damaged_messages_leave_the_window_as_it_is(watcher, window):
    watcher.wait(watcher.picture, "showing the picture")
    good = watcher.robot.messages["IMAGE"].encode()
    status = watcher.robot.messages["STATUS"].encode()
    huge = bytearray(good)
    huge[16:24] = struct.pack(">ii", 2**31 - 1, 2**31 - 1)
    watcher.robot.messages["IMAGE"] = good[:1000]  # goes on, so that it is not silence that greys the picture
    for damaged in (b"", good[:10], good[:1000], bytes(huge), b"\0" * 100, b"\xff" * 100):
        watcher.robot.send("IMAGE", damaged)
        watcher.robot.send("STATUS", damaged)
        watcher.robot.send("OBSERVATION", status)
    watcher.wait(lambda: not watcher.picture(), "greying a picture that is refused")
    watcher.robot.messages["IMAGE"] = plain_picture(robot_on_bus.NOW_US)
    watcher.wait(watcher.picture, "showing the next good one")
    assert watcher.screen.windows("^robot1: tracking$") == [window]


def test_the_window_receives_again_after_a_datagram_that_ends_lcms_receiver(watcher, window):
    # The first piece of a message of -1 bytes: LCM's receiving thread in Java ends at it, lcm-spy's own too, so that
    # this test is the last one of its lcm-spy. Magic, sequence number, size, offset, piece, pieces, channel.
    group, port = re.search(r"//([\d.]+):(\d+)", watcher.url).groups()
    fatal = struct.pack(">4siiiHH", b"LC03", 1, -1, 0, 0, 2) + b"X\0"
    ends = "java.lang.NegativeArraySizeException"
    before = watcher.spy.stderr().count(ends)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        sender.sendto(fatal, (group, int(port)))
    watcher.wait(lambda: watcher.spy.stderr().count(ends) == before + 2, "ending both receivers")
    watcher.robot.messages["STATUS"] = robot_on_bus.status(text="lost: said afterwards", status=3)
    watcher.wait(lambda: watcher.screen.windows("^robot1: lost: said afterwards$"), "receiving again")

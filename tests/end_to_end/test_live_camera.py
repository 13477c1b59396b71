"""pilotfish-coordinator on a Video4Linux camera that goes wrong in every way that one can."""

import pytest

from camera_robot import CAMERA_FAULTS, CameraRobot, leader_camera


@pytest.mark.parametrize("format", ["GREY", "YUYV", "NV12", "MJPG"])
def test_a_leader_in_a_cameras_pictures_is_followed(tmp_path, format):
    camera = leader_camera(tmp_path, format=format)
    with CameraRobot(camera, tmp_path) as robot:
        robot.drives(count=20)
        assert format in robot.child.stdout()


@pytest.mark.parametrize("fault", CAMERA_FAULTS)
@pytest.mark.fault(
    "camera_unplugged",
    "camera_blocked",
    "camera_black",
    "camera_saturated",
    "camera_blurred",
    "camera_old_buffers",
    "camera_damaged_jpeg",
    "camera_frozen",
)
def test_a_camera_that_goes_wrong_stops_the_robot_until_it_is_well_again(tmp_path, fault):
    format, begin = CAMERA_FAULTS[fault]
    camera = leader_camera(tmp_path, format=format)
    with CameraRobot(camera, tmp_path) as robot:
        robot.drives()
        begin(camera)
        robot.stands()
        camera.heal()
        camera.show("leader")
        robot.drives()


def test_a_camera_that_is_pulled_out_again_and_again_comes_back_each_time_and_leaves_nothing_open(tmp_path):
    camera = leader_camera(tmp_path)
    with CameraRobot(camera, tmp_path) as robot:
        for count in range(1, 4):
            robot.drives()
            assert (camera.opens, camera.closes) == (count, count - 1)
            camera.pulled_out = 1
            robot.stands()
            camera.pulled_out = 0
        robot.drives()
        assert robot.child.stdout().count("has been pulled out") == 3

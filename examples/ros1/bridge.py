"""A bridge between Pilotfish's LCM and ROS 1, by rospy.

Three duties, each a process of its own, so that a large picture can delay no stop. Needs a roscore, Debian's
python3-rospy, and pilotfish in a virtual environment that sees it (README.md).

\b
Examples
  bridge.py cmd-vel robot1
  bridge.py sensors robot1 --odom /odom --compressed /camera/image_raw/compressed
  bridge.py report robot1
"""

import sys

try:
    import typer
    from cmd_vel import cmd_vel
    from report import report
    from sensors import sensors

    from pilotfish.cli.console import SysexitsGroup
except ModuleNotFoundError as missing:
    print(f"bridge.py: there is no {missing.name} for {sys.executable}: see README.md", file=sys.stderr)
    sys.exit(69)

app = typer.Typer(cls=SysexitsGroup, help=__doc__, no_args_is_help=True, add_completion=False)
for duty in (cmd_vel, sensors, report):
    app.command()(duty)

if __name__ == "__main__":
    app()

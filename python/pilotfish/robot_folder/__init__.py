"""A folder that holds everything one robot needs: ``pilotfish init``.

from pilotfish import robot_folder
robot_folder.create("robot1", Path("robot1"))
"""

from pilotfish.robot_folder.create import Options, create, planned

__all__ = ["Options", "create", "planned"]

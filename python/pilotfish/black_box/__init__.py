"""What a coordinator recorded of itself: reading it, and computing it again.

from pilotfish.black_box import events_in, replay

report = replay(events_in("/var/lib/pilotfish"))
print(report.commands, report.differences)
"""

from pilotfish.black_box.log import Damage, Event, events_in
from pilotfish.black_box.replay import Difference, ReplayReport, replay

__all__ = ["Damage", "Difference", "Event", "ReplayReport", "events_in", "replay"]

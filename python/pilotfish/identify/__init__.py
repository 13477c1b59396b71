"""What a drive is like, from a recorded run: latency, lag, gains and noise, with standard deviations.

from pilotfish.identify import evidence_of, fit_drive
from pilotfish.logs import read_run

print(fit_drive(evidence_of(read_run("recordings").robots["robot1"])))
"""

from pilotfish.identify.evidence import Evidence, evidence_from_recording, evidence_of
from pilotfish.identify.fit import DriveFit, Estimate, fit_drive
from pilotfish.identify.verdicts import KeyVerdict, as_yaml, verdicts_of

__all__ = [
    "DriveFit",
    "Estimate",
    "Evidence",
    "KeyVerdict",
    "as_yaml",
    "evidence_from_recording",
    "evidence_of",
    "fit_drive",
    "verdicts_of",
]

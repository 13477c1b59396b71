"""What a robot learns about its parts from pictures, once: ``camera`` its lens, ``mounting`` where the camera sits,
``body`` where the tags of a leader sit; ``board`` is the file of a printed calibration board."""

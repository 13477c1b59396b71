"""What is learned from pictures, once: ``body`` finds where the tags of a leader sit, ``board`` is the file of a
printed calibration board."""

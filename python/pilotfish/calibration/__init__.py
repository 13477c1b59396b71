"""What is learned from pictures, once: ``body`` finds where the tags of a leader sit, ``board`` reads and writes the file
of a printed calibration board."""

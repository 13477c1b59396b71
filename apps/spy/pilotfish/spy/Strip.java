package pilotfish.spy;

/** A quantity that is drawn as a curve over the last minute. */
enum Strip {
    DISTANCE_ERROR("distance error, wanted \u2212 measured", "mm", 0, 50, false, true),
    BEARING_ERROR("bearing error, measured \u2212 wanted", "\u00b0", 2, 2, false, true),
    SPEED("command: speed v", "m/s", 3, 0.1, false, true),
    TURN_RATE("command: turn rate \u03c9", "rad/s", 3, 0.2, false, true),
    LATENCY("latency, picture to command", "ms", 1, 20, true, false);

    final String title;
    final String unit;
    /** Decimals of its newest value. */
    final int digits;
    /** The axis reaches at least so far, so that noise does not fill it. */
    final double least;
    /** Its axis begins at zero. */
    final boolean positive;
    final boolean signed;

    Strip(String title, String unit, int digits, double least, boolean positive, boolean signed) {
        this.title = title;
        this.unit = unit;
        this.digits = digits;
        this.least = least;
        this.positive = positive;
        this.signed = signed;
    }
}

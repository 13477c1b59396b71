package pilotfish.spy;

/** The vertical axis of a strip: round ends, so that noise does not move it; the same as of `pilotfish view`. */
final class AxisRange {
    private static final double[] ROUND = {1, 1.5, 2, 3, 5, 7.5, 10};

    final double low;
    final double high;

    private AxisRange(double low, double high) {
        this.low = low;
        this.high = high;
    }

    /** values: NaN where nothing is known. */
    static AxisRange of(Strip strip, double[] values) {
        double low = Double.POSITIVE_INFINITY, high = Double.NEGATIVE_INFINITY;
        for (double value : values) {
            if (!Double.isFinite(value)) continue;
            low = Math.min(low, value);
            high = Math.max(high, value);
        }
        double widest = low > high ? 0 : Math.max(Math.abs(low), Math.abs(high));
        double most = widest <= strip.least ? strip.least : round(widest);
        if (strip.positive) return new AxisRange(0, most);
        if (widest <= strip.least) return new AxisRange(-most, most);
        if (low >= -0.02 * most) return new AxisRange(-0.05 * most, most);
        return high <= 0.02 * most ? new AxisRange(-most, 0.05 * most) : new AxisRange(-most, most);
    }

    /** The next of 1, 1.5, 2, 3, ... times a power of ten that is a little above. */
    private static double round(double value) {
        double power = Math.pow(10, Math.floor(Math.log10(value)));
        for (double step : ROUND) if (step * power >= 1.02 * value) return step * power;
        return 15 * power;  // above 10 / 1.02
    }
}

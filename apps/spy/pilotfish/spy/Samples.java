package pilotfish.spy;

import java.util.Arrays;

/** The last minute of every strip, a sample each 100 ms, in rings of fixed size; NaN where nothing was known. */
final class Samples {
    static final int COUNT = 600;
    static final long PERIOD_NS = 100_000_000L;

    private final double[][] rings = new double[Strip.values().length][COUNT];
    private int next;
    private long dueNs;
    private boolean begun;

    Samples() {
        for (double[] ring : rings) Arrays.fill(ring, Double.NaN);
    }

    /**
     * How many samples are due by now. Usually none or one; more if this process had no time for them: those are
     * gaps, so that the axis stays true. At most COUNT.
     */
    int due(long nowNs) {
        if (!begun) {
            begun = true;
            dueNs = nowNs;
        }
        long count = Math.min(Math.floorDiv(nowNs - dueNs, PERIOD_NS) + 1, COUNT);
        return (int) Math.max(count, 0);
    }

    /** Takes the due samples: the newest is `values`, one of each strip; those before it are gaps. */
    void add(double[] values, long nowNs) {
        int count = due(nowNs);
        for (int k = count; k > 0; k--) {
            for (int s = 0; s < rings.length; s++) rings[s][next] = k == 1 ? values[s] : Double.NaN;
            next = (next + 1) % COUNT;
        }
        if (count > 0) dueNs = nowNs - Math.floorMod(nowNs - dueNs, PERIOD_NS) + PERIOD_NS;
    }

    /** From the oldest to the newest. */
    double[] of(Strip strip) {
        double[] ring = rings[strip.ordinal()];
        double[] ordered = new double[COUNT];
        System.arraycopy(ring, next, ordered, 0, COUNT - next);
        System.arraycopy(ring, 0, ordered, COUNT - next, next);
        return ordered;
    }
}

package pilotfish.spy;

import java.io.IOException;
import java.util.Arrays;
import java.util.EnumMap;
import java.util.LinkedHashMap;
import java.util.Map;
import pilotfish.command_t;
import pilotfish.observation_t;
import pilotfish.status_t;

/**
 * What is known of a robot by now, folded from its messages. Without a clock of its own: `nowNs` is any clock that
 * never runs backward. LCM's thread puts messages in while Swing's reads, hence the locks; what is read is never
 * changed again.
 */
final class RobotModel {
    static final long FRESH_NS = 500_000_000L;
    private static final long PICTURE_PREFERRED_NS = 1_000_000_000L;
    private static final int OVERLAYS = 64;

    private final Map<Kind, Object> latest = new EnumMap<>(Kind.class);
    private final Map<Kind, Long> arrivedNs = new EnumMap<>(Kind.class);
    private final Map<Kind, Integer> unreadable = new EnumMap<>(Kind.class);
    private final PictureQueue pictures = new PictureQueue();
    private final Samples samples = new Samples();
    /** By the exposure of the picture that each was measured in. */
    private final Map<Long, observation_t> overlays = new LinkedHashMap<>() {
        private static final long serialVersionUID = 1L;

        @Override
        protected boolean removeEldestEntry(Map.Entry<Long, observation_t> eldest) {
            return size() > OVERLAYS;
        }
    };

    synchronized void take(Kind kind, byte[] message, long nowNs) {
        if (kind.isPicture()) {
            // Both show the same; a preview is the smaller one.
            if (kind == Kind.PREVIEW && ageNs(Kind.IMAGE, nowNs) < PICTURE_PREFERRED_NS) return;
            arrivedNs.put(kind, nowNs);
            pictures.add(message);
            return;
        }
        try {
            Object value = decode(kind, message);
            latest.put(kind, value);
            arrivedNs.put(kind, nowNs);
            if (value instanceof observation_t) remember((observation_t) value);
        } catch (IOException | RuntimeException | OutOfMemoryError damaged) {
            // The generated decoders throw whatever the bytes lead to, and take what memory a message asks for.
            unreadable.merge(kind, 1, Integer::sum);
        }
    }

    /** Where frames stay out, a coordinator repeats the last frame's time and says so: that does not unsee its tags. */
    private void remember(observation_t seen) {
        observation_t before = overlays.get(seen.utime);
        if (before == null || !before.detected || seen.detected) overlays.put(seen.utime, seen);
    }

    private static Object decode(Kind kind, byte[] message) throws IOException {
        switch (kind) {
            case STATUS: return new status_t(message);
            case OBSERVATION: return new observation_t(message);
            default: return new command_t(message);
        }
    }

    /** Null before the first. */
    synchronized status_t status() {
        return (status_t) latest.get(Kind.STATUS);
    }

    /** Null before the first. */
    synchronized observation_t observation() {
        return (observation_t) latest.get(Kind.OBSERVATION);
    }

    /** What was measured in the picture of that exposure; null if nothing is known. */
    synchronized observation_t observationIn(long utime) {
        return overlays.get(utime);
    }

    /** Since a message of the kind came; Long.MAX_VALUE if none did. */
    synchronized long ageNs(Kind kind, long nowNs) {
        Long arrived = arrivedNs.get(kind);
        return arrived == null ? Long.MAX_VALUE : nowNs - arrived;
    }

    /** Since a picture came; Long.MAX_VALUE if none did. */
    synchronized long pictureAgeNs(long nowNs) {
        return Math.min(ageNs(Kind.IMAGE, nowNs), ageNs(Kind.PREVIEW, nowNs));
    }

    /** The next picture to decode and show; null: none yet. */
    synchronized byte[] nextPicture(long nowNs) {
        return pictures.next(nowNs, ageNs(Kind.OBSERVATION, nowNs) < FRESH_NS, overlays::containsKey);
    }

    /** Messages of each kind that could not be decoded. */
    synchronized Map<Kind, Integer> unreadable() {
        return new EnumMap<>(unreadable);
    }

    /** Takes a sample of every strip if one is due; whether one was. */
    synchronized boolean sample(long nowNs) {
        if (samples.due(nowNs) == 0) return false;
        samples.add(values(nowNs), nowNs);
        return true;
    }

    synchronized double[] samplesOf(Strip strip) {
        return samples.of(strip);
    }

    /** How many things are kept: pictures, observations, samples of a strip. They have an upper bound. */
    synchronized int[] sizes() {
        return new int[] {pictures.size(), overlays.size(), samples.of(Strip.SPEED).length};
    }

    /** NaN for what is not known, or no longer; what a message says may be infinite. */
    private double[] values(long nowNs) {
        double[] values = new double[Strip.values().length];
        Arrays.fill(values, Double.NaN);
        status_t status = ageNs(Kind.STATUS, nowNs) < FRESH_NS ? status() : null;
        observation_t seen = ageNs(Kind.OBSERVATION, nowNs) < FRESH_NS ? observation() : null;
        if (status != null && seen != null && seen.detected) {
            values[Strip.DISTANCE_ERROR.ordinal()] = 1e3 * (status.setpoint_distance_m - seen.distance_m);
            double off = Math.IEEEremainder(seen.bearing_rad - status.setpoint_bearing_rad, 2 * Math.PI);
            values[Strip.BEARING_ERROR.ordinal()] = Math.toDegrees(off);
        }
        if (status != null) values[Strip.LATENCY.ordinal()] = 1e3 * status.latency_s;
        if (ageNs(Kind.COMMAND, nowNs) < FRESH_NS) {
            command_t command = (command_t) latest.get(Kind.COMMAND);
            values[Strip.SPEED.ordinal()] = command.linear_mps;
            values[Strip.TURN_RATE.ordinal()] = command.angular_radps;
        }
        return values;
    }
}

package pilotfish.spy;

import java.util.Locale;
import java.util.Map;
import pilotfish.command_t;
import pilotfish.observation_t;
import pilotfish.status_t;

/**
 * What a window says in words. The coordinator's own words come with its messages; these are about ages and numbers.
 */
final class Words {
    /** The tone of a status: what its colours are made from. */
    enum Tone { GOOD, WAIT, BAD, STOP, OLD }

    private static final long SAID_NS = 1_000_000_000L;

    private Words() {}

    static Tone toneOf(int status) {
        switch (status) {
            case command_t.STATUS_TRACKING: return Tone.GOOD;
            case command_t.STATUS_SEARCHING:
            case command_t.STATUS_COASTING: return Tone.WAIT;
            case command_t.STATUS_STOPPED: return Tone.STOP;
            default: return Tone.BAD;
        }
    }

    /** The first word of "lost: no tag in the picture". */
    static String headline(status_t status) {
        int colon = status.text.indexOf(": ");
        return (colon < 0 ? status.text : status.text.substring(0, colon)).replace('_', ' ');
    }

    /** The rest of it; empty: nothing to explain. */
    static String reason(status_t status) {
        int colon = status.text.indexOf(": ");
        return colon < 0 ? "" : status.text.substring(colon + 2);
    }

    /** "1.102 m, 9.9 degrees to the right; to keep: ...". */
    static String measured(status_t status, observation_t seen) {
        String keep = "to keep: " + place(status.setpoint_distance_m, status.setpoint_bearing_rad);
        if (seen == null || !seen.detected) return keep;
        return place(seen.distance_m, seen.bearing_rad) + "; " + keep;
    }

    private static String place(double distanceM, double bearingRad) {
        double degrees = Math.toDegrees(bearingRad);
        String side = Math.abs(degrees) < 0.05 ? "straight ahead"
                : number(Math.abs(degrees), 1) + "\u00b0 to the " + (degrees > 0 ? "left" : "right");
        return number(distanceM, 3) + " m, " + side;
    }

    /** Empty while messages come. */
    static String silence(long ageNs) {
        if (ageNs == Long.MAX_VALUE) return "no message yet";
        return ageNs < SAID_NS ? "" : "no message for " + duration(ageNs);
    }

    static String duration(long ns) {
        long seconds = ns / 1_000_000_000L;
        return seconds < 120 ? seconds + " s" : seconds / 60 + " min";
    }

    /** Empty if every message could be read. */
    static String unreadable(Map<Kind, Integer> counts) {
        StringBuilder words = new StringBuilder();
        counts.forEach((kind, count) ->
                words.append(words.length() == 0 ? "" : ", ").append(count).append(' ').append(kind));
        return words.length() == 0 ? "" : "unreadable (damaged, or of another version): " + words;
    }

    /** With a true minus sign; a dash for NaN. */
    static String number(double value, int digits) {
        if (!Double.isFinite(value)) return "\u2013";
        String text = String.format(Locale.ROOT, "%." + digits + "f", Math.abs(value));
        boolean zero = text.matches("[0.]*");
        return (value < 0 && !zero ? "\u2212" : "") + text;
    }

    /** The same with a plus for positive ones. */
    static String signed(double value, int digits) {
        String text = number(value, digits);
        return Double.isFinite(value) && value > 0 && !text.matches("[0.]*") ? "+" + text : text;
    }
}

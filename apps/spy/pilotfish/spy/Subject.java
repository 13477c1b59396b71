package pilotfish.spy;

import java.util.Locale;
import java.util.Map;
import java.util.TreeMap;
import java.util.regex.Matcher;
import java.util.regex.Pattern;

/** Who a window is about: a title, and the channels it listens to. */
final class Subject {
    /** The rule of include/pilotfish/core/robot_name.hpp. */
    private static final Pattern ROBOT = Pattern.compile("([A-Z0-9_]{1,32})_(STATUS|IMAGE|PREVIEW)");

    private final String title;
    private final Map<String, Kind> kinds;

    private Subject(String title, Map<String, Kind> kinds) {
        this.title = title;
        this.kinds = kinds;
    }

    /** ROBOT1_STATUS: everything of robot1. A channel that names no robot: that channel alone. */
    static Subject of(String channel, boolean isImage) {
        Map<String, Kind> kinds = new TreeMap<>();
        Matcher match = ROBOT.matcher(channel);
        if (!match.matches()) {
            kinds.put(channel, isImage ? Kind.IMAGE : Kind.STATUS);
            return new Subject(channel, kinds);
        }
        for (Kind kind : Kind.values()) kinds.put(match.group(1) + "_" + kind, kind);
        return new Subject(match.group(1).toLowerCase(Locale.ROOT), kinds);
    }

    String title() {
        return title;
    }

    /** Null for a channel of somebody else. */
    Kind kindOf(String channel) {
        return kinds.get(channel);
    }

    /** A camera's channel, without a coordinator that would have a status. */
    boolean isPictureOnly() {
        return !kinds.containsValue(Kind.STATUS);
    }

    /** For LCM: a regular expression that matches these channels and no others. */
    String channels() {
        StringBuilder pattern = new StringBuilder();
        for (String channel : kinds.keySet()) {
            pattern.append(pattern.length() == 0 ? "" : "|").append(Pattern.quote(channel));
        }
        return pattern.toString();
    }

    /** Empty where it has none. */
    String channelOf(Kind wanted) {
        return kinds.entrySet().stream().filter(entry -> entry.getValue() == wanted).map(Map.Entry::getKey).findFirst()
                .orElse("");
    }

    /** For people: where pictures are expected. */
    String pictureChannels() {
        StringBuilder names = new StringBuilder();
        kinds.forEach((channel, kind) -> {
            if (kind.isPicture()) names.append(names.length() == 0 ? "" : " or ").append(channel);
        });
        return names.toString();
    }
}

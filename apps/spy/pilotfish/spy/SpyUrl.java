package pilotfish.spy;

/** The network that lcm-spy was told to watch. It tells its plug-ins nothing about it, so its command line is read. */
final class SpyUrl {
    private SpyUrl() {}

    /** Of this process; null: LCM's default ($LCM_DEFAULT_URL, or its own). */
    static String ofThisProcess() {
        return of(System.getProperty("sun.java.command", ""));
    }

    /** Of a command line: {@code lcm.spy.Spy --lcm-url=URL}, {@code --lcm-url URL} or {@code -l URL}. */
    static String of(String command) {
        String[] words = command.trim().split("\\s+");
        for (int k = 0; k < words.length; k++) {
            if (words[k].startsWith("--lcm-url=")) return words[k].substring("--lcm-url=".length());
            boolean next = words[k].equals("--lcm-url") || words[k].equals("-l");
            if (next && k + 1 < words.length) return words[k + 1];
        }
        return null;
    }
}

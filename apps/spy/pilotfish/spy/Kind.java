package pilotfish.spy;

/** What a channel carries; the names are the ends of the channels' names. */
enum Kind {
    STATUS,
    OBSERVATION,
    COMMAND,
    IMAGE,
    PREVIEW;

    boolean isPicture() {
        return this == IMAGE || this == PREVIEW;
    }
}

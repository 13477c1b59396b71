package pilotfish.spy;

/** A picture that cannot be shown; the message says why, for people. */
final class RefusedPicture extends Exception {
    private static final long serialVersionUID = 1L;

    RefusedPicture(String reason) {
        super(reason);
    }
}

package pilotfish.spy;

import java.util.ArrayDeque;
import java.util.Iterator;
import java.util.function.LongPredicate;

/**
 * Pictures that wait to be shown, encoded. A picture comes some milliseconds before what was measured in it. Shown at
 * once it would have no outlines, or those of another picture; so it waits for its own, but not for long.
 */
final class PictureQueue {
    static final int MOST = 4;
    static final long PATIENCE_NS = 150_000_000L;

    private final ArrayDeque<byte[]> waiting = new ArrayDeque<>();  // the newest last
    private long shownNs;

    void add(byte[] message) {
        if (waiting.size() == MOST) waiting.removeFirst();
        waiting.addLast(message);
    }

    int size() {
        return waiting.size();
    }

    /**
     * The newest that was measured; where none was, the newest as soon as nothing has been shown for PATIENCE_NS, or at
     * once if nobody measures. Null: nothing to show yet. It and older ones leave the queue.
     */
    byte[] next(long nowNs, boolean measuring, LongPredicate measured) {
        byte[] chosen = null;
        for (Iterator<byte[]> newestFirst = waiting.descendingIterator(); newestFirst.hasNext() && chosen == null; ) {
            byte[] message = newestFirst.next();
            if (measured.test(PictureDecoder.utimeOf(message))) chosen = message;
        }
        if (chosen == null && (!measuring || nowNs - shownNs > PATIENCE_NS)) chosen = waiting.peekLast();
        if (chosen == null) return null;
        while (waiting.removeFirst() != chosen) continue;
        shownNs = nowNs;
        return chosen;
    }
}

package pilotfish.spy;

import java.io.IOException;
import java.util.function.BiConsumer;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;

/**
 * A connection that only receives. lcm-spy gives its plug-ins the messages of the clicked channel alone, and a robot
 * has several, so a window has a connection of its own.
 *
 * <p>LCM's receiving thread ends for good at a datagram that it cannot take apart. {@link #check} notices and connects
 * anew. All methods but the callback are called by one thread, not Swing's: closing waits for the receiving thread.
 */
final class BusConnection implements LCMSubscriber {
    private static final int MAX_MESSAGE_BYTES = 64 << 20;

    private final String url;
    private final String channels;
    private final BiConsumer<String, byte[]> receiver;
    private LCM lcm;
    private volatile Thread receiving;
    private volatile String problem = "";

    /** url: null for LCM's default. The receiver is called on LCM's thread and must not wait for anything. */
    BusConnection(String url, String channels, BiConsumer<String, byte[]> receiver) {
        this.url = url;
        this.channels = channels;
        this.receiver = receiver;
    }

    /** Why nothing can be received; empty if nothing is known to be wrong. */
    String problem() {
        return problem;
    }

    /** Connects, if there is no connection that works. */
    void check() {
        Thread last = receiving;
        if (lcm != null && (last == null || last.isAlive())) return;
        close();
        try {
            lcm = url == null ? new LCM() : new LCM(url);
            ReceiveBuffer.enlarge(lcm);
            lcm.subscribe(channels, this);
            problem = "";
        } catch (IOException | RuntimeException failure) {
            close();
            problem = "the bus " + (url == null ? "" : url) + " cannot be opened: " + failure.getMessage();
        }
    }

    void close() {
        receiving = null;
        if (lcm == null) return;
        try {
            lcm.close();
        } catch (RuntimeException failure) {
            System.err.println("pilotfish: closing the bus: " + failure);
        }
        lcm = null;
    }

    @Override
    public void messageReceived(LCM from, String channel, LCMDataInputStream stream) {
        try {
            receiving = Thread.currentThread();
            int size = stream.available();
            if (size > MAX_MESSAGE_BYTES) return;
            byte[] data = new byte[size];
            stream.readFully(data);
            receiver.accept(channel, data);
        } catch (Throwable failure) {
            // Thrown on, it would end LCM's thread.
            System.err.println("pilotfish: a message on " + channel + " was not taken: " + failure);
        }
    }
}

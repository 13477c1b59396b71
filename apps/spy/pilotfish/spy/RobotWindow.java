package pilotfish.spy;

import java.awt.Dimension;
import java.awt.Frame;
import java.awt.Rectangle;
import java.awt.event.WindowAdapter;
import java.awt.event.WindowEvent;
import java.util.concurrent.ExecutorService;
import java.util.concurrent.Executors;
import java.util.concurrent.atomic.AtomicBoolean;
import javax.swing.JFrame;
import javax.swing.SwingUtilities;
import javax.swing.Timer;
import javax.swing.WindowConstants;
import pilotfish.status_t;

/**
 * The window of a robot: a panel, the messages for it, and the clock that repaints it. Closing it ends its connection
 * and its threads.
 */
final class RobotWindow {
    private static final int PERIOD_MS = 50;  // 20 Hz at most, however fast messages come

    private final JFrame frame;
    private final Subject subject;
    private final RobotModel model = new RobotModel();
    private final RobotPanel panel;
    private final BusConnection bus;
    private final Timer timer = new Timer(PERIOD_MS, event -> tick());
    /** Connects, and decodes pictures, so that the windows of lcm-spy never wait for either. */
    private final ExecutorService worker = Executors.newSingleThreadExecutor(work -> {
        Thread thread = new Thread(work, "pilotfish-window");
        thread.setDaemon(true);
        return thread;
    });
    private final AtomicBoolean working = new AtomicBoolean();

    /** Shows `frame`, whose content it replaces; `onClosed` is called when it has been closed. */
    RobotWindow(JFrame frame, Subject subject, Runnable onClosed) {
        this.frame = frame;
        this.subject = subject;
        panel = new RobotPanel(subject);
        bus = new BusConnection(SpyUrl.ofThisProcess(), subject.channels(), this::take);
        frame.setDefaultCloseOperation(WindowConstants.DISPOSE_ON_CLOSE);
        frame.addWindowListener(new WindowAdapter() {
            @Override
            public void windowClosed(WindowEvent event) {
                close();
                onClosed.run();
            }
        });
        frame.setContentPane(panel);
        frame.setTitle(subject.title());
        frame.setMinimumSize(panel.getMinimumSize());
        frame.setSize(sizeOn(frame));
        frame.revalidate();
        frame.setVisible(true);
        timer.start();
    }

    /** What it wants, but not more than the screen has. */
    private static Dimension sizeOn(JFrame frame) {
        Dimension wanted = frame.getContentPane().getPreferredSize();
        Rectangle screen = frame.getGraphicsConfiguration().getBounds();
        return new Dimension(Math.min(wanted.width, screen.width - 20), Math.min(wanted.height, screen.height - 60));
    }

    void toFront() {
        frame.setExtendedState(frame.getExtendedState() & ~Frame.ICONIFIED);
        frame.setVisible(true);
        frame.toFront();
    }

    /** On LCM's thread. */
    private void take(String channel, byte[] message) {
        Kind kind = subject.kindOf(channel);
        if (kind != null) model.take(kind, message, System.nanoTime());
    }

    private void tick() {
        try {
            long nowNs = System.nanoTime();
            panel.update(model, bus.problem(), nowNs);
            String silence = Words.silence(model.ageNs(Kind.STATUS, nowNs));
            status_t status = model.status();  // after its age: where there is an age there is a status
            String title = subject.title();
            if (!subject.isPictureOnly()) title += ": " + (silence.isEmpty() ? status.text : silence);
            if (!title.equals(frame.getTitle())) frame.setTitle(title);
            if (working.compareAndSet(false, true)) worker.execute(this::work);
        } catch (Throwable problem) {
            System.err.println("pilotfish: the window of " + subject.title() + ": " + problem);
        }
    }

    private void work() {
        try {
            bus.check();
            byte[] message = model.nextPicture(System.nanoTime());
            if (message == null) return;
            Picture picture = PictureDecoder.decode(message);
            SwingUtilities.invokeLater(() -> panel.show(picture));
        } catch (RefusedPicture refused) {
            SwingUtilities.invokeLater(() -> panel.refusePicture(refused.getMessage()));
        } catch (Throwable problem) {  // OutOfMemoryError included: the next picture may be smaller
            SwingUtilities.invokeLater(() -> panel.refusePicture(problem.toString()));
        } finally {
            working.set(false);
        }
    }

    private void close() {
        timer.stop();
        if (worker.isShutdown()) return;  // closed before
        worker.execute(bus::close);
        worker.shutdown();
    }
}

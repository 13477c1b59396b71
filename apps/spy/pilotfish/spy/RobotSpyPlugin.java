package pilotfish.spy;

import bot_core.image_t;
import java.awt.event.ActionEvent;
import java.util.HashMap;
import java.util.Map;
import java.util.concurrent.atomic.AtomicBoolean;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;
import pilotfish.status_t;

/**
 * What lcm-spy finds on its class path: a double click on a status or an image opens the window of its robot.
 *
 * <p>lcm-spy calls these methods from its own event handlers, where an exception would leave a half-open window. So
 * nothing is thrown here: what goes wrong is written to standard error.
 */
public final class RobotSpyPlugin implements SpyPlugin {
    /** The lcm-spy of PyPI searches $CLASSPATH twice and so makes two plug-ins of this class: one must be enough. */
    private static final AtomicBoolean MADE = new AtomicBoolean(false);

    private final boolean first = !MADE.getAndSet(true);
    /** Open windows, by title; used by Swing's event thread only. */
    private final Map<String, RobotWindow> windows = new HashMap<>();

    /** Called by lcm-spy. */
    public RobotSpyPlugin() {}

    @Override
    public boolean canHandle(long fingerprint) {
        return first && (fingerprint == status_t.LCM_FINGERPRINT || fingerprint == image_t.LCM_FINGERPRINT);
    }

    /** lcm-spy calls this with two nulls first, to know the action's name. */
    @Override
    public Action getAction(JDesktopPane desktop, ChannelData channel) {
        return new AbstractAction("Robot...") {
            @Override
            public void actionPerformed(ActionEvent event) {
                try {
                    open(Host.frameOf(desktop, channel.name), channel);
                } catch (Throwable problem) {
                    System.err.println("pilotfish: no window for a channel: " + problem);
                }
            }
        };
    }

    private void open(JFrame frame, ChannelData channel) {
        boolean isImage = channel.fingerprint == image_t.LCM_FINGERPRINT;
        Subject subject = Subject.of(channel.name, isImage);
        RobotWindow open = windows.get(subject.title());
        if (open != null) {
            frame.dispose();
            open.toFront();
            return;
        }
        windows.put(subject.title(), new RobotWindow(frame, subject, () -> windows.remove(subject.title())));
    }

    @Override
    public String toString() {
        return "Pilotfish: picture, rules and curves of a robot";
    }
}

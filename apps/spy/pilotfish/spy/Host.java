package pilotfish.spy;

import java.awt.Window;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.SwingUtilities;

/** The frame that lcm-spy has opened for a plug-in. */
final class Host {
    private Host() {}

    /**
     * lcm-spy shows a frame titled as the channel, with nothing in it but a desktop for internal frames. That frame is
     * used; where there is none (another version of lcm-spy), a new one.
     */
    static JFrame frameOf(JDesktopPane desktop, String channel) {
        Window window = desktop == null ? null : SwingUtilities.getWindowAncestor(desktop);
        if (window instanceof JFrame) {
            JFrame frame = (JFrame) window;
            boolean ours = frame.getContentPane().getComponentCount() == 1 && desktop.getComponentCount() == 0;
            if (ours && channel.equals(frame.getTitle())) return frame;
        }
        return new JFrame(channel);
    }
}

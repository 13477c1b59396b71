package pilotfish.spy;

import java.awt.FontMetrics;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.geom.RoundRectangle2D;
import javax.accessibility.AccessibleContext;
import javax.accessibility.AccessibleRole;
import javax.swing.JComponent;

/** A white field with round corners, in which something is drawn. */
abstract class Card extends JComponent {
    private static final long serialVersionUID = 1L;
    static final int MARGIN = 10;

    @Override
    protected final void paintComponent(Graphics graphics) {
        Graphics2D g = Palette.smooth(graphics);
        try {
            g.setColor(Palette.PAGE);
            g.fillRect(0, 0, getWidth(), getHeight());
            RoundRectangle2D field = new RoundRectangle2D.Double(0.5, 0.5, getWidth() - 1, getHeight() - 1, 12, 12);
            g.setColor(Palette.CARD);
            g.fill(field);
            g.setColor(Palette.EDGE);
            g.draw(field);
            int width = getWidth() - 2 * MARGIN, height = getHeight() - 2 * MARGIN;
            if (width < 20 || height < 20) return;
            g.translate(MARGIN, MARGIN);
            paint(g, width, height);
        } catch (RuntimeException problem) {
            // Thrown on, it would end the painting of the whole window.
            System.err.println("pilotfish: " + getClass().getSimpleName() + ": " + problem);
        } finally {
            g.dispose();
        }
    }

    /** What the card says, for whoever cannot see it. */
    final void say(String words) {
        getAccessibleContext().setAccessibleName(words);
    }

    @Override
    public AccessibleContext getAccessibleContext() {
        if (accessibleContext == null) {
            accessibleContext = new AccessibleJComponent() {
                private static final long serialVersionUID = 1L;

                @Override
                public AccessibleRole getAccessibleRole() {
                    return AccessibleRole.LABEL;
                }
            };
        }
        return accessibleContext;
    }

    /** Draws into (0, 0) to (width, height). */
    protected abstract void paint(Graphics2D g, int width, int height);

    /** The text, or as much of its beginning as fits, with an ellipsis. */
    static String fitted(FontMetrics metrics, String text, double width) {
        if (metrics.stringWidth(text) <= width) return text;
        int end = text.length();
        while (end > 0 && metrics.stringWidth(text.substring(0, end) + "\u2026") > width) end--;
        return end == 0 ? "" : text.substring(0, end).stripTrailing() + "\u2026";
    }
}

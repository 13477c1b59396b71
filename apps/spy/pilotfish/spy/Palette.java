package pilotfish.spy;

import java.awt.Color;
import java.awt.Font;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.Toolkit;
import java.util.Map;

/** Colours, letters and hints of all panels; the colours are those of the page of `pilotfish view`. */
final class Palette {
    static final Color PAGE = new Color(0xeef1f5);
    static final Color CARD = new Color(0xffffff);
    static final Color EDGE = new Color(0xd9dfe7);
    static final Color TEXT = new Color(0x18202c);
    static final Color MUTED = new Color(0x566173);
    static final Color FAINT = new Color(0x8b95a5);
    static final Color GRID = new Color(0xe4e9f0);
    static final Color BLUE = new Color(0x1f6fc4);
    static final Color ORANGE = new Color(0xc75a00);
    static final Color GREEN = new Color(0x1b7f4b);
    static final Color RED = new Color(0xc62828);
    /** Of a tag's outline and number, over black so that both dark and bright pictures show it. */
    static final Color OUTLINE = new Color(0xffd23e);
    static final Color BEHIND_OUTLINE = new Color(0, 0, 0, 166);

    private Palette() {}

    static Font font(int style, float size) {
        return new Font(Font.SANS_SERIF, style, 1).deriveFont(style, size);
    }

    static Color background(Words.Tone tone) {
        switch (tone) {
            case GOOD: return new Color(0xe3f4ea);
            case WAIT: return new Color(0xfdf1d8);
            case BAD: return new Color(0xfde5e5);
            default: return new Color(0xececf1);
        }
    }

    /** From white to full orange. */
    static Color lit(double share) {
        double weight = Double.isFinite(share) ? Math.min(Math.max(share, 0), 1) : 0;
        return new Color(mix(CARD.getRed(), ORANGE.getRed(), weight), mix(CARD.getGreen(), ORANGE.getGreen(), weight),
                mix(CARD.getBlue(), ORANGE.getBlue(), weight));
    }

    private static int mix(int from, int to, double weight) {
        return (int) Math.round(from + (to - from) * weight);
    }

    /** A copy to draw with, smooth; the caller disposes it. */
    static Graphics2D smooth(Graphics graphics) {
        Graphics2D copy = (Graphics2D) graphics.create();
        Object desktop = Toolkit.getDefaultToolkit().getDesktopProperty("awt.font.desktophints");
        copy.setRenderingHint(RenderingHints.KEY_TEXT_ANTIALIASING, RenderingHints.VALUE_TEXT_ANTIALIAS_ON);
        if (desktop instanceof Map) copy.addRenderingHints((Map<?, ?>) desktop);
        copy.setRenderingHint(RenderingHints.KEY_ANTIALIASING, RenderingHints.VALUE_ANTIALIAS_ON);
        copy.setRenderingHint(RenderingHints.KEY_STROKE_CONTROL, RenderingHints.VALUE_STROKE_PURE);
        copy.setRenderingHint(RenderingHints.KEY_INTERPOLATION, RenderingHints.VALUE_INTERPOLATION_BILINEAR);
        return copy;
    }
}

package pilotfish.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Font;
import java.awt.FontMetrics;
import java.awt.Graphics2D;
import java.awt.Shape;
import java.awt.geom.AffineTransform;
import java.awt.geom.Path2D;
import java.awt.geom.Point2D;
import java.awt.geom.Rectangle2D;
import pilotfish.observation_t;
import pilotfish.tag_detection_t;

/** The camera's picture with what was measured in that very picture: outlines and ids of the leader's tags. */
final class PicturePanel extends Card {
    private static final long serialVersionUID = 1L;
    private static final int CAPTION = 22;

    private final Subject subject;
    private Picture picture;
    private observation_t seen;
    private String refusal = "";
    private String silence = "";

    PicturePanel(Subject subject) {
        this.subject = subject;
        setPreferredSize(new Dimension(600, 470));
    }

    /** The newest picture that could be decoded. */
    void show(Picture picture) {
        this.picture = picture;
        refusal = "";
        repaint();
    }

    /** Why the newest could not be. */
    void refuse(String reason) {
        boolean same = reason.equals(refusal);
        refusal = reason;
        if (!same) repaint();
    }

    /** seen: what was measured in the picture that is shown, or null; silence: empty while pictures come. */
    void update(observation_t seen, String silence) {
        boolean same = this.seen == seen && this.silence.equals(silence);
        this.seen = seen;
        this.silence = silence;
        if (!same) repaint();
    }

    /** Of the picture that is shown [us]; 0: none. */
    long utime() {
        return picture == null ? 0 : picture.utime;
    }

    @Override
    protected void paint(Graphics2D g, int width, int height) {
        if (picture == null) {
            g.setColor(Palette.PAGE);
            g.fillRect(0, 0, width, height);
            String channels = subject.pictureChannels();
            String missing = channels.isEmpty() ? "no picture: " + subject.title() + " is no robot's channel"
                    : "no picture on " + channels;
            words(g, refusal.isEmpty() ? missing : "picture refused: " + refusal, width, height);
            return;
        }
        double fit = Math.min((double) width / picture.sourceWidth,
                (double) Math.max(height - CAPTION, 10) / picture.sourceHeight);
        double shownWidth = fit * picture.sourceWidth, shownHeight = fit * picture.sourceHeight;
        double left = (width - shownWidth) / 2;
        AffineTransform place = AffineTransform.getTranslateInstance(left, 0);
        place.scale(shownWidth / picture.image.getWidth(), shownHeight / picture.image.getHeight());
        g.drawImage(picture.image, place, null);
        Rectangle2D shown = new Rectangle2D.Double(left, 0, shownWidth, shownHeight);
        Graphics2D inside = (Graphics2D) g.create();
        inside.clip(shown);
        if (seen != null) for (tag_detection_t tag : seen.tags) draw(inside, tag, left, fit, shownHeight);
        inside.dispose();
        String wrong = refusal.isEmpty() ? silence.replace("message", "picture") : "picture refused: " + refusal;
        if (!wrong.isEmpty()) {
            g.setColor(new Color(238, 241, 245, 190));
            g.fill(shown);
            words(g, wrong, width, (int) shownHeight);
        }
        caption(g, width, (int) Math.round(shownHeight) + 16);
    }

    private static void words(Graphics2D g, String text, int width, int height) {
        g.setFont(Palette.font(Font.BOLD, 15));
        FontMetrics metrics = g.getFontMetrics();
        String shown = fitted(metrics, text, width - 10);
        g.setColor(Palette.MUTED);
        g.drawString(shown, (width - metrics.stringWidth(shown)) / 2, height / 2 + 5);
    }

    private void caption(Graphics2D g, int width, int y) {
        g.setFont(Palette.font(Font.PLAIN, 12));
        g.setColor(Palette.MUTED);
        FontMetrics metrics = g.getFontMetrics();
        String size = picture.sourceWidth + " \u00d7 " + picture.sourceHeight + " px";
        g.drawString(size, 0, y);
        if (seen == null) return;
        String text = seen.detected ? Words.number(seen.distance_m, 3) + " m" : seen.text;
        text = fitted(metrics, text, width - metrics.stringWidth(size) - 16);
        g.drawString(text, width - metrics.stringWidth(text), y);
    }

    /** (0, 0) is the centre of the top-left pixel, so its corner is half a pixel before it. */
    private static void draw(Graphics2D g, tag_detection_t tag, double left, double fit, double height) {
        Path2D outline = new Path2D.Double();
        Point2D centre = new Point2D.Double();
        double top = Double.POSITIVE_INFINITY, bottom = Double.NEGATIVE_INFINITY;
        for (int k = 0; k < 4; k++) {
            double x = left + (tag.corners_px[k][0] + 0.5) * fit, y = (tag.corners_px[k][1] + 0.5) * fit;
            if (!(Math.abs(x) < 1e5 && Math.abs(y) < 1e5)) return;  // also NaN
            if (k == 0) outline.moveTo(x, y);
            else outline.lineTo(x, y);
            centre.setLocation(centre.getX() + x / 4, 0);
            top = Math.min(top, y);
            bottom = Math.max(bottom, y);
        }
        outline.closePath();
        stroke(g, Palette.BEHIND_OUTLINE, 4.5f, outline);
        stroke(g, Palette.OUTLINE, 2f, outline);
        // Below the tag, or above it where the picture ends.
        label(g, Integer.toString(tag.id), centre.getX(), bottom + 20 < height ? bottom + 17 : top - 6);
    }

    private static void stroke(Graphics2D g, Color colour, float width, Shape shape) {
        g.setColor(colour);
        g.setStroke(new BasicStroke(width, BasicStroke.CAP_ROUND, BasicStroke.JOIN_ROUND));
        g.draw(shape);
    }

    private static void label(Graphics2D g, String text, double x, double y) {
        g.setFont(Palette.font(Font.BOLD, 14));
        float left = (float) (x - g.getFontMetrics().stringWidth(text) / 2.0);
        Shape letters = g.getFont().createGlyphVector(g.getFontRenderContext(), text).getOutline(left, (float) y);
        stroke(g, Palette.BEHIND_OUTLINE, 4f, letters);
        g.setColor(Palette.OUTLINE);
        g.fill(letters);
    }
}

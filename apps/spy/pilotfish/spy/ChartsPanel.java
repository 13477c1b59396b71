package pilotfish.spy;

import java.awt.BasicStroke;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Font;
import java.awt.FontMetrics;
import java.awt.Graphics2D;
import java.awt.geom.Line2D;
import java.awt.geom.Path2D;

/**
 * The strips of the last minute, one below the other on one axis of time. Drawn here and not by JChart2D, which lcm-spy
 * has on its class path: its axes cannot be shared, it joins the points on both sides of a gap, and its last release is
 * of 2011.
 */
final class ChartsPanel extends Card {
    private static final long serialVersionUID = 1L;
    private static final int TITLE = 18;
    private static final int AXIS = 18;
    private static final int NUMBERS = 48;
    private static final int SPAN_S = 60;
    private static final int GRID_S = 15;

    private final double[][] values = new double[Strip.values().length][0];
    private boolean old = true;

    ChartsPanel() {
        setPreferredSize(new Dimension(480, 600));
    }

    /** old: no statuses come any more, so that the newest values are none. */
    void show(RobotModel model, boolean old) {
        for (Strip strip : Strip.values()) values[strip.ordinal()] = model.samplesOf(strip);
        this.old = old;
        repaint();
    }

    @Override
    protected void paint(Graphics2D g, int width, int height) {
        double each = (height - AXIS) / (double) Strip.values().length;
        for (Strip strip : Strip.values()) {
            Graphics2D part = (Graphics2D) g.create();
            part.translate(0, strip.ordinal() * each);
            paint(part, strip, values[strip.ordinal()], width, each - 6);
            part.dispose();
        }
        g.setFont(Palette.font(Font.PLAIN, 11));
        g.setColor(Palette.MUTED);
        FontMetrics metrics = g.getFontMetrics();
        for (int ago = SPAN_S; ago >= 0; ago -= GRID_S) {
            String text = ago == 0 ? "now" : "\u2212" + ago + " s";
            double x = NUMBERS + (width - NUMBERS) * (1 - ago / (double) SPAN_S) - metrics.stringWidth(text) / 2.0;
            g.drawString(text, (float) Math.min(x, width - metrics.stringWidth(text)), height - 3);
        }
    }

    private void paint(Graphics2D g, Strip strip, double[] samples, int width, double height) {
        double newest = old || samples.length == 0 ? Double.NaN : samples[samples.length - 1];
        String value = (strip.signed ? Words.signed(newest, strip.digits) : Words.number(newest, strip.digits))
                + (strip.unit.equals("\u00b0") ? "" : " ") + strip.unit;
        g.setFont(Palette.font(Font.BOLD, 12));
        g.setColor(Palette.TEXT);
        int used = g.getFontMetrics().stringWidth(value);
        g.drawString(value, width - used, 12);
        g.setFont(Palette.font(Font.PLAIN, 12));
        g.setColor(Palette.MUTED);
        g.drawString(fitted(g.getFontMetrics(), strip.title, width - used - 8), 0, 12);
        if (height < TITLE + 10) return;
        AxisRange range = AxisRange.of(strip, samples);
        grid(g, range, width, height);
        g.setColor(colourOf(strip));
        g.setStroke(new BasicStroke(1.6f, BasicStroke.CAP_ROUND, BasicStroke.JOIN_ROUND));
        g.draw(curve(samples, range, width, height));
    }

    private static void grid(Graphics2D g, AxisRange range, int width, double height) {
        g.setStroke(new BasicStroke(1f));
        g.setColor(Palette.GRID);
        for (int ago = 0; ago <= SPAN_S; ago += GRID_S) {
            double x = NUMBERS + (width - NUMBERS) * (1 - ago / (double) SPAN_S);
            g.draw(new Line2D.Double(x, TITLE, x, height));
        }
        g.setFont(Palette.font(Font.PLAIN, 11));
        FontMetrics metrics = g.getFontMetrics();
        boolean both = range.low < -0.5 * range.high && range.high > -0.5 * range.low;
        boolean below = range.high < -range.low;
        double[] marks = both ? new double[] {range.low, 0, range.high}
                : below ? new double[] {range.low, range.low / 2, 0} : new double[] {0, range.high / 2, range.high};
        for (double mark : marks) {
            double y = yOf(mark, range, height);
            g.setColor(mark == 0 ? Palette.EDGE : Palette.GRID);
            g.draw(new Line2D.Double(NUMBERS, y, width, y));
            if (height - TITLE < 34 && mark != marks[0] && mark != marks[2]) continue;  // no room for three
            g.setColor(Palette.MUTED);
            String text = axisNumber(mark);
            double baseline = Math.min(Math.max(y + 4, TITLE + 7), height + 1);
            g.drawString(text, NUMBERS - 6 - metrics.stringWidth(text), (float) baseline);
        }
    }

    /** Interrupted where nothing is known. A value between two gaps is a point. */
    private static Path2D curve(double[] samples, AxisRange range, int width, double height) {
        Path2D path = new Path2D.Double();
        boolean drawing = false;
        for (int k = 0; k < samples.length; k++) {
            if (!Double.isFinite(samples[k])) {
                drawing = false;
                continue;
            }
            double x = NUMBERS + (width - NUMBERS) * (k + 1.0) / samples.length;
            double y = yOf(samples[k], range, height);
            if (!drawing) path.moveTo(x, y);
            path.lineTo(x, y);
            drawing = true;
        }
        return path;
    }

    private static double yOf(double value, AxisRange range, double height) {
        return TITLE + (height - TITLE) * (range.high - value) / (range.high - range.low);
    }

    private static Color colourOf(Strip strip) {
        switch (strip) {
            case DISTANCE_ERROR:
            case SPEED: return Palette.BLUE;
            case LATENCY: return Palette.GREEN;
            default: return Palette.ORANGE;
        }
    }

    /** As few digits as it has: 0.05, 7.5, 1500. */
    private static String axisNumber(double value) {
        String text = String.format(java.util.Locale.ROOT, "%.4f", Math.abs(value)).replaceAll("\\.?0+$", "");
        return (value < 0 ? "\u2212" : "") + text;
    }
}

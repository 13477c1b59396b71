package pilotfish.spy;

import java.awt.Color;
import java.awt.Dimension;
import java.awt.Font;
import java.awt.FontMetrics;
import java.awt.Graphics2D;
import java.awt.geom.RoundRectangle2D;
import pilotfish.observation_t;
import pilotfish.status_t;

/** What the coordinator does and why, in its own words. */
final class HeaderPanel extends Card {
    private static final long serialVersionUID = 1L;
    private static final int FIELD = 40;
    private static final int NUMBERS = 26;

    private final Subject subject;
    private status_t status;
    private observation_t seen;
    private String silence = Words.silence(Long.MAX_VALUE);
    private String note = "";
    private boolean said;

    HeaderPanel(Subject subject) {
        this.subject = subject;
        setPreferredSize(new Dimension(600, 2 * MARGIN + FIELD + (subject.isPictureOnly() ? 0 : NUMBERS)));
    }

    /** silence: empty while statuses come; note: what else is wrong, or empty. */
    void show(status_t status, observation_t seen, String silence, String note) {
        boolean same = said && this.status == status && this.seen == seen && this.silence.equals(silence)
                && this.note.equals(note);
        this.status = status;
        this.seen = seen;
        this.silence = silence;
        this.note = note;
        said = true;
        if (same) return;
        say(headline() + "; " + reason() + "; " + numbers() + "; " + note);
        repaint();
    }

    private String numbers() {
        return status == null ? "" : Words.measured(status, seen);
    }

    /** "lost", "no message for 3 s". */
    private String headline() {
        if (subject.isPictureOnly()) return subject.title();
        return silence.isEmpty() ? Words.headline(status) : silence;
    }

    private String reason() {
        if (subject.isPictureOnly()) return note.isEmpty() ? "a camera's channel, without a coordinator" : note;
        if (status == null) return "nothing has come on " + subject.channelOf(Kind.STATUS);
        if (!silence.isEmpty()) return "the last: " + status.text;
        return Words.reason(status);
    }

    @Override
    protected void paint(Graphics2D g, int width, int height) {
        Words.Tone tone = subject.isPictureOnly() || !silence.isEmpty() ? Words.Tone.OLD : Words.toneOf(status.status);
        g.setColor(Palette.background(tone));
        g.fill(new RoundRectangle2D.Double(0, 0, width, FIELD, 8, 8));
        g.setFont(Palette.font(Font.BOLD, 19));
        g.setColor(tone == Words.Tone.OLD && !subject.isPictureOnly() ? Palette.RED : Palette.TEXT);
        String headline = fitted(g.getFontMetrics(), headline(), width - 20);
        g.drawString(headline, 10, 27);
        int used = 10 + g.getFontMetrics().stringWidth(headline) + 14;
        g.setFont(Palette.font(Font.PLAIN, 14));
        g.setColor(Palette.TEXT);
        g.drawString(fitted(g.getFontMetrics(), reason(), width - used - 8), used, 26);
        if (!subject.isPictureOnly()) line(g, numbers(), silence.isEmpty() ? Palette.TEXT : Palette.FAINT, width);
    }

    /** The second line: numbers at the left, what is wrong at the right. */
    private void line(Graphics2D g, String numbers, Color colour, int width) {
        g.setFont(Palette.font(Font.PLAIN, 13));
        FontMetrics metrics = g.getFontMetrics();
        g.setColor(Palette.RED);
        String shown = fitted(metrics, note, width - 10);
        g.drawString(shown, width - 10 - metrics.stringWidth(shown), FIELD + 20);
        g.setColor(colour);
        int left = width - 20 - (shown.isEmpty() ? 0 : metrics.stringWidth(shown) + 16);
        g.drawString(fitted(metrics, numbers, left), 10, FIELD + 20);
    }
}

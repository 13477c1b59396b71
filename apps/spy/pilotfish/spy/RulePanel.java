package pilotfish.spy;

import java.awt.Dimension;
import java.awt.Font;
import java.awt.FontMetrics;
import java.awt.Graphics2D;
import java.awt.event.MouseEvent;
import java.util.Arrays;

/** The 8 x 7 rules of the fuzzy law; the stronger a rule fires, the more orange its cell. */
final class RulePanel extends Card {
    private static final long serialVersionUID = 1L;
    private static final int TITLE = 24;
    private static final double READABLE_PX = 11;  // height of a cell, below which its word is left out

    private final RuleTable table;
    private float[] strengths = new float[RuleTable.ROWS * RuleTable.COLUMNS];
    private boolean old = true;
    private boolean words;
    private Font plain;
    private Font bold;

    RulePanel(RuleTable table) {
        this.table = table;
        setPreferredSize(new Dimension(600, 260));
        setToolTipText("");  // registers this component; getToolTipText(event) gives the text
    }

    /** Row by row. old: no statuses come any more. */
    void show(float[] strengths, boolean old) {
        boolean same = this.old == old && Arrays.equals(this.strengths, strengths);
        this.strengths = strengths;
        this.old = old;
        if (!same) repaint();
    }

    @Override
    protected void paint(Graphics2D g, int width, int height) {
        g.setColor(Palette.TEXT);
        g.setFont(Palette.font(Font.BOLD, 13));
        g.drawString("fuzzy rules", 0, 13);
        int used = g.getFontMetrics().stringWidth("fuzzy rules") + 10;
        g.setFont(Palette.font(Font.PLAIN, 12));
        g.setColor(Palette.MUTED);
        String subtitle = "if E is the row and EC the column, then U is the cell; orange: firing strength";
        g.drawString(fitted(g.getFontMetrics(), subtitle, width - used), used, 13);
        double cellWidth = width / (RuleTable.COLUMNS + 1.0), cellHeight = (height - TITLE) / (RuleTable.ROWS + 1.0);
        words = cellHeight >= READABLE_PX;
        plain = Palette.font(Font.PLAIN, (float) Math.min(13, cellHeight * 0.65));
        bold = plain.deriveFont(Font.BOLD);
        for (int row = -1; row < RuleTable.ROWS; row++) {
            for (int column = -1; column < RuleTable.COLUMNS; column++) {
                double x = (column + 1) * cellWidth, y = TITLE + (row + 1) * cellHeight;
                if (row >= 0 && column >= 0) cell(g, row, column, x, y, cellWidth, cellHeight);
                else head(g, row, column, x, y, cellWidth, cellHeight);
            }
        }
    }

    private void head(Graphics2D g, int row, int column, double x, double y, double width, double height) {
        String text = row < 0 && column < 0 ? "E \\ EC"
                : table.rows.isEmpty() ? "" : row < 0 ? table.columns.get(column) : table.rows.get(row);
        g.setColor(Palette.MUTED);
        g.setFont(plain);
        centred(g, text, x, y, width, height);
    }

    private void cell(Graphics2D g, int row, int column, double x, double y, double width, double height) {
        double strength = old ? 0 : strengths[row * RuleTable.COLUMNS + column];
        // Whole pixels, so that neighbouring cells share an edge.
        int left = (int) Math.round(x), top = (int) Math.round(y);
        int right = (int) Math.round(x + width), bottom = (int) Math.round(y + height);
        g.setColor(Palette.EDGE);
        g.fillRect(left, top, right - left + 1, bottom - top + 1);
        g.setColor(Palette.lit(strength));
        g.fillRect(left + 1, top + 1, right - left - 1, bottom - top - 1);
        // White is the more readable one on the full orange only.
        g.setColor(old ? Palette.FAINT : strength > 0.9 ? Palette.CARD : strength > 0 ? Palette.TEXT : Palette.MUTED);
        g.setFont(strength > 0.05 ? bold : plain);
        centred(g, table.cell(row, column), x, y, width, height);
    }

    private void centred(Graphics2D g, String text, double x, double y, double width, double height) {
        if (!words) return;
        FontMetrics metrics = g.getFontMetrics();
        double baseline = y + (height + metrics.getAscent() - metrics.getDescent()) / 2;
        g.drawString(text, (float) (x + (width - metrics.stringWidth(text)) / 2), (float) baseline);
    }

    @Override
    public String getToolTipText(MouseEvent event) {
        double cellWidth = (getWidth() - 2.0 * MARGIN) / (RuleTable.COLUMNS + 1);
        double cellHeight = (getHeight() - 2.0 * MARGIN - TITLE) / (RuleTable.ROWS + 1);
        int column = (int) Math.floor((event.getX() - MARGIN) / cellWidth) - 1;
        int row = (int) Math.floor((event.getY() - MARGIN - TITLE) / cellHeight) - 1;
        boolean inside = column >= 0 && column < RuleTable.COLUMNS && row >= 0 && row < RuleTable.ROWS;
        if (!inside || table.rows.isEmpty()) return null;
        return "if E is " + table.rows.get(row) + " and EC is " + table.columns.get(column) + ", then U is "
                + table.cell(row, column) + ": fires with "
                + Words.number(strengths[row * RuleTable.COLUMNS + column], 3);
    }
}

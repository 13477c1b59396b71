package pilotfish.spy;

import java.awt.Component;
import java.awt.Container;
import java.awt.Dimension;
import java.awt.LayoutManager;
import java.util.ArrayList;
import java.util.List;

/**
 * The header above; below it, in a wide window, picture and rules at the left and the curves at the right; in a
 * narrow one, all below each other. Components stand in the order header, picture, rules, charts; a camera has the
 * first two only.
 */
final class WindowLayout implements LayoutManager {
    private static final int GAP = 8;
    private static final double WIDE = 1.05;

    @Override
    public void layoutContainer(Container parent) {
        List<Component> all = new ArrayList<>(List.of(parent.getComponents()));
        int width = parent.getWidth() - 2 * GAP, height = parent.getHeight() - 2 * GAP;
        int head = all.get(0).getPreferredSize().height;
        all.get(0).setBounds(GAP, GAP, width, head);
        int top = GAP + head + GAP;
        int rest = height - head - GAP;
        if (all.size() == 2) {
            all.get(1).setBounds(GAP, top, width, rest);
        } else if (parent.getWidth() > WIDE * parent.getHeight()) {
            int left = (int) (0.55 * (width - GAP));
            column(GAP, top, left, rest, new double[] {0.64, 0.36}, all.subList(1, 3));
            all.get(3).setBounds(GAP + left + GAP, top, width - left - GAP, rest);
        } else {
            column(GAP, top, width, rest, new double[] {0.42, 0.22, 0.36}, all.subList(1, 4));
        }
    }

    private static void column(int x, int y, int width, int height, double[] shares, List<Component> parts) {
        int room = height - GAP * (parts.size() - 1);
        for (int k = 0; k < parts.size(); k++) {
            int each = (int) Math.round(shares[k] * room);
            parts.get(k).setBounds(x, y, width, each);
            y += each + GAP;
        }
    }

    @Override
    public Dimension preferredLayoutSize(Container parent) {
        return new Dimension(1100, 780);
    }

    @Override
    public Dimension minimumLayoutSize(Container parent) {
        return new Dimension(480, 480);
    }

    @Override
    public void addLayoutComponent(String name, Component part) {}

    @Override
    public void removeLayoutComponent(Component part) {}
}

package pilotfish.spy;

import javax.swing.JPanel;
import pilotfish.observation_t;
import pilotfish.status_t;

/** All that a window shows, drawn from a model. Used by Swing's event thread only. */
final class RobotPanel extends JPanel {
    private static final long serialVersionUID = 1L;

    private final HeaderPanel header;
    private final PicturePanel picture;
    private final RulePanel rules = new RulePanel(RuleTable.shipped());
    private final ChartsPanel charts = new ChartsPanel();

    RobotPanel(Subject subject) {
        super(new WindowLayout());
        setBackground(Palette.PAGE);
        header = new HeaderPanel(subject);
        picture = new PicturePanel(subject);
        add(header);
        add(picture);
        if (subject.isPictureOnly()) return;
        add(rules);
        add(charts);
    }

    void show(Picture decoded) {
        picture.show(decoded);
    }

    void refusePicture(String reason) {
        picture.refuse(reason);
    }

    /** busProblem: why nothing can be received, or empty. */
    void update(RobotModel model, String busProblem, long nowNs) {
        long ageNs = model.ageNs(Kind.STATUS, nowNs);
        status_t status = model.status();  // after its age: where there is an age there is a status
        boolean old = ageNs > RobotModel.FRESH_NS;
        String note = busProblem.isEmpty() ? Words.unreadable(model.unreadable()) : busProblem;
        observation_t seen = model.ageNs(Kind.OBSERVATION, nowNs) < RobotModel.FRESH_NS ? model.observation() : null;
        header.show(status, seen, Words.silence(ageNs), note);
        picture.update(model.observationIn(picture.utime()), Words.silence(model.pictureAgeNs(nowNs)));
        if (status != null) rules.show(status.strengths, old);
        if (model.sample(nowNs)) charts.show(model, old);
    }
}

package pilotfish.spy;

import java.awt.image.BufferedImage;
import java.io.BufferedReader;
import java.io.File;
import java.io.IOException;
import java.io.InputStreamReader;
import java.nio.charset.StandardCharsets;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.Arrays;
import java.util.stream.Collectors;
import javax.imageio.ImageIO;

/**
 * The parts of the plug-in, for tests in another language: each line of standard input is a question, and is answered
 * by a line. Words of a question are separated by tabs.
 */
public final class Probe {
    private static final long MS = 1_000_000L;

    private RobotModel model = new RobotModel();
    private RobotPanel panel;

    private Probe() {}

    public static void main(String[] arguments) throws IOException {
        Probe probe = new Probe();
        BufferedReader in = new BufferedReader(new InputStreamReader(System.in, StandardCharsets.UTF_8));
        for (String line = in.readLine(); line != null; line = in.readLine()) {
            String answer;
            try {
                answer = probe.answer(line.split("\t", -1));
            } catch (Throwable problem) {
                answer = "threw " + problem;
            }
            System.out.write((answer + "\n").getBytes(StandardCharsets.UTF_8));
            System.out.flush();
        }
    }

    private String answer(String[] words) throws IOException {
        switch (words[0]) {
            case "decode": return decode(Files.readAllBytes(Path.of(words[1])), words[2]);
            case "url": return SpyUrl.of(words[1]);
            case "subject": return subject(Subject.of(words[1], words[2].equals("image")));
            case "rules": return rules(new RuleTable(Files.readAllLines(Path.of(words[1]))));
            case "shipped": return rules(RuleTable.shipped());
            case "axis": return axis(Strip.valueOf(words[1]), words);
            case "number": return Words.number(Double.parseDouble(words[1]), Integer.parseInt(words[2]));
            case "new": return start(Subject.of(words[1], words[2].equals("image")));
            case "take": return take(Kind.valueOf(words[1]), Files.readAllBytes(Path.of(words[2])), words[3]);
            case "picture": return picture(Long.parseLong(words[1]) * MS);
            case "sample": return sample(Long.parseLong(words[1]) * MS);
            case "strip": return Arrays.toString(model.samplesOf(Strip.valueOf(words[1])));
            case "sizes": return Arrays.toString(model.sizes());
            case "words": return said(Long.parseLong(words[1]) * MS);
            case "paint": return paint(Integer.parseInt(words[1]), Integer.parseInt(words[2]), words[3]);
            default: return "unknown question";
        }
    }

    private static String decode(byte[] message, String out) throws IOException {
        try {
            Picture picture = PictureDecoder.decode(message);
            ImageIO.write(picture.image, "png", new File(out));
            return picture.utime + " " + picture.sourceWidth + " " + picture.sourceHeight;
        } catch (RefusedPicture refused) {
            return "refused: " + refused.getMessage();
        }
    }

    private static String subject(Subject subject) {
        return subject.title() + " " + subject.channels().replace("\\Q", "").replace("\\E", "");
    }

    private static String rules(RuleTable table) {
        StringBuilder text = new StringBuilder(String.join(" ", table.columns));
        for (int row = 0; row < table.rows.size(); row++) {
            text.append('|').append(table.rows.get(row));
            for (int column = 0; column < RuleTable.COLUMNS; column++) text.append(' ').append(table.cell(row, column));
        }
        return text.toString();
    }

    private static String axis(Strip strip, String[] words) {
        double[] values = Arrays.stream(words).skip(2).mapToDouble(Double::parseDouble).toArray();
        AxisRange range = AxisRange.of(strip, values);
        return range.low + " " + range.high;
    }

    private String start(Subject subject) {
        model = new RobotModel();
        panel = new RobotPanel(subject);
        return "ok";
    }

    private String take(Kind kind, byte[] message, String nowMs) {
        model.take(kind, message, Long.parseLong(nowMs) * MS);
        return model.unreadable().toString();
    }

    /** The exposure of the picture that is shown then, or none. */
    private String picture(long nowNs) {
        byte[] message = model.nextPicture(nowNs);
        if (message == null) return "none";
        try {
            panel.show(PictureDecoder.decode(message));
        } catch (RefusedPicture refused) {
            panel.refusePicture(refused.getMessage());
        }
        return Long.toString(PictureDecoder.utimeOf(message));
    }

    /** The newest value of each strip. */
    private String sample(long nowNs) {
        boolean taken = model.sample(nowNs);
        return taken + " " + Arrays.stream(Strip.values())
                .map(strip -> Double.toString(model.samplesOf(strip)[Samples.COUNT - 1]))
                .collect(Collectors.joining(" "));
    }

    /** What the header says. */
    private String said(long nowNs) {
        panel.update(model, "", nowNs);
        return panel.getComponent(0).getAccessibleContext().getAccessibleName();
    }

    private String paint(int width, int height, String file) throws IOException {
        panel.setSize(width, height);
        panel.doLayout();
        BufferedImage image = new BufferedImage(width, height, BufferedImage.TYPE_INT_RGB);
        panel.paint(image.getGraphics());
        ImageIO.write(image, "png", new File(file));
        return "ok";
    }
}

package pilotfish.spy;

import java.io.BufferedReader;
import java.io.IOException;
import java.io.InputStream;
import java.io.InputStreamReader;
import java.nio.charset.StandardCharsets;
import java.util.ArrayList;
import java.util.List;
import java.util.regex.Matcher;
import java.util.regex.Pattern;
import java.util.stream.Collectors;

/**
 * The words of the fuzzy rules: IF E is a row AND EC is a column THEN U is the cell. They are in the jar as the file
 * they come from, data/fuzzy/coordination.yaml; a status has the strengths of the rules in the same order, row by
 * row.
 */
final class RuleTable {
    static final int ROWS = 8;
    static final int COLUMNS = 7;

    /** A line of its section `rules`: `  NB: [PB, PB, PB, PB, PM, PM, PM]`. */
    private static final Pattern LINE = Pattern.compile("\\s+(\\w+):\\s*\\[([^\\]]*)\\].*");

    final List<String> rows = new ArrayList<>();
    List<String> columns = List.of();
    private final List<List<String>> cells = new ArrayList<>();

    /** The rules of a file; without words, if it has no table of ROWS x COLUMNS. */
    RuleTable(List<String> lines) {
        boolean inside = false;
        for (String line : lines) {
            if (!line.isEmpty() && !Character.isWhitespace(line.charAt(0))) inside = line.startsWith("rules:");
            Matcher match = LINE.matcher(line);
            if (!inside || !match.matches()) continue;
            List<String> words = List.of(match.group(2).trim().split("\\s*,\\s*"));
            if (match.group(1).equals("columns")) {
                columns = words;
            } else {
                rows.add(match.group(1));
                cells.add(words);
            }
        }
        if (rows.size() != ROWS || columns.size() != COLUMNS || cells.stream().anyMatch(row -> row.size() != COLUMNS)) {
            rows.clear();
            columns = List.of();
            cells.clear();
        }
    }

    static RuleTable shipped() {
        try (InputStream file = RuleTable.class.getResourceAsStream("coordination.yaml")) {
            if (file == null) return new RuleTable(List.of());
            return new RuleTable(new BufferedReader(new InputStreamReader(file, StandardCharsets.UTF_8)).lines()
                    .collect(Collectors.toList()));
        } catch (IOException unreadable) {
            return new RuleTable(List.of());
        }
    }

    /** What the rule says U is; empty if it is not known. */
    String cell(int row, int column) {
        return cells.isEmpty() ? "" : cells.get(row).get(column);
    }
}

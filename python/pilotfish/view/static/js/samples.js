// The last minute in columns, as the server's samples.py names them.

export const COLUMNS = [
  "time_s", "distance_error_mm", "bearing_error_deg", "linear_mps", "angular_radps", "latency_ms",
  "x_m", "y_m", "heading_rad", "leader_x_m", "leader_y_m", "range_m",
];
export const SPAN_S = 60;

export class Samples {
  constructor() {
    this.clear();
  }

  clear() {
    for (const name of COLUMNS) this[name] = [];
  }

  add(rows) {
    for (const row of rows) COLUMNS.forEach((name, k) => this[name].push(row[k]));
    const last = this.time_s[this.time_s.length - 1];
    const old = this.time_s.findIndex((time) => last - time <= SPAN_S + 1);
    if (old > 0) for (const name of COLUMNS) this[name].splice(0, old);
  }

  last(name) {
    const column = this[name];
    return column.length ? column[column.length - 1] : null;
  }
}

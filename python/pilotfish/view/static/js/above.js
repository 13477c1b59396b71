// View from above, in the robot's own frame: x forward is up, y left is left. The robot's path is dead reckoning from its
// twists; the leader's is where it was seen from there.

import { colour, prepared } from "./format.js";

const MARGIN = 26;
const STEPS_M = [0.25, 0.5, 1, 2, 5, 10, 20, 50];

export class Above {
  constructor(samples) {
    this.samples = samples;
    this.canvas = document.getElementById("above");
    this.pixelsPerMetre = null;
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  update(observation, wanted) {
    this.observation = observation;
    this.wanted = wanted;
    this.draw();
  }

  draw() {
    if (!this.canvas.clientWidth || document.hidden) return;
    const { context, width, height } = prepared(this.canvas);
    const { robot, leader } = this.paths();
    const now = this.observation?.detected ? polar(this.observation.distance_m, this.observation.bearing_rad) : null;
    const wanted = this.wanted ? polar(...this.wanted) : null;
    const points = [[0, 0], ...robot, ...leader, now, wanted].filter(Boolean);
    const view = this.fit(points, width, height);
    grid(context, view, width, height);
    trail(context, robot.map(view.at), colour("blue"));
    trail(context, leader.map(view.at), colour("orange"));
    if (wanted) ring(context, view.at(wanted), colour("green"));
    if (now) disc(context, view.at(now), colour("orange"));
    arrow(context, view.at([0, 0]), colour("blue"));
  }

  paths() {
    const s = this.samples;
    const last = s.x_m.findLastIndex((x) => x !== null);
    const robot = [], leader = [];
    if (last < 0) return { robot, leader };
    const [x0, y0, psi] = [s.x_m[last], s.y_m[last], s.heading_rad[last]];
    const [c, n] = [Math.cos(psi), Math.sin(psi)];
    const relative = (x, y) => (x === null ? null : [c * (x - x0) + n * (y - y0), -n * (x - x0) + c * (y - y0)]);
    for (let k = 0; k < s.x_m.length; k++) {
      robot.push(relative(s.x_m[k], s.y_m[k]));
      leader.push(relative(s.leader_x_m[k], s.leader_y_m[k]));
    }
    return { robot: robot.map((p) => p ?? null), leader };
  }

  // A scale that holds all points; it changes by whole steps, so that the picture does not breathe.
  fit(points, width, height) {
    const xs = points.map((p) => p[0]), ys = points.map((p) => p[1]);
    const [back, front, right, left] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
    const need = Math.min((height - 2 * MARGIN) / Math.max(front - back, 0.8), (width - 2 * MARGIN) / Math.max(left - right, 0.8));
    const stepped = 2 ** (Math.floor(Math.log2(need) * 4) / 4);
    if (this.pixelsPerMetre === null || stepped < this.pixelsPerMetre || stepped > this.pixelsPerMetre * 1.5) this.pixelsPerMetre = stepped;
    const scale = this.pixelsPerMetre;
    const middle = [(back + front) / 2, (left + right) / 2];
    return { scale, at: (p) => p && [width / 2 - (p[1] - middle[1]) * scale, height / 2 - (p[0] - middle[0]) * scale], middle };
  }
}

const polar = (distance, bearing) => (Number.isFinite(distance) && Number.isFinite(bearing) ? [distance * Math.cos(bearing), distance * Math.sin(bearing)] : null);

function grid(context, view, width, height) {
  const step = STEPS_M.find((metres) => metres * view.scale >= 46) ?? 100;
  context.lineWidth = 1;
  context.strokeStyle = colour("grid");
  const labels = [];
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "left";
  context.textBaseline = "bottom";
  const halfX = height / 2 / view.scale, halfY = width / 2 / view.scale;
  for (let x = Math.ceil((view.middle[0] - halfX) / step) * step; x <= view.middle[0] + halfX; x += step) {
    const y = Math.round(view.at([x, 0])[1]) + 0.5;
    line(context, 0, y, width, y);
    if (y > 16) labels.push([`${Number(x.toFixed(2))} m`.replace("-", "\u2212"), y - 2]);
  }
  for (let left = Math.ceil((view.middle[1] - halfY) / step) * step; left <= view.middle[1] + halfY; left += step) {
    const x = Math.round(view.at([0, left])[0]) + 0.5;
    line(context, x, 0, x, height);
  }
  for (const [text, y] of labels) { // on a ground of their own: no line runs through a number
    context.fillStyle = colour("field");
    context.fillRect(1, y - 13, context.measureText(text).width + 7, 13);
    context.fillStyle = colour("muted");
    context.fillText(text, 4, y);
  }
}

function line(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

function trail(context, points, style) {
  context.strokeStyle = style;
  context.lineWidth = 2;
  context.lineJoin = "round";
  context.beginPath();
  let pen = false;
  for (const point of points) {
    if (point) context[pen ? "lineTo" : "moveTo"](...point);
    pen = Boolean(point);
  }
  context.stroke();
}

function disc(context, [x, y], style) {
  context.fillStyle = style;
  context.beginPath();
  context.arc(x, y, 7, 0, 2 * Math.PI);
  context.fill();
}

function ring(context, [x, y], style) {
  context.strokeStyle = style;
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(x, y, 10, 0, 2 * Math.PI);
  context.stroke();
}

function arrow(context, [x, y], style) {
  context.fillStyle = style;
  context.beginPath();
  context.moveTo(x, y - 13);
  context.lineTo(x + 9, y + 9);
  context.lineTo(x, y + 4);
  context.lineTo(x - 9, y + 9);
  context.fill();
}

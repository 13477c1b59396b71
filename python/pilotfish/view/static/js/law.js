// The rule table, lit by firing strengths, beside the surface u(e, ec) with the present point. Both have E from top to
// bottom and EC from left to right.

import { colour, number, prepared, setText, signed } from "./format.js";

const TRAIL = 20;

export class Law {
  constructor() {
    this.table = document.getElementById("rules");
    this.canvas = document.getElementById("surface");
    this.point = document.getElementById("law-point");
    this.trail = [];
    new ResizeObserver(() => this.drawSurface()).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.drawSurface());
  }

  async load() {
    const response = await fetch("/api/law");
    if (!response.ok) return;
    this.law = await response.json();
    setText(document.getElementById("law-name"), this.law.configured ? this.law.name : `${this.law.name}, as shipped (--config or --fuzzy: yours)`);
    this.buildTable();
    this.picture = surfacePicture(this.law);
    this.drawSurface();
  }

  buildTable() {
    const { rows, columns, cells } = this.law;
    const head = document.createElement("tr");
    head.append(...["E \\ EC", ...columns].map((text) => cell("th", text)));
    this.cells = [];
    const body = rows.map((row, r) => {
      const line = document.createElement("tr");
      line.append(cell("th", row));
      columns.forEach((column, c) => {
        const one = cell("td", cells[r][c]);
        one.dataset.rule = `${row} ${column}`;
        this.cells.push(one);
        line.append(one);
      });
      return line;
    });
    this.table.replaceChildren(head, ...body);
  }

  update(status) {
    if (!this.law) return;
    const strengths = status?.strengths ?? [];
    const most = Math.max(0, ...strengths.filter(Number.isFinite).map((strength) => Number(strength.toFixed(2))));
    this.cells.forEach((one, k) => {
      const shown = (strengths[k] ?? 0).toFixed(2);
      const strength = Number(shown); // what is less than 0.005 does not fire: bold with "0.00" on it says nothing
      if (one.dataset.strength === shown && one.hasAttribute("data-strongest") === (most > 0 && strength === most)) return;
      one.dataset.strength = shown;
      one.style.backgroundColor = strength > 0 ? `rgba(var(--hot), ${0.12 + 0.7 * Math.min(strength, 1)})` : "";
      one.toggleAttribute("data-fires", strength > 0);
      one.toggleAttribute("data-strongest", most > 0 && strength === most);
      one.title = `IF E is ${one.dataset.rule.split(" ")[0]} AND EC is ${one.dataset.rule.split(" ")[1]} THEN U is ${one.textContent}: fires at ${shown}`;
    });
    const here = most > 0 ? [status.error_m / this.law.error_scale_m, status.error_change_m / this.law.error_change_scale_m] : null;
    if (here) this.trail.push(here);
    if (!here) this.trail.length = 0;
    if (this.trail.length > TRAIL) this.trail.shift();
    setText(this.point, here
      ? `e ${signed(status.error_m, 3)} m, ec ${signed(status.error_change_m * 1e3, 1)} mm → u ${signed(status.output, 3)} = ${signed(status.output * this.law.velocity_scale_mps, 3)} m/s`
      : "no rule fires");
    this.drawSurface();
  }

  drawSurface() {
    if (!this.picture || !this.canvas.clientWidth || document.hidden) return;
    const { context, width, height } = prepared(this.canvas);
    const [left, top, right, bottom] = [44, 6, width - 62, height - 34];
    const { e_range, ec_range, u_range, error_scale_m, error_change_scale_m } = this.law;
    const x = (ec) => left + ((clamp(ec, ec_range) - ec_range[0]) / (ec_range[1] - ec_range[0])) * (right - left);
    const y = (e) => top + ((clamp(e, e_range) - e_range[0]) / (e_range[1] - e_range[0])) * (bottom - top);
    context.imageSmoothingEnabled = true;
    context.drawImage(this.picture, left, top, right - left, bottom - top);
    context.strokeStyle = colour("faint");
    context.strokeRect(left + 0.5, top + 0.5, right - left - 1, bottom - top - 1);
    context.fillStyle = colour("muted");
    context.font = "11px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "top";
    for (const ec of [ec_range[0], 0, ec_range[1]]) context.fillText(signed(ec * error_change_scale_m * 1e3, 0), x(ec), bottom + 4);
    context.fillText("ec [mm per period]", (left + right) / 2, bottom + 19);
    context.textAlign = "right";
    context.textBaseline = "middle";
    for (const e of [e_range[0], 0, e_range[1]]) context.fillText(signed(e * error_scale_m, 1), left - 5, Math.max(y(e), top + 6));
    context.save();
    context.translate(9, (top + bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = "center";
    context.fillText("e [m]", 0, 0);
    context.restore();
    legend(context, right + 12, top, bottom - top, u_range);
    if (!this.trail.length) return;
    context.strokeStyle = "rgb(0 0 0 / .55)";
    context.lineWidth = 1.5;
    context.beginPath();
    this.trail.forEach(([e, ec], k) => context[k ? "lineTo" : "moveTo"](x(ec), y(e)));
    context.stroke();
    const [e, ec] = this.trail[this.trail.length - 1];
    context.beginPath();
    context.arc(x(ec), y(e), 6, 0, 2 * Math.PI);
    context.fillStyle = "#fff";
    context.fill();
    context.lineWidth = 3;
    context.strokeStyle = "#111";
    context.stroke();
  }
}

const clamp = (value, [low, high]) => Math.min(Math.max(value, low), high);

function cell(kind, text) {
  const element = document.createElement(kind);
  element.textContent = text;
  return element;
}

// Blue: backwards, white: stand still, orange: forwards.
function tone(share) {
  const ends = share < 0 ? [38, 104, 178] : [214, 104, 10];
  const weight = Math.min(Math.abs(share), 1) ** 0.8;
  return ends.map((end) => Math.round(245 + (end - 245) * weight));
}

function surfacePicture({ surface, u_range }) {
  const most = Math.max(Math.abs(u_range[0]), Math.abs(u_range[1])) || 1;
  const canvas = document.createElement("canvas");
  canvas.width = surface[0].length;
  canvas.height = surface.length;
  const context = canvas.getContext("2d");
  const image = context.createImageData(canvas.width, canvas.height);
  surface.flat().forEach((u, k) => image.data.set([...tone(u / most), 255], 4 * k));
  context.putImageData(image, 0, 0);
  return canvas;
}

function legend(context, x, y, height, [low, high]) {
  for (let k = 0; k < height; k++) {
    context.fillStyle = `rgb(${tone(1 - (2 * k) / height)})`;
    context.fillRect(x, y + k, 12, 1.5);
  }
  context.fillStyle = colour("muted");
  context.textAlign = "left";
  context.textBaseline = "middle";
  [["u " + signed(high, 0), 6], ["0", height / 2], [signed(low, 0), height - 6]].forEach(([text, at]) => context.fillText(text, x + 16, y + at));
}

// Strip charts of the last minute, by uPlot. They share the time axis; each has its newest value in its title.

import { MINUS, colour, number, setText, signed } from "./format.js";
import { SPAN_S } from "./samples.js";

const STRIPS = [
  { column: "distance_error_mm", title: "distance error, wanted − measured", unit: "mm", digits: 0, least: 50, hue: "blue", show: signed },
  { column: "bearing_error_deg", title: "bearing error, measured − wanted", unit: "°", digits: 2, least: 2, hue: "orange", show: signed },
  { column: "linear_mps", title: "command: speed v", unit: "m/s", digits: 3, least: 0.1, hue: "blue", show: signed },
  { column: "angular_radps", title: "command: turn rate ω", unit: "rad/s", digits: 3, least: 0.2, hue: "orange", show: signed },
  { column: "latency_ms", title: "latency, picture to command", unit: "ms", digits: 1, least: 20, hue: "green", show: number, positive: true },
];
const CAMERA_STRIPS = [
  { column: "range_m", title: "distance", unit: "m", digits: 3, least: 0.1, hue: "blue", show: number, free: true },
  { column: "bearing_error_deg", title: "bearing, left positive", unit: "°", digits: 2, least: 2, hue: "orange", show: signed },
];
const EVERY_MS = 200;
const HEIGHT = 96;

export class Charts {
  constructor(samples, mode) {
    this.samples = samples;
    this.strips = mode === "camera" ? CAMERA_STRIPS : STRIPS;
    this.host = document.getElementById("charts");
    this.now = 0;
    this.drawnMs = 0;
    this.build();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.build());
    new ResizeObserver(() => this.resize()).observe(this.host);
  }

  build() {
    this.host.replaceChildren();
    this.plots = this.strips.map((strip, k) => this.plot(strip, k === this.strips.length - 1));
  }

  plot(strip, last) {
    const title = document.createElement("p");
    title.className = "strip-title";
    const value = document.createElement("span");
    value.className = "now";
    value.dataset.column = strip.column;
    title.append(document.createTextNode(strip.title), value);
    const box = document.createElement("div");
    box.className = "strip";
    box.style.height = `${this.height(last)}px`;
    this.host.append(title, box);
    const line = { stroke: colour("grid"), width: 1 };
    const text = { stroke: colour("muted"), grid: line, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    const options = {
      width: this.host.clientWidth || 600,
      height: this.height(last),
      padding: [8, 12, last ? 0 : 10, 0],
      cursor: { show: false },
      legend: { show: false },
      scales: { x: { time: false, range: () => [this.now - SPAN_S, this.now] }, y: { range: (_, low, high) => range(strip, low, high) } },
      axes: [
        { ...text, size: last ? 24 : 0, splits: () => [60, 45, 30, 15, 0].map((s) => this.now - s),
          values: (_, splits) => (last ? splits.map((s) => { const ago = Math.round(this.now - s); return ago ? `${MINUS}${ago} s` : "now"; }) : splits.map(() => "")) },
        { ...text, size: 56, space: 24, values: (_, splits) => splits.map((s) => axisNumber(s)) },
      ],
      series: [{}, { stroke: colour(strip.hue), width: 1.6, points: { show: false }, spanGaps: false }],
    };
    return { strip, value, plot: new uPlot(options, [[], []], box) };
  }

  height(last) {
    return last ? HEIGHT + 20 : HEIGHT;
  }

  resize() {
    const width = this.host.clientWidth;
    if (width) this.plots.forEach(({ plot }, k) => plot.width !== width && plot.setSize({ width, height: this.height(k === this.plots.length - 1) }));
  }

  update(serverS, live) {
    const ms = performance.now();
    if (ms - this.drawnMs < EVERY_MS || document.hidden) return;
    this.drawnMs = ms;
    this.now = serverS;
    for (const { strip, value, plot } of this.plots) {
      plot.setData([this.samples.time_s, this.samples[strip.column]]);
      setText(value, `${live ? strip.show(this.samples.last(strip.column), strip.digits) : "–"} ${strip.unit}`);
    }
  }
}

// Around zero and not narrower than `least`, in steps, so that noise does not shake the axis.
function range(strip, low, high) {
  if (low === null || high === null || low === undefined) return strip.positive || strip.free ? [0, strip.least] : [-strip.least, strip.least];
  if (strip.free) {
    const margin = Math.max((high - low) * 0.1, strip.least / 2);
    return [low - margin, high + margin];
  }
  const widest = Math.max(Math.abs(low), Math.abs(high));
  if (!strip.positive && widest <= strip.least) return [-strip.least, strip.least];
  const most = nice(Math.max(widest, strip.least));
  if (strip.positive || low >= -0.02 * most) return [strip.positive || low >= 0 ? 0 : -0.05 * most, most];
  return high <= 0.02 * most ? [-most, 0.05 * most] : [-most, most];
}

function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 1.5, 2, 3, 5, 7.5, 10].find((step) => step * power >= value * 1.02) * power || value;
}

function axisNumber(value) {
  const text = Math.abs(value) >= 1000 ? value.toFixed(0) : `${Number(value.toPrecision(3))}`;
  return text.replace("-", MINUS);
}

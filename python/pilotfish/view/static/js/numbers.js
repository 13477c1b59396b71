// Headline, reason and the tiles of numbers.

import { degrees, milli, number, setText, signed } from "./format.js";

export class Numbers {
  constructor(mode) {
    this.headline = document.getElementById("headline");
    this.why = document.getElementById("why");
    this.lines = document.getElementById("lines");
    this.tiles = new Tiles(document.getElementById("tiles"), mode === "camera" ? CAMERA_TILES : ROBOT_TILES);
    this.loop = new Tiles(document.getElementById("loop-tiles"), mode === "camera" ? [] : LOOP_TILES);
  }

  say({ headline, tone, why, lines }) {
    setText(this.headline, headline);
    this.headline.dataset.tone = tone;
    setText(this.why, why);
    while (this.lines.children.length > lines.length) this.lines.lastChild.remove();
    lines.forEach((line, k) => {
      if (!this.lines.children[k]) this.lines.append(document.createElement("li"));
      setText(this.lines.children[k], line);
    });
  }

  update(state) {
    this.tiles.update(state);
    this.loop.update(state);
  }
}

const seen = (state) => (state.observation?.detected ? state.observation : null);
const sigma = (state, k, scale, unit) => {
  const value = seen(state)?.sigma?.[k];
  return Number.isFinite(value) ? `± ${number(value * scale, unit === "°" ? 3 : 2)} ${unit}` : "";
};

const ROBOT_TILES = [
  ["distance", "m", (s) => number(seen(s)?.distance_m, 3), (s) => sigma(s, 0, 1e3, "mm"), "distance"],
  ["bearing, left positive", "°", (s) => signed(degrees(seen(s)?.bearing_rad), 2), (s) => sigma(s, 1, 180 / Math.PI, "°"), "bearing"],
  ["leader's heading", "°", (s) => signed(degrees(seen(s)?.heading_rad), 1), (s) => sigma(s, 2, 180 / Math.PI, "°"), "heading"],
  ["speed v", "m/s", (s) => signed(s.command?.linear_mps, 3), (s) => wheels(s, "linear_mps", "m/s"), "linear"],
  ["turn rate ω", "rad/s", (s) => signed(s.command?.angular_radps, 3), (s) => wheels(s, "angular_radps", "rad/s"), "angular"],
  ["pictures", "Hz", (s) => number(s.status?.frame_rate_hz, 1), (s) => `${number(s.status?.processing_ms, 1)} ms each`, "rate"],
];

function wheels({ base }, name, unit) {
  if (!base) return "";
  return base.measured ? `measured ${signed(base[`measured_${name}`], 3)} ${unit}` : `wheels ${signed(base[name], 3)} ${unit}`;
}

// All zero in a status of a frame in which the law did not run.
function drive({ status }) {
  if (!status || (!status.drive_latency_s && !status.drive_lag_s)) return null;
  return {
    latency: milli(status.drive_latency_s), latencySigma: milli(status.drive_latency_sigma_s),
    lag: milli(status.drive_lag_s), lagSigma: milli(status.drive_lag_sigma_s),
  };
}

const LOOP_TILES = [
  ["command latency", "ms", (s) => number(milli(s.status?.latency_s), 1), (s) => (s.status?.latency_from_exposure ? "from exposure" : "from arrival"), "latency"],
  ["wheels' latency", "ms", (s) => number(drive(s)?.latency, 0), (s) => (drive(s) ? `± ${number(drive(s).latencySigma, 0)} ms` : ""), "drive-latency"],
  ["wheels' lag", "ms", (s) => number(drive(s)?.lag, 0), (s) => (drive(s) ? `± ${number(drive(s).lagSigma, 0)} ms` : ""), "drive-lag"],
  ["feed-forward", "%", (s) => number((s.status?.feed_forward_weight ?? NaN) * 100, 0), (s) => (s.status?.feed_forward_weight > 0 ? `leader ${signed(s.status.leader_radial_mps, 2)} m/s` : ""), "feed-forward"],
  ["missed deadlines", "", (s) => `${s.status?.missed_deadlines ?? "–"}`, () => "", "missed"],
  ["zero, no picture", "times", (s) => `${s.zeros_without_picture ?? "–"}`, () => "in the last minute", "zeros"],
  ["leader", "", (s) => (s.status?.leader_index === 0 ? "first" : s.status ? `other ${s.status.leader_index}` : "–"), (s) => (s.status?.leader_changes ? `changed ${s.status.leader_changes} times` : ""), "leader"],
  ["wheels' process", "", (s) => s.base?.state ?? "none", (s) => (s.base && s.base.text !== s.base.state ? s.base.text : ""), "base"],
];

const CAMERA_TILES = [
  ["distance", "m", (s) => number(seen(s)?.range_m, 3), (s) => (s.assumed_fov_deg ? `if ${s.assumed_fov_deg}° wide` : sigma(s, 0, 1e3, "mm")), "range"],
  ["right", "m", (s) => signed(pose(s, 0), 3), () => "x of the camera", "x"],
  ["down", "m", (s) => signed(pose(s, 1), 3), () => "y of the camera", "y"],
  ["ahead", "m", (s) => signed(pose(s, 2), 3), () => "z of the camera", "z"],
  ["turned", "°", (s) => signed(degrees(seen(s)?.heading_rad), 1), (s) => sigma(s, 2, 180 / Math.PI, "°"), "heading"],
  ["pictures", "Hz", (s) => number(s.frame_rate_hz, 1), () => "", "rate"],
];

const pose = (state, row) => seen(state)?.camera_from_leader?.[row]?.[3];

class Tiles {
  constructor(host, tiles) {
    host.replaceChildren();
    this.tiles = tiles.map(([title, unit, value, below, name]) => {
      const box = document.createElement("div");
      const [term, text] = [document.createElement("dt"), document.createElement("dd")];
      const [big, small, units] = [document.createElement("span"), document.createElement("small"), document.createElement("i")];
      term.textContent = term.title = title;
      units.textContent = unit;
      big.id = `value-${name}`;
      text.append(big, units, small);
      box.append(term, text);
      host.append(box);
      return { value, below, big, small };
    });
  }

  update(state) {
    for (const { value, below, big, small } of this.tiles) {
      setText(big, value(state));
      setText(small, below(state));
    }
  }
}

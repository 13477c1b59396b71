// The camera's picture with what was seen in it: outlines, ids and the leader's axes.

import { colour, duration, number, prepared, setText } from "./format.js";

const OLD_S = 1.0;
const KEPT_OVERLAYS = 8;

export class Picture {
  constructor() {
    this.card = document.getElementById("picture-card");
    this.canvas = document.getElementById("picture");
    this.frame = this.canvas.parentElement;
    this.empty = document.getElementById("no-picture");
    this.caption = document.getElementById("picture-caption");
    this.note = document.getElementById("picture-note");
    this.overlays = new Map();
    this.header = this.bitmap = null;
    this.live = this.alone = false;
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  async show(header, jpeg) {
    let bitmap;
    try {
      bitmap = await createImageBitmap(jpeg);
    } catch {
      setText(this.note, "a picture that this browser cannot decode");
      return;
    }
    this.bitmap?.close();
    this.bitmap = bitmap;
    this.header = header;
    if (header.overlay) this.remember(header.overlay);
    this.frame.style.aspectRatio = `${bitmap.width} / ${bitmap.height}`;
    this.draw();
    this.canvas.dispatchEvent(new CustomEvent("picturedrawn", { detail: { utime_us: header.utime_us } }));
  }

  remember(overlay) {
    this.overlays.set(overlay.utime_us, overlay);
    while (this.overlays.size > KEPT_OVERLAYS) this.overlays.delete(this.overlays.keys().next().value);
    if (this.header?.utime_us === overlay.utime_us && this.drawn !== overlay) this.draw();
  }

  // alone: no coordinator measures in these pictures any more.
  tick(connected, alone) {
    const age = this.header ? this.header.ageThenS + (performance.now() - this.header.receivedMs) / 1e3 : Infinity;
    const old = !connected || age > OLD_S;
    this.live = !old;
    if (this.alone !== alone) {
      this.alone = alone;
      this.draw();
    }
    this.card.toggleAttribute("data-old", old && this.header !== null);
    this.empty.hidden = !old;
    setText(this.empty, this.header === null ? "no picture on the bus (NAME_PREVIEW or NAME_IMAGE)" : `this picture is ${duration(age)} old`);
  }

  draw() {
    if (!this.bitmap) return;
    const { context, width, height } = prepared(this.canvas);
    const { bitmap, header } = this;
    const fit = Math.min(width / bitmap.width, height / bitmap.height);
    const left = (width - bitmap.width * fit) / 2, top = (height - bitmap.height * fit) / 2;
    context.drawImage(bitmap, left, top, bitmap.width * fit, bitmap.height * fit);
    const overlay = this.overlays.get(header.utime_us);
    this.drawn = overlay;
    this.canvas.dataset.tags = overlay ? overlay.tags.map((tag) => tag.id).join(" ") : "";
    const source = header.source_size;
    setText(this.caption, `${source[0]} x ${source[1]} px`);
    if (!overlay) {
      setText(this.note, this.alone ? "live, from the camera; nobody measures in it" : "");
      return;
    }
    // (0, 0) is the centre of the top-left pixel, so its corner is half a pixel before it.
    const scale = (fit * bitmap.width) / source[0];
    const at = ([u, v]) => [left + (u + 0.5) * scale, top + (v + 0.5) * scale];
    for (const tag of overlay.tags) outline(context, tag, at);
    if (overlay.axes_px) axes(context, overlay.axes_px.map(at));
    const place = overlay.detected ? `${number(overlay.distance_m, 3)} m` : overlay.text;
    setText(this.note, overlay.detected && !overlay.axes_px && !overlay.calibrated_size ? `${place} · axes need --config, or a coordinator on this computer` : place);
  }
}

function path(context, points, close) {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  if (close) context.closePath();
}

function stroke(context, style, width) {
  context.lineJoin = context.lineCap = "round";
  context.strokeStyle = "rgb(0 0 0 / .65)";
  context.lineWidth = width + 2.5;
  context.stroke();
  context.strokeStyle = style;
  context.lineWidth = width;
  context.stroke();
}

function outline(context, tag, at) {
  const corners = tag.corners_px.map(at);
  path(context, corners, true);
  stroke(context, "#ffd23e", 2);
  const x = corners.reduce((sum, corner) => sum + corner[0], 0) / 4;
  const y = Math.max(...corners.map((corner) => corner[1]));
  label(context, `${tag.id}`, x, y + 12, "#ffd23e");
}

function label(context, text, x, y, style) {
  context.font = "600 14px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.lineWidth = 4;
  context.strokeStyle = "rgb(0 0 0 / .75)";
  context.strokeText(text, x, y);
  context.fillStyle = style;
  context.fillText(text, x, y);
}

function axes(context, [origin, ...ends]) {
  const styles = [["x", "#ff6b5e"], ["y", "#6fe08a"], ["z", "#7db8ff"]];
  ends.forEach((end, k) => {
    path(context, [origin, end], false);
    stroke(context, styles[k][1], 2.5);
    const length = Math.hypot(end[0] - origin[0], end[1] - origin[1]) || 1;
    label(context, styles[k][0], end[0] + ((end[0] - origin[0]) / length) * 11, end[1] + ((end[1] - origin[1]) / length) * 11, styles[k][1]);
  });
}

// STOP, resume and setpoint. Every request is answered when the robot has confirmed it, or has not.

import { setText } from "./format.js";

const PATIENCE_MS = 8000;
const token = document.querySelector('meta[name="pilotfish-token"]').content;

export class Controls {
  constructor(robot, connection) {
    this.robot = robot;
    this.connection = connection;
    this.stopButton = document.getElementById("stop");
    this.note = document.getElementById("stop-note");
    this.outcome = document.getElementById("outcome");
    this.fields = { distance: document.getElementById("distance"), bearing: document.getElementById("bearing") };
    this.others = [document.getElementById("set"), document.getElementById("resume")];
    this.number = 0;
    this.touched = new Set();
    this.stopButton.hidden = document.getElementById("control-card").hidden = false;
    this.stopButton.addEventListener("click", () => this.stop());
    // Before anything else on the page: neither a field nor a button that has the focus may take the key.
    window.addEventListener("keydown", (event) => this.key(event), { capture: true });
    window.addEventListener("keyup", (event) => isStop(event) && swallow(event), { capture: true });
    document.getElementById("resume").addEventListener("click", () => this.send("resume", {}));
    document.getElementById("setpoint").addEventListener("submit", (event) => this.set(event));
    for (const [name, field] of Object.entries(this.fields)) field.addEventListener("input", () => this.touched.add(name));
  }

  key(event) {
    if (!isStop(event)) return;
    swallow(event);
    if (!event.repeat) this.stop();
  }

  stop() {
    return this.send("stop", {});
  }

  set(event) {
    event.preventDefault();
    const [distance_m, bearing_deg] = [this.fields.distance.value, this.fields.bearing.value].map((text) => (text.trim() === "" ? null : Number(text)));
    if (![distance_m, bearing_deg].every((value) => value === null || Number.isFinite(value))) return this.say("refused", "distance and bearing must be numbers");
    this.send("setpoint", { distance_m, bearing_rad: bearing_deg === null ? null : (bearing_deg * Math.PI) / 180 });
  }

  async send(action, values) {
    const mine = ++this.number;
    const isStopping = action === "stop";
    this.say("sending", isStopping ? "sending STOP until the robot confirms it" : `sending ${action} until the robot confirms it`);
    if (isStopping) setText(this.note, "sending…");
    if (!isStopping) this.others.forEach((button) => (button.disabled = true));
    const posted = post(`/api/robots/${encodeURIComponent(this.robot)}/${action}`, values);
    const answer = await (isStopping ? firstConfirmed([this.connection.stop(token), posted]) : posted);
    if (!isStopping) this.others.forEach((button) => (button.disabled = false));
    if (isStopping) setText(this.note, answer.confirmed ? "confirmed" : "NOT CONFIRMED");
    if (action === "setpoint" && answer.confirmed) this.touched.clear();
    if (mine !== this.number) return; // a later request has the line
    const messages = answer.sent ? ` (${answer.sent} message${answer.sent === 1 ? "" : "s"})` : "";
    this.say(answer.confirmed ? "confirmed" : "refused", answer.text + messages);
  }

  say(state, text) {
    this.outcome.dataset.state = state;
    setText(this.outcome, text);
  }

  update(status) {
    const show = (name, value, digits) => {
      const field = this.fields[name];
      if (this.touched.has(name) || document.activeElement === field || !Number.isFinite(value)) return;
      const text = `${Number(value.toFixed(digits))}`;
      if (field.value !== text) field.value = text;
    };
    if (!status) return;
    show("distance", status.setpoint_distance_m, 3);
    show("bearing", (status.setpoint_bearing_rad * 180) / Math.PI, 2);
    if (status.setpoint_run && this.note.textContent === "confirmed") setText(this.note, "space or Esc");
  }
}

const isStop = (event) => event.code === "Space" || event.key === "Escape";

function swallow(event) {
  event.preventDefault();
  event.stopImmediatePropagation();
}

// A stop goes both ways; where neither is confirmed, the answer of one that was sent says most.
async function firstConfirmed(answers) {
  const confirmed = answers.map((answer) => answer.then((outcome) => (outcome?.confirmed ? outcome : Promise.reject(outcome))));
  return Promise.any(confirmed).catch(({ errors }) => errors.find((outcome) => outcome?.sent) ?? errors.at(-1));
}

async function post(address, values) {
  try {
    const response = await fetch(address, {
      method: "POST",
      headers: { "content-type": "application/json", "x-pilotfish-token": token },
      body: JSON.stringify(values),
      signal: AbortSignal.timeout(PATIENCE_MS),
      keepalive: true,
    });
    const text = await response.text();
    try {
      return JSON.parse(text);
    } catch {
      return { confirmed: false, text };
    }
  } catch {
    return { confirmed: false, text: "the server of this page does not answer: stop the robot by `pilotfish stop NAME`, or by its own switch" };
  }
}

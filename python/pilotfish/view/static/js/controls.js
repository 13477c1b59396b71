// STOP, resume and setpoint. Every request is answered when the robot has confirmed it, or has not.

import { duration, setText } from "./format.js";

const PATIENCE_MS = 8000;
const AGE_FROM_S = 2; // an answer that is older says how old
const SETTLED_MS = 500; // a status that came so long after an answer is later than what the answer speaks of
const SAME = 1e-6; // of two distances [m] or bearings [rad]
const token = document.querySelector('meta[name="pilotfish-token"]').content;

export class Controls {
  constructor(hello, connection) {
    this.robot = hello.robot;
    this.connection = connection;
    this.stopButton = document.getElementById("stop");
    this.note = document.getElementById("stop-note");
    this.outcome = document.getElementById("outcome");
    this.age = document.getElementById("outcome-age");
    this.answered = null; // the answer that is shown: { action, answer, values, ms, session }
    this.fields = { distance: document.getElementById("distance"), bearing: document.getElementById("bearing") };
    this.others = [document.getElementById("set"), document.getElementById("resume")];
    this.limit(hello.limits);
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

  // What the arrows of a field end at; the server says why it refuses what is beyond.
  limit({ distance_m, bearing_deg }) {
    [this.fields.distance.min, this.fields.distance.max] = distance_m;
    [this.fields.bearing.min, this.fields.bearing.max] = bearing_deg;
    this.fields.distance.title = `${distance_m.join(" to ")} m`;
    this.fields.bearing.title = `${bearing_deg.join(" to ")} °`;
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
    if (Object.values(this.fields).some((field) => field.validity.badInput)) return this.say("refused", "distance and bearing must be numbers");
    const [distance_m, bearing_deg] = [this.fields.distance.value, this.fields.bearing.value].map((text) => (text.trim() === "" ? null : Number(text)));
    if (![distance_m, bearing_deg].every((value) => value === null || Number.isFinite(value))) return this.say("refused", "distance and bearing must be numbers");
    this.send("setpoint", { distance_m, bearing_rad: bearing_deg === null ? null : (bearing_deg * Math.PI) / 180 });
  }

  async send(action, values) {
    const mine = ++this.number;
    const isStopping = action === "stop";
    const { session } = this;
    this.say("sending", isStopping ? "sending STOP until the robot confirms it" : `sending ${action} until the robot confirms it`);
    if (isStopping) setText(this.note, "sending…");
    if (!isStopping) this.others.forEach((button) => (button.disabled = true));
    const posted = post(this.robot, action, values);
    const answer = await (isStopping ? firstConfirmed([this.connection.stop(token), posted]) : posted);
    if (!isStopping) this.others.forEach((button) => (button.disabled = false));
    if (isStopping) setText(this.note, answer.confirmed ? "confirmed" : "NOT CONFIRMED");
    if (action === "setpoint" && answer.confirmed) this.touched.clear();
    if (mine !== this.number) return; // a later request has the line
    const said = answer.text.startsWith(`${answer.sent} `); // "61 stops were sent ..."
    const messages = answer.sent && !said ? ` (${answer.sent} message${answer.sent === 1 ? "" : "s"})` : "";
    this.say(answer.confirmed ? "confirmed" : "refused", answer.text + messages);
    this.answered = { action, answer, values, ms: performance.now(), session };
  }

  say(state, text) {
    this.answered = null;
    this.outcome.dataset.state = state;
    setText(this.outcome, text);
    setText(this.age, "");
  }

  // An answer is of one moment: it says how long ago that was.
  tick() {
    if (!this.answered) return;
    const ageS = Math.floor((performance.now() - this.answered.ms) / 1e3);
    setText(this.age, ageS < AGE_FROM_S ? "" : `${duration(ageS).replace(".0", "")} ago`);
  }

  // What the robot says by now, if that is no longer what the answer said.
  overtake(status, ageS) {
    if (!this.answered || this.outcome.dataset.state === "past") return;
    if (performance.now() - ageS * 1e3 < this.answered.ms + SETTLED_MS) return;
    const since = overtaken(status, this.answered);
    if (!since) return;
    const { action, answer } = this.answered;
    this.outcome.dataset.state = "past";
    setText(this.outcome, `${action === "stop" ? "STOP" : action} was ${answer.confirmed ? "" : "not "}confirmed; ${since}`);
    if (action === "stop") setText(this.note, "space or Esc");
  }

  update(status, ageS) {
    const show = (name, value, digits) => {
      const field = this.fields[name];
      if (this.touched.has(name) || document.activeElement === field || !Number.isFinite(value)) return;
      const text = `${Number(value.toFixed(digits))}`;
      if (field.value !== text) field.value = text;
    };
    if (!status) return;
    this.session = status.session;
    this.overtake(status, ageS);
    show("distance", status.setpoint_distance_m, 3);
    show("bearing", (status.setpoint_bearing_rad * 180) / Math.PI, 2);
    if (status.setpoint_run && this.note.textContent === "confirmed") setText(this.note, "space or Esc");
  }
}

function overtaken(status, { action, answer, values, session }) {
  const runs = status.setpoint_run;
  if (session && status.session !== session && (answer.confirmed ? runs !== answer.run : action === "stop"))
    return `since then the coordinator has been started anew, and ${runs ? "drives" : "stands"}`;
  if (!answer.confirmed) {
    if (action === "stop" && !runs) return "by now the robot says that it is stopped";
    return action === "resume" && runs ? "by now the robot says that it runs" : "";
  }
  if (runs !== answer.run) return `since then the robot has been ${runs ? "resumed" : "stopped"}`;
  const kept = { distance_m: status.setpoint_distance_m, bearing_rad: status.setpoint_bearing_rad };
  const another = Object.entries(values).some(([name, value]) => value !== null && Math.abs(kept[name] - value) > SAME);
  return another ? "since then another setpoint has been set" : "";
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

async function post(robot, action, values) {
  try {
    const response = await fetch(`/api/robots/${encodeURIComponent(robot)}/${action}`, {
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
    return { confirmed: false, text: `the server of this page does not answer: stop the robot by "pilotfish stop ${robot}", or by its own switch` };
  }
}

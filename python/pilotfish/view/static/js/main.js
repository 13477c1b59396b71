// Connects the parts: what comes in is handed to each, and a clock says when it has become old.

import { Above } from "./above.js";
import { Charts } from "./charts.js";
import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { duration, setText } from "./format.js";
import { Law } from "./law.js";
import { Numbers } from "./numbers.js";
import { Picture } from "./picture.js";
import { Samples } from "./samples.js";
import { Tables } from "./tables.js";

const SILENT_S = 0.5; // a coordinator sends a command every 50 ms at least
const TICK_MS = 100;
const server = document.querySelector('meta[name="pilotfish-server"]').content;
const asked = new URLSearchParams(location.search).get("robot") ?? "";

const samples = new Samples();
const picture = new Picture();
let parts = null; // made with the first hello: they depend on what is watched
let state = null;
let lostMs = performance.now();
let problem = null;
let heard = []; // robots on the bus that this server does not watch

const connection = new Connection(asked, {
  onHello(hello) {
    if (hello.server !== server) return location.reload(); // another server has taken its place: another token
    document.body.dataset.link = "open";
    document.body.dataset.mode = hello.mode;
    document.title = `${hello.robot} · Pilotfish`;
    setText(document.getElementById("name"), hello.mode === "camera" ? `camera ${hello.source}` : hello.robot);
    samples.clear();
    state = null;
    parts ??= make(hello);
    listRobots(hello.robot);
  },
  onState(message) {
    state = message;
    samples.add(message.samples);
    if (message.overlay) picture.remember(message.overlay);
    show();
  },
  async onPicture(header, jpeg) {
    await picture.show(header, jpeg);
  },
  onLost(why) {
    if (document.body.dataset.link !== "lost") lostMs = performance.now();
    document.body.dataset.link = "lost";
    problem = why;
    tick();
  },
});

function make(hello) {
  const robot = hello.mode === "robot";
  const made = { hello, numbers: new Numbers(hello.mode), charts: new Charts(samples, hello.mode), above: new Above(samples) };
  if (robot) Object.assign(made, { controls: new Controls(hello, connection), law: new Law(), tables: new Tables() });
  made.law?.load();
  return made;
}

function newestAge() {
  if (!state) return Infinity;
  return parts.hello.mode === "camera" ? state.age("picture") : Math.min(state.age("status"), state.age("command"));
}

function liveness() {
  if (document.body.dataset.link !== "open" || !state) return "never";
  const age = newestAge();
  return age === Infinity ? "never" : age > SILENT_S ? "silent" : "live";
}

function show() {
  tick();
  const { status } = state;
  const live = document.body.dataset.live === "live";
  parts.numbers.update(state);
  parts.above.update(state.observation, status ? [status.setpoint_distance_m, status.setpoint_bearing_rad] : null);
  parts.law?.update(live ? status : null);
  parts.controls?.update(status, state.age("status"));
  parts.tables?.update(status?.stages ?? [], counters());
}

function counters() {
  const own = Object.entries(state.malformed ?? {}).map(([kind, count]) => [`view_${kind.toLowerCase()}`, count, `messages that this page's server could not read: ${kind}`]);
  const theirs = Object.entries(state.rejected ?? {}).map(([name, count]) => [name, count, parts.hello.counter_words?.[name] ?? ""]);
  const wheels = Object.entries(state.base?.rejected ?? {}).map(([name, count]) => [`wheels: ${name}`, count, parts.hello.base_counter_words?.[name] ?? parts.hello.counter_words?.[name] ?? ""]);
  const zeros = state.zeros_without_picture ? [["zeros_without_picture", state.zeros_without_picture, "times zero was commanded for want of a picture, while following, in the last minute"]] : [];
  return [...theirs, ...wheels, ...own, ...zeros].sort((a, b) => b[1] - a[1]);
}

// Ten times a second, whatever comes: age is what shows that nothing does.
function tick() {
  const link = document.body.dataset.link;
  const live = liveness();
  if (document.body.dataset.live !== live) document.body.dataset.live = live;
  picture.tick(link === "open", live === "silent" && parts?.hello.mode === "robot");
  parts?.controls?.tick();
  const text = document.getElementById("link-text");
  if (link === "lost") {
    const since = duration((performance.now() - lostMs) / 1e3);
    setText(text, "not connected");
    headline(problem ? "Waiting for a robot" : "Server not reachable", problem ?? `for ${since}; what is shown is old. To stop the robot: pilotfish stop ${robotName()}`, problem ? "wait" : "bad");
    return;
  }
  if (link !== "open" || !parts) return;
  const name = parts.hello.mode === "camera" ? "the camera" : parts.hello.robot;
  if (live === "live") {
    setText(text, "live");
    if (state.words) parts.numbers.say(state.words);
    else headline("Waiting for a status", "commands come, but no status yet", "wait");
  } else if (live === "silent") {
    const age = duration(newestAge());
    setText(text, `silent for ${age}`);
    const shown = picture.live ? "numbers, curves and rules are old; the picture is live, from the camera" : "what is shown is old";
    headline(`No messages from ${name}`, `the newest is ${age} old; ${shown}`, "bad");
  } else {
    setText(text, "nothing heard");
    const said = parts.hello.mode === "camera" && state?.words;
    if (said) parts.numbers.say(state.words);
    else headline(`Nothing heard from ${name}`, `is pilotfish-coordinator running, with this name and this LCM URL?${othersHeard()}`, "wait");
  }
  if (state) parts.charts.update(state.serverS(), live === "live");
}

function headline(text, why, tone) {
  const numbers = parts?.numbers;
  if (numbers) return numbers.say({ headline: text, why, tone, lines: [] });
  const element = document.getElementById("headline");
  setText(element, text);
  element.dataset.tone = tone;
  setText(document.getElementById("why"), why);
}

const robotName = () => (parts?.hello.robot ?? asked) || "NAME";

const othersHeard = () => (heard.length ? ` Heard on this bus: ${heard.join(", ")}. To watch: pilotfish view ${heard[0]}` : "");

async function listRobots(current) {
  const nav = document.getElementById("robots");
  const response = await fetch("/api/robots").catch(() => null);
  const answer = response?.ok ? await response.json() : {};
  const robots = answer.robots ?? [];
  heard = answer.heard ?? [];
  const links = robots.length < 2 ? [] : robots.map((robot) => {
    const link = document.createElement("a");
    link.className = "chip";
    link.href = `/?robot=${encodeURIComponent(robot)}`;
    link.textContent = robot;
    if (robot === current) link.setAttribute("aria-current", "page");
    return link;
  });
  nav.replaceChildren(...links);
}

setInterval(tick, TICK_MS);
setInterval(() => parts && document.body.dataset.link === "open" && !document.hidden && listRobots(parts.hello.robot), 3000);
export { connection };

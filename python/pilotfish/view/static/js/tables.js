// Stage timings and the counters of what was refused.

import { number } from "./format.js";

const BOUNDS_MS = [0.25, 0.5, 1, 2, 4, 8, 16, 32, 64, 128];
const RISING_MS = 2000;

export class Tables {
  constructor() {
    this.stages = document.querySelector("#stages tbody");
    this.refused = document.querySelector("#refused tbody");
    this.before = new Map();
  }

  update(stages, counters) {
    this.stages.replaceChildren(...stages.map(stageRow));
    const now = performance.now();
    const rows = [];
    for (const [name, count, words] of counters) {
      const known = this.before.get(name);
      const rises = known && count > known.count; // what counts the last minute falls again
      if (!known || known.count !== count) this.before.set(name, { count, ms: rises ? now : (known?.ms ?? -Infinity) });
      rows.push(counterRow(name, count, words, now - this.before.get(name).ms < RISING_MS));
    }
    if (!rows.length) rows.push(counterRow("nothing", "", "", false));
    this.refused.replaceChildren(...rows);
  }
}

function stageRow({ name, words, counts, max_ms }) {
  const most = Math.max(1, ...counts);
  const bars = document.createElement("span");
  bars.className = "histogram";
  for (const [k, count] of counts.entries()) {
    const bar = document.createElement("span");
    bar.style.height = `${Math.round((22 * count) / most)}px`;
    bar.title = `${k < 10 ? `below ${BOUNDS_MS[k]} ms` : "longer"}: ${count}`;
    bars.append(bar);
  }
  const line = row([words, bars, below(counts, 0.5), below(counts, 0.99), `${number(max_ms, 1)} ms`]);
  line.dataset.stage = name;
  return line;
}

// The bin in which a quantile falls.
function below(counts, share) {
  const total = counts.reduce((sum, count) => sum + count, 0);
  let sum = 0;
  for (let k = 0; total > 0 && k < counts.length; k++) {
    sum += counts[k];
    if (sum >= share * total) return k < BOUNDS_MS.length ? `< ${BOUNDS_MS[k]} ms` : "> 128 ms";
  }
  return "–";
}

function counterRow(name, count, words, rising) {
  const text = document.createElement("span");
  const small = document.createElement("small");
  text.textContent = words || name;
  small.textContent = words ? ` ${name}` : "";
  text.append(small);
  const line = row([`${count}`, text]);
  line.toggleAttribute("data-rising", rising);
  line.dataset.counter = name;
  return line;
}

function row(cells) {
  const line = document.createElement("tr");
  for (const content of cells) {
    const one = document.createElement("td");
    one.append(content);
    line.append(one);
  }
  return line;
}

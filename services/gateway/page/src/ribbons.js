// Belief ribbons: for each variable how probable each of its values was, step after step.
import { html, useState, useWidth, width } from "./ui.js";
import { valueColours, textOn } from "./colours.js";
import { chance } from "./format.js";
import { Fan, nowOf, summaryOf } from "./fan.js";
import { index, isRead, points, selectStep, steps } from "./store.js";
import { Cursor, placeOf } from "./timeline.js";

const HEIGHT = 40;
const SHOWN = 8;
const TAIL = 6; // So many letters at the end of a value's name are always seen: long names differ there.
const MARKED = 12; // Of a variable that moves more often no move is marked.
const MOVED = 0.2; // A distribution that moves this far in total variation is marked.

export function Ribbons() {
  const [ref, size] = useWidth();
  const [showsAll, setShowsAll] = useState(false);
  const all = points.value;
  const rows = summarised(all);
  const told = rows.filter((row) => row.isDoubtful || row.isMoving);
  const shown = showsAll ? told : told.slice(0, SHOWN);
  const still = rows.filter((row) => !row.isDoubtful && !row.isMoving);
  const now = index.value;
  return html`<div class="ribbons" ref=${ref}>
    ${size > 0 && shown.map((row) => html`<${Ribbon} key=${row.name} row=${row} all=${all} size=${size} now=${now} />`)}
    ${told.length > SHOWN && html`<button class="link" onClick=${() => setShowsAll(!showsAll)}>
      ${showsAll ? "Show fewer" : `Show ${told.length - SHOWN} more`}</button>`}
    ${still.length > 0 && html`<p class="still"><span>Certain throughout</span>
      ${still.slice(0, 40).map((row) => html`<span class="chip"><b>${row.name}</b> ${row.values[0]}</span>`)}</p>`}
    ${!rows.length && isRead.value && html`<p class="empty">There is no belief yet.</p>`}
  </div>`;
}

function Ribbon({ row, all, size, now }) {
  const isNarrow = width.value < 720;
  const room = Math.max(60, isNarrow ? size : size - 330);
  const head = headOf(room);
  const colours = valueColours(row.values);
  const current = all[now + 1]?.[row.name] ?? {};
  const told = Array.isArray(current) ? nowOf(current, row.high - row.low) : likeliest(current);
  const words = told.map(([what, each]) => `${what} ${each}`).join(", ");
  return html`<div class="ribbon">
    <h3 class="ribbon-name">${row.name}</h3>
    <svg class=${room > 4 * all.length ? "ribbon-plot" : "ribbon-plot is-dense"} width=${room} height=${HEIGHT} role="img" aria-label=${`${row.name}: ${words}`}
      onClick=${(event) => selectStep(stepAt(event, room))}>
      ${row.isNumber ? html`<${Fan} row=${row} all=${all} room=${room} head=${head} height=${HEIGHT} />` : areas(row, all, room, colours)}
      ${row.moves.length <= MARKED && row.moves.map((i) => html`<path class="moved" d=${`M${placeOf(i - 1, room, head)} ${HEIGHT} l-3.5 5 h7 z`} />`)}
      ${!row.isNumber && labels(row, all, room, colours)}
      <${Cursor} room=${room} height=${HEIGHT} head=${head} />
    </svg>
    <dl class=${row.isNumber ? "ribbon-now is-number" : "ribbon-now"}>
      ${told.map(([what, each]) => html`<div><dt title=${what}>${!row.isNumber && html`<i style=${{ background: colours.get(what) }}></i>`}<span>${what.slice(0, -TAIL)}</span>${what.slice(-TAIL)}</dt><dd>${each}</dd></div>`)}
    </dl>
  </div>`;
}

const likeliest = (values) => Object.entries(values).sort((a, b) => b[1] - a[1]).slice(0, 2).map(([value, each]) => [value, chance(each)]);

// Before the first field there is room for the belief that the mission began with.
const headOf = (room) => Math.min(24, (room / (steps.value.length + 0.5)) * 0.5);

const stepAt = (event, room) => {
  const n = steps.value.length;
  const x = event.clientX - event.currentTarget.getBoundingClientRect().left;
  const head = headOf(room);
  const place = Math.min(n - 1, Math.max(0, Math.floor(((x - head) / (room - head)) * n)));
  return steps.value[place]?.step;
};

// Each value is a band. It keeps its height during a step, and goes over to the next where the outcome came.
function areas(row, all, room, colours) {
  const n = all.length - 1;
  if (n < 1) return null;
  const head = headOf(room);
  const ramp = Math.min(8, (room / n) * 0.4);
  const below = new Float64Array(all.length);
  return row.values.map((value) => {
    let upper = "";
    let lower = "";
    let isThere = false;
    for (let i = 0; i <= n; i++) {
      const share = all[i][row.name]?.[value] ?? 0;
      if (share > 0) isThere = true;
      const low = HEIGHT - below[i] * HEIGHT;
      below[i] += share;
      const high = HEIGHT - below[i] * HEIGHT;
      // The field of a step holds the belief after it; the belief at the start has the room before the first.
      const from = i === 0 ? 0 : placeOf(i - 1, room, head) + ramp / 2;
      const until = i === n ? room : Math.max(from, placeOf(i, room, head) - ramp / 2);
      upper += `${upper ? "L" : "M"}${from.toFixed(1)} ${high.toFixed(1)}L${until.toFixed(1)} ${high.toFixed(1)}`;
      lower = `L${until.toFixed(1)} ${low.toFixed(1)}L${from.toFixed(1)} ${low.toFixed(1)}${lower}`;
    }
    return isThere ? html`<path d=${`${upper}${lower}Z`} style=${{ fill: colours.get(value) }} />` : null;
  });
}

// A value is named within its band, once for each stretch where it is the likeliest and there is room.
function labels(row, all, room, colours) {
  const found = [];
  const n = all.length - 1;
  const head = headOf(room);
  let begun = 0;
  let leader = null;
  const place = (until) => {
    const from = begun === 0 ? 0 : placeOf(begun - 1, room, head);
    const to = until > n ? room : placeOf(until - 1, room, head);
    if (!leader || to - from < leader.length * 7 + 14) return;
    let low = 0;
    const at = all[begun][row.name] ?? {};
    for (const value of row.values) {
      if (value === leader) break;
      low += at[value] ?? 0;
    }
    const middle = HEIGHT - (low + (at[leader] ?? 0) / 2) * HEIGHT;
    found.push(html`<text x=${from + 8} y=${middle + 4} style=${{ fill: textOn(colours.get(leader)) }}>${leader}</text>`);
  };
  for (let i = 0; i <= n; i++) {
    const [value, share] = Object.entries(all[i][row.name] ?? {}).reduce((best, each) => (each[1] > best[1] ? each : best), ["", 0]);
    const is = share >= 0.5 ? value : null;
    if (is !== leader) {
      place(i);
      begun = i;
      leader = is;
    }
  }
  place(n + 1);
  return found;
}

let kept = { all: null, rows: [] };

// The variables, the most doubtful first, with their values and where they have moved.
export function summarised(all) {
  if (kept.all === all) return kept.rows;
  const rows = new Map();
  const numbers = numberNames(all);
  for (let i = 0; i < all.length; i++) {
    for (const name in all[i]) {
      if (numbers.has(name)) continue;
      const values = all[i][name];
      const before = i ? all[i - 1][name] : undefined;
      let row = rows.get(name);
      if (!row) rows.set(name, (row = { name, weights: new Map(), doubt: 0, isDoubtful: false, isMoving: false, moves: [] }));
      let entropy = 0;
      for (const value in values) {
        const share = values[value];
        row.weights.set(value, (row.weights.get(value) ?? 0) + share);
        if (share > 0 && share < 1) entropy -= share * Math.log(share);
      }
      if (entropy > 0.005) row.isDoubtful = true;
      row.doubt += entropy;
      if (before && before !== values) {
        const moved = distance(before, values);
        if (moved > 1e-4) row.isMoving = true;
        if (moved >= MOVED) row.moves.push(i);
      }
    }
  }
  const list = [...rows.values()].map((row) => ({
    ...row,
    values: [...row.weights.entries()].sort(byName).map(([value]) => value),
  }));
  for (const name of numbers) list.push(summaryOf(name, all));
  list.sort((a, b) => b.doubt - a.doubt || b.moves.length - a.moves.length);
  kept = { all, rows: list };
  return list;
}

// The variables that have quantiles at some step.
function numberNames(all) {
  const found = new Set();
  for (const point of all) for (const name in point) if (Array.isArray(point[name])) found.add(name);
  return found;
}

// True is below, false above; other values as they were met, what is not listed on top.
const order = (value) => (value === "true" ? -1 : value === "false" || value === "…" ? 1 : 0);
const byName = (a, b) => order(a[0]) - order(b[0]);

function distance(a, b) {
  let sum = 0;
  for (const value in a) sum += Math.abs(a[value] - (b[value] ?? 0));
  for (const value in b) if (!(value in a)) sum += b[value];
  return sum / 2;
}

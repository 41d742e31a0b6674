// The ribbon of a number with many values: its median, and what half and nine tenths of the probability lie between.
import { html } from "./ui.js";
import { number } from "./format.js";
import { placeOf } from "./timeline.js";

const SHARES = [0.05, 0.25, 0.5, 0.75, 0.95];
const DOUBT = 2; // nats for a number that is as uncertain as it ever was: about that of eight values

// The quantiles of a point. Where few values were left, their probabilities are there instead.
export function quantilesOf(told) {
  if (!told || Array.isArray(told)) return told ?? null;
  const weighted = Object.entries(told).map(([value, share]) => [Number(value), share]).filter(([value]) => Number.isFinite(value));
  weighted.sort((a, b) => a[0] - b[0]);
  const total = weighted.reduce((sum, [, share]) => sum + share, 0);
  if (!total) return null;
  return SHARES.map((share) => {
    let below = 0;
    return weighted.find(([, each]) => (below += each) >= share * total - 1e-9)?.[0] ?? weighted.at(-1)[0];
  });
}

export const nowOf = ([low, , median, , high], span) => [["median", number(median, span)], ["5–95 %", `${number(low, span)} … ${number(high, span)}`]];

// What `summarised` says of other variables. A step is marked where the median leaves the middle half of before.
export function summaryOf(name, all) {
  const series = all.map((point) => quantilesOf(point[name]));
  const there = series.filter(Boolean);
  const low = Math.min(...there.map((each) => each[0]));
  const high = Math.max(...there.map((each) => each[4]));
  const span = high - low || 1;
  const row = { name, isNumber: true, series, low, high, values: [number(there[0][2])], doubt: 0, isDoubtful: false, isMoving: false, moves: [] };
  series.forEach((each, i) => {
    if (!each) return;
    row.doubt += (DOUBT * (each[4] - each[0])) / span;
    if (each[4] > each[0]) row.isDoubtful = true;
    const before = series[i - 1];
    if (!before || before === each) return;
    if (each.some((value, k) => Math.abs(value - before[k]) > 1e-4 * span)) row.isMoving = true;
    if (each[2] < before[1] || each[2] > before[3]) row.moves.push(i);
  });
  return row;
}

export function Fan({ row, room, head, height }) {
  const n = row.series.length - 1;
  if (n < 1) return null;
  const ramp = Math.min(8, (room / n) * 0.4);
  const span = row.high - row.low || 1;
  const y = (value) => 2 + (height - 4) * (1 - (value - row.low) / span);
  const line = (k) => row.series.flatMap((each, i) => {
    if (!each) return [];
    const from = i === 0 ? 0 : placeOf(i - 1, room, head) + ramp / 2;
    const until = i === n ? room : Math.max(from, placeOf(i, room, head) - ramp / 2);
    return [`${from.toFixed(1)} ${y(each[k]).toFixed(1)}`, `${until.toFixed(1)} ${y(each[k]).toFixed(1)}`];
  });
  const band = (low, high) => `M${[...line(high), ...line(low).reverse()].join("L")}Z`;
  return html`
    <path class="fan-most" d=${band(0, 4)} />
    <path class="fan-half" d=${band(1, 3)} />
    <path class="fan-median" d=${`M${line(2).join("L")}`} />
    <text class="fan-end" x="3" y="10">${number(row.high, span)}</text>
    <text class="fan-end" x="3" y=${height - 2}>${number(row.low, span)}</text>`;
}

// The values of the actions at a step: an estimate with its error, and what is proven.
import { html, useEffect, useState, useWidth, width } from "./ui.js";
import { briefAction, isNumber, plusMinus, signed } from "./format.js";
import { at, index, loadRecord, record, records, recordsChanged, steps } from "./store.js";
import { canSteer, isLeftOut, OfAction } from "./steering.js";

// Of an action that the search has not tried nothing is known.
const isKnown = (each, found) => isNumber(each.q) && (each.n > 0 || !found.simulations);

const SHOWN = 8;
const ROW = 30;

export function Values() {
  const [ref, size] = useWidth();
  const [showsAll, setShowsAll] = useState(false);
  const found = record.value?.decided ?? record.value?.observed;
  if (!at.value || !found || found.step !== at.value.step) return html`<div ref=${ref} class="values" aria-busy="true"></div>`;
  const sorted = found.actions.filter((each) => isKnown(each, found)).sort((a, b) => b.q - a.q);
  let shown = showsAll ? sorted : sorted.slice(0, SHOWN);
  const chosen = sorted.find((each) => each.action === found.action);
  if (chosen && !shown.includes(chosen)) shown = [...shown, chosen];
  const scale = scaleOf(shown);
  return html`<div class="values" ref=${ref}>
    <ol>
      ${shown.map((each) => html`<${Row} key=${each.action} each=${each} scale=${scale} size=${size} found=${found} />`)}
    </ol>
    ${sorted.length > SHOWN && html`<button class="link" onClick=${() => setShowsAll(!showsAll)}>${showsAll ? "Show fewer" : `Show all ${sorted.length}`}</button>`}
    ${!sorted.length && html`<p class="empty">${found.planner ? `${found.planner} gives no values.` : "Nothing was searched for this action."}</p>`}
    ${!sorted.length && canSteer() && html`<${WithoutValues} />`}
    ${[...setAside(found), ...notNow(found)].map((why) => html`<p class="aside">${why}</p>`)}
    ${(found.constraints ?? []).map((each) => html`<p class="aside">Never <code>${each.never}</code>: risks ${each.risk.toPrecision(2)} of ${each.left.toPrecision(2)} that are left.</p>`)}
  </div>`;
}

// Why skills and actions stay away, beside those that somebody leaves out, which are told above.
const setAside = (found) => new Set(Object.entries(found.set_aside ?? {}).filter(([name]) => !isLeftOut(name)).map(([, why]) => why));

// Actions that the search knew and nobody could run, together where the reason is the same.
function notNow(found) {
  const names = new Map();
  for (const made of found.searches ?? [])
    for (const [action, why] of Object.entries(made.is_dropped ? {} : made.barred ?? {})) names.set(why, (names.get(why) ?? new Set()).add(action));
  return [...names].map(([why, actions]) => `${[...actions].map(briefAction).join(", ")} cannot be chosen now: ${why}`);
}

// What a person may do where the step has no values: the actions of the last decision that has some.
function WithoutValues() {
  const last = steps.value.slice(0, index.value).findLast((each) => each.actions > 0)?.step;
  useEffect(() => {
    if (last) loadRecord(last);
  }, [last]);
  recordsChanged.value;
  const names = (records.get(last)?.decided?.actions ?? []).map((each) => each.action);
  return html`<ol>${names.map((name) => html`<li class="value" key=${name}><span class="value-head"><span class="value-name" title=${name}>${briefAction(name)}</span><${OfAction} action=${name} /></span></li>`)}</ol>`;
}

function Row({ each, scale, size, found }) {
  const isChosen = each.action === found.action;
  const room = Math.max(80, size - (width.value < 480 ? 84 : 92));
  const x = (value) => scale(value) * (room - 16) + 8;
  const error = each.stderr ?? 0;
  const words = `${each.action}: ${signed(each.q)}${plusMinus(error, each.q)}${isChosen ? ", chosen" : ""}`;
  return html`<li class=${isChosen ? "value is-chosen" : "value"} aria-label=${words}>
    <span class="value-head"><span class="value-name" title=${each.action}>${isChosen && html`<span class="chosen-mark" aria-hidden="true">▸</span>`}${briefAction(each.action)}</span><${OfAction} action=${each.action} /></span>
    <span class="value-plot">
      <svg width=${room} height=${ROW - 12} aria-hidden="true">
        <line class="rail" x1="8" x2=${room - 8} y1="9" y2="9" />
        ${isNumber(each.at_least) && isNumber(each.at_most) && html`<line class="proven" x1=${x(each.at_least)} x2=${x(each.at_most)} y1="9" y2="9" />`}
        ${error > 0 && html`<line class="error" x1=${x(each.q - 2 * error)} x2=${x(each.q + 2 * error)} y1="9" y2="9" />`}
        <circle cx=${x(each.q)} cy="9" r=${isChosen ? 5.5 : 4} />
      </svg>
      <span class="value-number">${signed(each.q)}</span>
    </span>
  </li>`;
}

// The scale goes from the worst that is shown to the best, and what lies beyond is cut at its ends.
function scaleOf(shown) {
  const ends = shown.flatMap((each) => [each.q - 2 * (each.stderr ?? 0), each.q + 2 * (each.stderr ?? 0)]).filter(isNumber);
  const low = Math.min(...ends);
  const span = Math.max(...ends) - low || 1;
  return (value) => Math.min(1, Math.max(0, (value - low) / span));
}

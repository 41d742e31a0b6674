// All steps as a table, and one step in full: parameters, local variables, times.
import { Card, html, useEffect, useRef, useState } from "./ui.js";
import { briefAction, chance, plain, seconds, signed } from "./format.js";
import { at, index, isGone, record, selectStep, steps } from "./store.js";
import { hasFailed, isSurprising } from "./timeline.js";

export const Steps = () => html`<div class="columns">
  <${Card} id="all-steps" title="Steps" className="wide"><${Table} /><//>
  <${Card} id="activation" title=${at.value ? `Activation of step ${at.value.step}` : "Activation"}><${Activation} /><//>
</div>`;

const SHOWN = 150; // A table of more rows shows those around the step, until somebody wants all.

export function Table() {
  const body = useRef(null);
  const [showsAll, setShowsAll] = useState(false);
  const now = at.value?.step;
  const all = steps.value;
  const isLong = all.length > SHOWN && !showsAll;
  const first = isLong ? Math.max(0, Math.min(all.length - SHOWN, Math.round((index.value - SHOWN / 2) / 25) * 25)) : 0;
  const shown = isLong ? all.slice(first, first + SHOWN) : all;
  useEffect(() => {
    const row = body.current?.querySelector("[aria-selected=true]");
    const box = body.current?.closest(".scroll");
    if (row && box && (row.offsetTop < box.scrollTop + 30 || row.offsetTop + row.offsetHeight > box.scrollTop + box.clientHeight))
      box.scrollTop = row.offsetTop - box.clientHeight / 2;
  }, [now]);
  return html`<div class="scroll" tabindex="0" role="region" aria-label="Table of steps">
    <table class="steps">
      <thead><tr><th>Step</th><th>Action</th><th class="num wide-only">Value</th><th>Seen</th><th class="num wide-only">Expected</th><th class="num">Surprise</th><th class="num wide-only">Goal</th></tr></thead>
      <tbody ref=${body}>${shown.map((step) => html`<${Row} key=${step.step} step=${step} isNow=${step.step === now} />`)}</tbody>
    </table>
    ${isLong && html`<button class="link" onClick=${() => setShowsAll(true)}>Show all ${all.length} steps</button>`}
  </div>`;
}

const Row = ({ step, isNow }) => html`<tr aria-selected=${isNow} onClick=${() => selectStep(step.step)}>
  <td><button class="row-step" aria-label=${`Step ${step.step}`}>${step.step}</button></td>
  <td class="action" title=${step.action}><${Name} of=${briefAction(step.action)} /></td>
  <td class="num wide-only">${signed(step.value)}</td>
  <td>${step.status ? (hasFailed(step) ? html`<span class="bad">✕ ${step.status.replace("_", " ")}</span>` : html`<${Name} of=${step.seen} />`) : html`<span class="muted">${isGone.value ? "not known" : "running"}</span>`}</td>
  <td class="num wide-only">${step.status ? chance(step.expected) : ""}</td>
  <td class="num">${step.status ? html`${isSurprising(step) ? html`<span class="mark" aria-label="surprising">▲ </span>` : ""}${step.impossible ? "∞" : plain(step.surprise)}` : ""}</td>
  <td class="num wide-only">${chance((step.endings_after ?? step.endings)?.goal)}</td>
</tr>`;

// It breaks between the parts of a name, and within one only where that is too long.
const Name = ({ of }) =>
  of.split(/(?<=[(,_])/).map((part) => html`<span class=${part.length < 12 ? "whole" : ""}>${part}</span><wbr />`);

function Activation() {
  const found = record.value;
  const step = at.value;
  if (!step || !found) return html`<p class="empty">There is no step yet.</p>`;
  const full = found.observed ?? found.decided;
  const outcome = found.observed?.outcome;
  const took = outcome ? (outcome.ended_ns - outcome.started_ns) / 1e9 : null;
  const locals = Object.entries(outcome?.local_variables ?? {});
  return html`<div class="activation">
    <p class="big-action">${step.action}</p>
    <dl class="facts">
      <div><dt>Outcome</dt><dd>${outcome ? `${outcome.status.replace("_", " ")}${outcome.response ? `: ${outcome.response}` : ""}` : "running"}</dd></div>
      ${took !== null && html`<div><dt>Took</dt><dd>${seconds(took)}</dd></div>`}
      <div><dt>Decided in</dt><dd>${seconds(full.planning_s)}${full.planner ? `, by ${full.planner}` : ""}</dd></div>
      ${full.why && html`<div><dt>Why this planner</dt><dd>${full.why}</dd></div>`}
      <div><dt>Look-ahead</dt><dd>${full.horizon} decisions</dd></div>
      <div><dt>Model</dt><dd>revision ${full.revision}, <code>${full.model_digest.slice(0, 12)}</code></dd></div>
      <div><dt>Belief</dt><dd>${full.belief.states.toLocaleString("en")} ${full.belief.states === 1 ? "state" : "states"}, ${full.belief.is_exact ? "exact" : "sampled"}</dd></div>
      ${Object.entries(outcome?.numbers ?? {}).map(([name, value]) => html`<div><dt>${name}</dt><dd>${JSON.stringify(value)}</dd></div>`)}
      ${Object.entries(outcome?.monitors ?? {}).map(([name, value]) => html`<div><dt>${name}</dt><dd>${value}</dd></div>`)}
    </dl>
    <h3>Local variables</h3>
    ${locals.length ? html`<dl class="facts mono">${locals.map(([name, value]) => html`<div><dt>${name}</dt><dd>${value}</dd></div>`)}</dl>` : html`<p class="empty">${outcome ? "The mapping has none." : "They come with the outcome."}</p>`}
  </div>`;
}

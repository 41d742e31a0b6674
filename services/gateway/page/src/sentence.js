// The decision of a step in one sentence, and what was expected and seen in another.
import { html } from "./ui.js";
import { chance, isNumber, number, percent, plain, plusMinus, seconds, signed, sized } from "./format.js";
import { at, isGone, isRead, progress, record } from "./store.js";
import { isAsked } from "./timeline.js";

export function Sentence() {
  const step = at.value;
  if (!step) return html`<p class="sentence muted">${isRead.value ? "No decision has been made yet." : "The mission is being read…"}</p>`;
  return html`<div class="decision">
    <p class="sentence"><span class="action">${step.action}</span> ${worth(step)}</p>
    <p class="came">${came(step)}</p>
    ${step.fault && html`<p class="came fault">${step.fault}</p>`}
    ${step.remark && html`<p class="came">${step.remark}</p>`}
    ${step.adopted && html`<p class="came">A new model decided: ${step.adopted}.</p>`}
  </div>`;
}

function worth(step) {
  const by = [step.planner, step.simulations ? `${step.simulations.toLocaleString("en")} simulations` : "", seconds(step.planning_s)].filter(Boolean).join(", ");
  const note = by && html`<span class="by">${by}</span>`;
  if (isAsked(step)) return step.chosen_by === "script" ? html`comes from a script of a person.` : html`was asked for by a person.`;
  if (!isNumber(step.value)) return html`was chosen. ${note}`;
  const value = html`is worth <b>${signed(step.value)}</b>${plusMinus(step.error, step.value)}`;
  if (!step.second) return html`${value}; nothing else can be done. ${note}`;
  const error = Math.hypot(step.error ?? 0, step.second_error ?? 0);
  const other = html`<span class="other">${step.second}</span>`;
  if (isNumber(step.margin) && !step.is_proven && Math.abs(step.margin) < 2 * error) return html`${value}, too close to call against ${other}. ${note}`;
  if (step.margin < 0) return html`${value}, ${sized(-step.margin)} less than ${other}. ${note}`;
  if (step.margin === 0) return html`${value}, as much as ${other}. ${note}`;
  return html`${value}, <b>${sized(step.margin)}</b> more than ${other}. ${note}`;
}

function came(step) {
  const likely = Object.entries(step.predicted ?? {}).filter(([response]) => response !== "…").sort((a, b) => b[1] - a[1]).slice(0, 3);
  const expected = likely.map(([response, share], i) => html`${i ? ", " : ""}<span class="response">${response}</span> ${percent(share)}`);
  if (!step.status) {
    if (isGone.value) return html`Expected ${expected}. How it ended is not known.`;
    const how = progress.value;
    return html`Expected ${expected}. ${how && how.id?.step === step.step && (how.progress || how.text) ? `It is running${how.progress ? `, ${percent(how.progress)}` : ""}${how.text ? `: ${how.text}` : ""}.` : html`<span class="waiting">It is running.</span>`}`;
  }
  if (step.status !== "observed") return html`Expected ${expected}. Nothing was observed: <b>${step.status.replace("_", " ")}</b>.`;
  const surprise = step.impossible ? "The model held that impossible." : `Surprise ${plain(step.surprise)}.`;
  const how = step.stopped_by ? ` It was stopped by ${step.stopped_by}.` : "";
  return html`Expected ${expected}. Saw <b class="response">${step.seen}</b>${isNumber(step.expected) ? ` (${chance(step.expected)})` : ""}${reported()}.${how} ${surprise}`;
}

// The numbers that came with the response; of an array the first few.
function reported() {
  const numbers = Object.entries(record.value?.observed?.outcome?.numbers ?? {});
  const text = (value) => [value].flat().slice(0, 4).map((each) => (isNumber(each) ? number(each) : "–")).join(" ") + ([value].flat().length > 4 ? " …" : "");
  return numbers.length ? html`, ${numbers.map(([name, value]) => `${name} = ${text(value)}`).join(", ")}` : "";
}

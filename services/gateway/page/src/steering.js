// Steering a mission that runs: hold, one step, go on, stop; an action of a person; what decisions do without.
import { Findings, html } from "./ui.js";
import { signal } from "@preact/signals";
import { hasToken, write } from "./api.js";
import { addressOf, route } from "./route.js";
import { isGivenUp, mission, state, successor } from "./store.js";

const failed = signal(null);
const busy = signal("");

const MAY_NOT = ["waiting", "compiling", "ended"]; // No mission has begun, or none runs any more.
const isUnderWay = () => mission.value?.is_running && state.value && !MAY_NOT.includes(state.value.phase);
const isToBegin = () => mission.value?.is_running && !isGivenUp.value && ["waiting", "compiling"].includes(state.value?.phase);
export const canSteer = () => hasToken() && isUnderWay();
const isHeld = () => Boolean(state.value?.held_by) || state.value?.phase === "holding";

export async function steer(verb, more = {}) {
  const { name } = route.value;
  busy.value = verb;
  failed.value = null;
  try {
    // The mission's state comes with the events. The answer may be older than the newest of them.
    await write(`/v1/missions/${encodeURIComponent(name)}/steering`, { verb, ...more });
  } catch (error) {
    failed.value = error;
  }
  busy.value = "";
}

export function Controls() {
  if (successor.value) return html`<a class="button primary" href=${addressOf(successor.value)}>To the next mission</a>`;
  if (!isUnderWay() && !isToBegin()) return null;
  if (!hasToken()) return html`<p class="controls note">Read only</p>`;
  const is = Boolean(busy.value);
  const stop = html`<button class="stop" disabled=${busy.value === "stop"} onClick=${() => steer("stop")}>${busy.value === "stop" ? "Stopping…" : "Stop"}</button>`;
  if (isToBegin()) return html`<div class="controls" role="group" aria-label="Steering">${stop}<${Findings} problem=${failed.value} /></div>`;
  return html`<div class="controls" role="group" aria-label="Steering">
    ${isHeld()
      ? html`<button class="primary" disabled=${is} onClick=${() => steer("resume")}>Go on</button>`
      : html`<button disabled=${is} onClick=${() => steer("hold")}>Hold</button>`}
    <button disabled=${is} onClick=${() => steer("step")} title="One more decision, then hold">Step</button>
    ${stop}
    <${Findings} problem=${failed.value} />
  </div>`;
}

// What a person may do with an action of the list.
export const OfAction = ({ action }) =>
  canSteer() && html`<span class="of-action">
    <button class="quiet" disabled=${Boolean(busy.value)} onClick=${() => steer("act", { actions: [action] })} aria-label=${`Do ${action}`}>Do</button>
    ${!isLeftOut(action) && html`<button class="quiet" disabled=${Boolean(busy.value)} onClick=${() => steer("leave_out", { name: action })} aria-label=${`Leave out ${action}`}>Leave out</button>`}
  </span>`;

export const isLeftOut = (name) => name in (state.value?.left_out ?? {});

export function LeftOut() {
  const without = Object.entries(state.value?.left_out ?? {});
  const asked = state.value?.asked ?? [];
  if (!without.length && !asked.length) return null;
  return html`<div class="left-out">
    ${asked.length > 0 && html`<p class="aside">Still to come: ${asked.map((action) => html`<span class="chip">${action}</span> `)}</p>`}
    ${without.map(([name, by]) => html`<p class="aside"><span class="chip">${name}</span> is left out by ${by} ${canSteer() && html`<button class="link" onClick=${() => steer("take_back", { name })}>Take it back</button>`}</p>`)}
  </div>`;
}

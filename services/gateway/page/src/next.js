// The next mission of a system that stays, where one has ended or was kept from beginning, and none runs.
import { Findings, html, useEffect, useState } from "./ui.js";
import { hasToken, read, write } from "./api.js";
import { addressOf, go } from "./route.js";
import { isGivenUp, mission, state, successor } from "./store.js";

export function Next() {
  const [stays, setStays] = useState(false);
  const [given, setGiven] = useState({ belief: "initial", given: "", idle: "0" });
  const [values, setValues] = useState({});
  const [problem, setProblem] = useState(null);
  const [busy, setBusy] = useState(false);
  const run = mission.value?.run;
  const isOver = state.value?.phase === "ended" || isGivenUp.value;
  useEffect(() => {
    if (!run || !isOver || !hasToken()) return;
    read(`/v1/runs/${encodeURIComponent(run)}`).then(
      (entry) => setStays(entry.is_running && entry.stays && entry.missions.at(-1) === state.value?.mission),
      () => setStays(false),
    );
  }, [run, isOver]);
  if (!stays || successor.value || !hasToken()) return null;
  const parameters = Object.entries(mission.value?.parameters ?? {});
  const change = (name) => (event) => setGiven({ ...given, [name]: event.target.value });

  async function begin(event) {
    event.preventDefault();
    setBusy(true);
    setProblem(null);
    const body = { belief: given.belief, idle: Number(given.idle || 0), given: given.given.split("\n").map((line) => line.trim()).filter(Boolean), values };
    try {
      go(addressOf((await write(`/v1/runs/${encodeURIComponent(run)}/missions`, body)).mission));
    } catch (error) {
      setProblem(error);
    }
    setBusy(false);
  }

  return html`<details class="card next">
    <summary>Next mission</summary>
    <form onSubmit=${begin}>
      <label class="field">Belief at the start
        <select value=${given.belief} onChange=${change("belief")}><option value="initial">the initial one</option><option value="keep">the last one of this mission</option></select></label>
      <label class="field">Idle steps before it <input type="number" min="0" max="10000" value=${given.idle} onInput=${change("idle")} /></label>
      ${parameters.map(([name, value]) => html`<label class="field" key=${name}>${name}
        <input value=${values[name] ?? value} onInput=${(event) => setValues({ ...values, [name]: event.target.value })} /></label>`)}
      <label class="field wide">What is known, one expression a line <textarea rows="2" placeholder="state.robot_at == Kitchen" value=${given.given} onInput=${change("given")}></textarea></label>
      <button class="primary" disabled=${busy}>${busy ? "Beginning…" : "Begin it"}</button>
    </form>
    <${Findings} problem=${problem} />
  </details>`;
}

// The model against what was seen: per skill and response, and which action was chosen at which belief.
import { Card, html, useState, useWidth } from "./ui.js";
import { briefAction, chance, percent, plain } from "./format.js";
import { alarms, at, points, selectStep, steps } from "./store.js";
import { summarised } from "./ribbons.js";

const SHOWN = 12;

export const Model = () => html`<div class="columns even">
  <${Alarms} />
  <${Card} id="expected" title="Expected against seen" note="The ring is how often the model expected a response, the dot how often it came; the bar holds the true frequency with 95 %.">
    <${Expected} />
  <//>
  <${Card} id="strip" title="Decision strip" note="What was chosen at which probability, in this mission. The larger a dot, the more often.">
    <${Strip} />
  <//>
</div>`;

// What the sequential tests have found, as the records tell it.
function Alarms() {
  const all = alarms.value;
  if (!all.length) return null;
  return html`<${Card} id="alarms" title="The model does not hold" className="alarms" note="Where the model is right, the probability that any such alarm ever comes is 1 % at most.">
    <div class="scroll" tabindex="0" role="region" aria-label="Table of alarms"><table>
      <thead><tr><th>Skill</th><th>Response</th><th class="num">Modelled</th><th class="num">Seen</th><th class="num">Uses</th><th class="num" title="The step at which it began">Since</th></tr></thead>
      <tbody>${all.map((each) => html`<tr onClick=${() => selectStep(each.since)}>
        <td class="action">${each.skill}</td><td class="response">${each.response}</td>
        <td class="num">${plain(each.modelled)}</td><td class="num mark">${plain(each.seen)}</td><td class="num">${each.uses}</td>
        <td class="num"><button class="row-step" aria-label=${`Step ${each.since}`}>${each.since}</button></td>
      </tr>`)}</tbody>
    </table></div>
  <//>`;
}

function counted() {
  const skills = new Map();
  for (const step of steps.value) {
    if (step.status !== "observed") continue;
    if (!skills.has(step.skill)) skills.set(step.skill, { uses: 0, responses: new Map() });
    const skill = skills.get(step.skill);
    skill.uses++;
    const predicted = step.predicted ?? {};
    const came = "…" in predicted && !(step.seen in predicted) ? "…" : step.seen;
    for (const name of new Set([...Object.keys(predicted), came])) {
      const both = skill.responses.get(name) ?? { expected: 0, seen: 0 };
      both.expected += predicted[name] ?? 0;
      if (name === came) both.seen++;
      skill.responses.set(name, both);
    }
  }
  return skills;
}

// The responses that were expected most. Which are shown does not depend on what came: else each rare one that came would look wrong.
function shown(responses) {
  const sorted = [...responses].sort((a, b) => (a[0] === "…") - (b[0] === "…") || b[1].expected - a[1].expected);
  if (sorted.length <= SHOWN) return sorted;
  const others = sorted.splice(SHOWN - 1).map(([, each]) => each);
  const sum = (of) => others.reduce((all, each) => all + each[of], 0);
  return [...sorted, ["all others", { expected: sum("expected"), seen: sum("seen") }]];
}

// Wilson's interval of a frequency.
function interval(seen, uses) {
  const z = 1.96;
  const share = seen / uses;
  const middle = (share + (z * z) / (2 * uses)) / (1 + (z * z) / uses);
  const half = (z * Math.sqrt((share * (1 - share)) / uses + (z * z) / (4 * uses * uses))) / (1 + (z * z) / uses);
  return [Math.max(0, middle - half), Math.min(1, middle + half)];
}

function Expected() {
  const [ref, size] = useWidth();
  const skills = counted();
  const room = Math.max(90, size - (size < 480 ? 132 : 250));
  const x = (share) => 8 + share * (room - 16);
  return html`<div class="expected" ref=${ref}>
    ${!skills.size && html`<p class="empty">Nothing has been observed yet.</p>`}
    ${[...skills].map(([name, { uses, responses }]) => html`<div class="skill" key=${name}>
      <h3>${name} <span class="muted">${uses} ${uses === 1 ? "use" : "uses"}</span></h3>
      <ul>${shown(responses).map(([response, { expected, seen }]) => {
        const [low, high] = interval(seen, uses);
        const share = expected / uses;
        const isOff = share < low || share > high;
        return html`<li class=${isOff ? "is-off" : ""} aria-label=${`${response}: expected ${percent(share)}, seen ${percent(seen / uses)}, ${seen} of ${uses}${isOff ? ", outside of the interval" : ""}`}>
          <span class="response-name">${response}</span>
          <svg width=${room} height="18" aria-hidden="true">
            <line class="rail" x1="8" x2=${room - 8} y1="9" y2="9" />
            <line class="error" x1=${x(low)} x2=${x(high)} y1="9" y2="9" />
            <circle class="ring" cx=${x(share)} cy="9" r="5.5" />
            <circle class="dot" cx=${x(seen / uses)} cy="9" r="3.5" />
          </svg>
          <span class="number">${seen}/${uses}${isOff ? html` <b title="The model's frequency is outside of the interval">!</b>` : ""}</span>
        </li>`;
      })}</ul>
    </div>`)}
  </div>`;
}

function Strip() {
  const [ref, size] = useWidth();
  const [chosen, setChosen] = useState("");
  const doubtful = summarised(points.value).filter((row) => row.isDoubtful && !row.isNumber);
  const choices = doubtful.flatMap((row) => row.values.filter((value) => value !== "…" && !(value === "false" && row.values.includes("true"))).map((value) => `${row.name} = ${value}`));
  const wanted = choices.includes(chosen) ? chosen : choices[0];
  if (!wanted) return html`<div ref=${ref}><p class="empty">No variable is in doubt.</p></div>`;
  const [variable, value] = wanted.split(" = ");
  const actions = new Map();
  steps.value.forEach((step, i) => {
    const share = points.value[i]?.[variable]?.[value] ?? 0;
    if (!actions.has(step.action)) actions.set(step.action, []);
    actions.get(step.action).push({ share, step });
  });
  const ROW = 28;
  const isNarrow = size < 480;
  const room = Math.max(120, size - (isNarrow ? 120 : 190));
  const x = (share) => 10 + share * (room - 20);
  const listed = [...actions].sort((a, b) => mean(a[1]) - mean(b[1])).slice(0, 14);
  return html`<div class="strip" ref=${ref}>
    <label class="pick">Probability of <select value=${wanted} onChange=${(event) => setChosen(event.target.value)}>
      ${choices.map((each) => html`<option value=${each}>${each}</option>`)}</select></label>
    <div class="strip-rows">
      ${listed.map(([action, all]) => html`<div class="strip-row" key=${action}>
        <span class="value-name" title=${action}>${briefAction(action)}</span>
        <svg width=${room} height=${ROW} role="img" aria-label=${`${action}: chosen at ${all.slice(0, 12).map((each) => chance(each.share)).join(", ")}`}>
          <line class="rail" x1="10" x2=${room - 10} y1=${ROW / 2} y2=${ROW / 2} />
          ${together(all).map(({ share, at: here }) => html`<circle class=${here.includes(at.value) ? "is-now" : ""} cx=${x(share)} cy=${ROW / 2} r=${Math.min(12, 3.5 + 1.5 * Math.sqrt(here.length))} onClick=${() => selectStep(here[0].step)}><title>${`${chance(share)}: ${here.length > 1 ? `${here.length} steps` : `step ${here[0].step}`}`}</title></circle>`)}
        </svg>
      </div>`)}
      <div class="strip-row axis" aria-hidden="true"><span></span><span class="axis-ends" style=${{ width: `${room}px` }}><i>0</i><i>½</i><i>1</i></span></div>
    </div>
  </div>`;
}

// Decisions at one probability are one dot, the larger the more there are.
function together(all) {
  const found = new Map();
  for (const { share, step } of all) {
    const place = Math.round(share * 100);
    if (!found.has(place)) found.set(place, { share, at: [] });
    found.get(place).at.push(step);
  }
  return [...found.values()];
}

const mean = (all) => all.reduce((sum, each) => sum + each.share, 0) / all.length;

// Why a decision was made: the margin and its lines of the documents, what each response leads to, and the beliefs at
// which another action wins. The answer is computed when it is asked for.
import { Card, Findings, html, useEffect, useState, useWidth, width } from "./ui.js";
import { read, write, hasToken } from "./api.js";
import { briefAction, chance, percent, plusMinus, signed } from "./format.js";
import { at, record } from "./store.js";
import { addressOf, route } from "./route.js";
import { Tree } from "./tree.js";

const known = new Map();
// What a person has asked for need not be the better one now.
const elsewhere = (why) => (why.margin < 0 ? why.action : why.other);
const isPlanned = (why) => ["planner", "operator", "script"].includes(why.chosen_by);
// A solver answers without the lines while it compiles the model with marks at them.
const isWhole = (why) => Boolean(why.terms?.length) || !why.remark;
const asker = (why) => ({ operator: ", which an operator has asked for", script: ", which a script has asked for" })[why.chosen_by] ?? "";

export function Why() {
  const [instead, setInstead] = useState("");
  const [found, setFound] = useState(null);
  const [problem, setProblem] = useState(null);
  const [asked, setAsked] = useState(0);
  const step = at.value?.step;
  const { name } = route.value;
  useEffect(() => setInstead(""), [name, step]);
  useEffect(() => {
    if (!step) return;
    const path = `/v1/missions/${encodeURIComponent(name)}/decisions/${step}/why?instead=${encodeURIComponent(instead)}`;
    setProblem(null);
    setFound(known.get(path) ?? null);
    if (known.has(path)) return;
    let isWanted = true;
    const soon = setTimeout(
      () =>
        read(path).then(
          (why) => {
            // Before the outcome is there, it does not say what was seen.
            if (at.value?.status && isWhole(why)) known.set(path, why);
            if (isWanted) setFound(why);
          },
          (error) => isWanted && setProblem(error),
        ),
      150,
    );
    return () => {
      isWanted = false;
      clearTimeout(soon);
    };
  }, [name, step, instead, asked]);
  if (!step) return html`<p class="empty">There is no decision yet.</p>`;
  const others = (record.value?.decided?.actions ?? []).map((each) => each.action).filter((each) => each !== at.value.action);
  return html`<div class="why" aria-busy=${!found && !problem}>
    <p class="why-head">Why <span class="action">${at.value.action}</span>${found && asker(found)}
      <label> and not <select value=${instead} onChange=${(event) => setInstead(event.target.value)}>
        <option value="">the runner-up${found && !instead ? `, ${found.other}` : ""}</option>
        ${others.map((each) => html`<option value=${each}>${each}</option>`)}
      </select></label></p>
    <${Findings} problem=${problem} />
    ${!found && !problem && html`<p class="empty">An engine of its own is brought to this step…</p>`}
    ${found && html`<${Answer} why=${found} />`}
    ${found && !isWhole(found) && html`<p><button class="link" onClick=${() => setAsked(asked + 1)}>Ask again</button></p>`}
    ${step && html`<${Tree} key=${`tree ${name} ${step}`} name=${name} step=${step} seen=${at.value.seen} />`}
    ${step && html`<${WhatIf} key=${`${name} ${step}`} name=${name} step=${step} />`}
  </div>`;
}

const Answer = ({ why }) => html`<div class="columns even">
  <${Card} id="margin" title="Where the margin comes from" note=${verdict(why)}><${Terms} why=${why} /><//>
  <div class="stack">
    <${Card} id="flips" title="At which belief the choice changes" note=${why.flips?.length ? `Coloured: the action that is better now. Grey: the other one.${why.is_exact ? "" : " Pale: neither for certain."} The line is the belief now.` : ""}><${Flips} why=${why} /><//>
    <${Card} id="leads" title="What each response leads to"><${Leads} why=${why} /><//>
  </div>
</div>`;

function verdict(why) {
  if (why.is_close) {
    const more = why.simulations_to_tell ? `about ${Number(why.simulations_to_tell.toPrecision(2)).toLocaleString("en")} simulations would tell` : "no number of simulations is sure to tell";
    return `Too close to call against ${why.other}: ${more}.`;
  }
  return `${signed(why.margin)}${plusMinus(why.margin_stderr, why.margin)} over ${why.other}, ${why.is_exact ? "exactly" : `by ${why.planner}`}.`;
}

function Terms({ why }) {
  const [ref, size] = useWidth();
  const all = (why.terms ?? []).map((each) => ({ ...each, margin: each.value - each.other }));
  all.push({ place: "later steps", margin: (why.rest ?? 0) - (why.other_rest ?? 0) });
  const most = Math.max(...all.map((each) => Math.abs(each.margin))) || 1;
  const terms = all.filter((each) => Math.abs(each.margin) > 5e-5 * most);
  const room = Math.max(80, size - (width.value < 720 ? 78 : 250));
  const x = (value) => room / 2 + (value / most) * (room / 2 - 2);
  const address = addressOf(route.value.name, "documents", route.value.step);
  return html`<div class="terms" ref=${ref}>
    ${!terms.length && html`<p class="empty">${why.remark || "No line of the documents tells them apart."}</p>`}
    <ul>${terms.slice(0, 12).map((each) => html`<li aria-label=${`${signed(each.margin, 3)} from ${each.place}`}>
      <span class="term-place">${each.place === "later steps" ? each.place : html`<a href=${address}>${each.place}</a>`}</span>
      <svg width=${room} height="18" aria-hidden="true">
        <line class="rail" x1=${room / 2} x2=${room / 2} y1="0" y2="18" />
        <rect class=${each.margin > 0 ? "for" : "against"} x=${Math.min(x(0), x(each.margin))} y="4" width=${Math.max(1, Math.abs(x(each.margin) - x(0)))} height="10" rx="2" />
      </svg>
      <span class="number">${signed(each.margin, 2)}</span>
    </li>`)}</ul>
    ${why.remark && terms.length > 0 && html`<p class="aside">${why.remark}</p>`}
  </div>`;
}

function changeOf(why, flip, rises) {
  if (why.is_exact) return `${briefAction(elsewhere(why))} wins ${rises ? "above" : "below"} ${chance((flip.low + flip.high) / 2)}`;
  if (flip.low <= 0 && flip.high >= 1) return "too close to call whatever it is";
  return `the choice ${flip.is_checked ? "changes" : "may change"} between ${chance(flip.low)} and ${chance(flip.high)}`;
}

// A strip for each variable whose probability would change the choice: which action wins at which probability.
function Flips({ why }) {
  const [ref, size] = useWidth();
  const room = Math.max(100, size);
  const x = (value) => value * room;
  const flips = (why.flips ?? []).slice(0, 5);
  return html`<div class="flips" ref=${ref}>
    ${!flips.length && html`<p class="empty">${isPlanned(why) ? `No probability of one value makes ${elsewhere(why)} better, as far as was looked.` : `It was chosen by ${why.chosen_by}, whatever is believed.`}</p>`}
    ${flips.map((flip) => {
      const rises = (flip.low + flip.high) / 2 > flip.now;
      // Where neither action is certain to be better now, or the choice may not change, no other side is known.
      const hasOtherSide = flip.is_checked && (flip.now <= flip.low || flip.now >= flip.high);
      const [from, to] = rises ? [flip.high, 1] : [0, flip.low];
      return html`<figure class="flip">
        <figcaption>P(<span class="code">${flip.variable} = ${flip.value}</span>) is ${chance(flip.now)}; ${changeOf(why, flip, rises)}</figcaption>
        <svg width=${room} height="22" aria-hidden="true">
          <rect class="this" x="0" y="3" width=${room} height="16" rx="3" />
          <rect class="between" x=${x(flip.low)} y="3" width=${Math.max(1, x(flip.high) - x(flip.low))} height="16" />
          ${hasOtherSide && html`<rect class="other" x=${x(from)} y="3" width=${Math.max(1, x(to) - x(from))} height="16" rx="3" />`}
          <line class="now" x1=${x(flip.now)} x2=${x(flip.now)} y1="0" y2="22" />
        </svg>
      </figure>`;
    })}
  </div>`;
}

const Leads = ({ why }) => html`<ul class="leads">
  ${(why.expected ?? []).map((each) => html`<li class=${each.is_seen ? "is-seen" : ""}>
    <p><span class="response">${each.response}</span> <span class="muted">${percent(each.probability)}</span>${each.is_seen && html` <b>seen</b>`}</p>
    <p class="muted">${each.action ? html`goal ${chance(each.goal_probability ?? 0)}; next would be <span class="response">${each.action}</span>, worth ${signed(each.value)}` : `goal ${chance(each.goal_probability ?? 0)}; the mission would be over`}</p>
  </li>`)}
</ul>`;

// The decision anew: without an action, without a skill, with another belief, with another number in a document.
function WhatIf({ name, step }) {
  const [given, setGiven] = useState({ forbid: "", without: "", believe: "", change: "" });
  const [found, setFound] = useState(null);
  const [problem, setProblem] = useState(null);
  const [busy, setBusy] = useState(false);
  if (!hasToken()) return null;
  const fields = [
    ["forbid", "Without this action now", at.value?.action ?? ""],
    ["without", "Without this skill for good", at.value?.skill ?? ""],
    ["believe", "With another belief", "variable=value:0.5"],
    ["change", "With another number in the documents", "file:line=number"],
  ];
  async function ask(event) {
    event.preventDefault();
    setBusy(true);
    setProblem(null);
    const body = {};
    for (const [key] of fields) if (given[key].trim()) body[key] = [given[key].trim()];
    try {
      setFound(await write(`/v1/missions/${encodeURIComponent(name)}/decisions/${step}/whatif`, body));
    } catch (error) {
      setFound(null);
      setProblem(error);
    }
    setBusy(false);
  }
  return html`<${Card} id="whatif" title="What if" className="whatif" note="The step is decided anew; the mission is not touched.">
    <form onSubmit=${ask}>
      ${fields.map(([key, label, hint]) => html`<label class="field">${label}<input value=${given[key]} placeholder=${hint} onInput=${(event) => setGiven({ ...given, [key]: event.target.value })} /></label>`)}
      <button class="primary" disabled=${busy}>${busy ? "Deciding…" : "Decide anew"}</button>
    </form>
    <div role="status">${found && html`<p class="supposed">${found.action === found.before ? "Still " : "Then "}<b class="action">${found.action}</b>, worth <b>${signed(found.value)}</b>${found.action === found.before ? "" : html`, in place of ${found.before} with ${signed(found.value_before)}`}.</p>
      ${(found.supposed ?? []).map((each) => html`<p class="muted">Supposed: ${each}</p>`)}
      ${found.remark && html`<p class="muted">${found.remark}</p>`}`}</div>
    <${Findings} problem=${problem} />
  <//>`;
}

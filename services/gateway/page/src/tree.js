// The tree below a decision: its best actions and likeliest responses, each belief planned anew. It is grown when it
// is asked for, and deeper when that is asked for.
import { Card, Findings, html, useEffect, useState } from "./ui.js";
import { read } from "./api.js";
import { chance, percent, plusMinus, signed } from "./format.js";

const DEEPEST = 4;
const BRANCHES = 3;

export function Tree({ name, step, seen }) {
  const [depth, setDepth] = useState(0);
  const [found, setFound] = useState(null);
  const [problem, setProblem] = useState(null);
  const [busy, setBusy] = useState(false);
  useEffect(() => {
    if (!depth) return;
    let isWanted = true;
    setBusy(true);
    setProblem(null);
    read(`/v1/missions/${encodeURIComponent(name)}/decisions/${step}/tree?depth=${depth}&branches=${BRANCHES}`)
      .then(
        (tree) => isWanted && setFound(tree),
        (error) => isWanted && setProblem(error),
      )
      .then(() => isWanted && setBusy(false));
    return () => {
      isWanted = false;
    };
  }, [depth]);
  const ask = (wanted) => html`<button class="quiet" disabled=${busy} onClick=${() => setDepth(wanted)}>${busy ? "Growing…" : wanted > 2 ? "One decision deeper" : "Show the tree"}</button>`;
  return html`<${Card} id="tree" title="Looking ahead" className="tree" note="The best actions with value, error and simulations; after each the likeliest responses. Every belief is planned anew.">
    <${Findings} problem=${problem} />
    <div role="status" aria-busy=${busy}>${found && html`<${Actions} node=${found.root} seen=${seen} />
      ${!found.is_whole && html`<p class="aside">The rest was left out for its size.</p>`}`}</div>
    ${!depth ? ask(2) : depth < DEEPEST && ask(depth + (problem ? 0 : 1))}
  <//>`;
}

// What was chosen and seen stands open. A branch is a details element, so that keys and readers know it.
function Actions({ node, seen }) {
  if (!node.actions?.length) return html`<p class="muted">over; goal ${chance(node.goal_probability)}</p>`;
  return html`<ul class="branches">${node.actions.map((each, place) => html`<li>
    ${each.after?.length
      ? html`<details open=${seen !== undefined && place === 0}><summary><${Action} each=${each} /></summary>
          <ul class="branches">${each.after.map(([response, probability, next]) => html`<li><details open=${response === seen}>
            <summary><span class="response">${response}</span> <span class="muted">${percent(probability)}, goal ${chance(next.goal_probability)}${response === seen ? ", seen" : ""}</span></summary>
            <${Actions} node=${next} />
          </details></li>`)}</ul>
        </details>`
      : html`<${Action} each=${each} />`}
  </li>`)}</ul>`;
}

const Action = ({ each }) => html`<span class="action">${each.action}</span> <b>${signed(each.q)}</b><span class="muted">${plusMinus(each.stderr, each.q)}</span>${each.n > 0 && html` <span class="muted">${each.n.toLocaleString("en")} simulations</span>`}`;

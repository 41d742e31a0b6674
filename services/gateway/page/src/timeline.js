// The timeline is the slider: one field for each step, coloured by skill, with marks for what was surprising.
import { html, useWidth } from "./ui.js";
import { colour, textOn } from "./colours.js";
import { briefAction, chance, plain } from "./format.js";
import { at, index, isLive, last, selectStep, state, steps } from "./store.js";

const HEIGHT = 26;
const SURPRISING = 2.0; // nats: less probable than one in seven

export const placeOf = (i, room, head = 0) => head + (i / Math.max(1, steps.value.length)) * (room - head);

export const isSurprising = (step) => step.impossible || step.surprise >= SURPRISING;
export const isAsked = (step) => step.chosen_by === "operator" || step.chosen_by === "script";
export const hasFailed = (step) => Boolean(step.status) && step.status !== "observed";

export const skillColours = () => {
  const found = new Map();
  for (const step of steps.value) if (!found.has(step.skill)) found.set(step.skill, colour(found.size));
  return found;
};

export function Cursor({ room, height, head = 0 }) {
  if (index.value < 0) return null;
  const from = placeOf(index.value, room, head);
  const to = placeOf(index.value + 1, room, head);
  return html`<rect class="cursor" x=${from + 0.75} y="0.75" width=${Math.max(1.5, to - from - 1.5)} height=${height - 1.5} rx="2" />`;
}

export function Timeline() {
  const [ref, room] = useWidth();
  const all = steps.value;
  const skills = skillColours();
  const current = at.value;
  if (!all.length) return html`<div class="timeline" ref=${ref}></div>`;
  const first = all[0].step;
  const newest = last.value.step;
  return html`<div class="timeline">
    <div class="timeline-track" ref=${ref}>
      <svg width=${room} height=${HEIGHT + 12} aria-hidden="true">
        <g transform="translate(0 12)">
          ${room > 0 && blocks(all, room, skills)}
          <${Cursor} room=${room} height=${HEIGHT} />
        </g>
        ${room > 0 && marks(all, room)}
      </svg>
      <input type="range" min=${first} max=${newest} step="1" value=${current.step}
        aria-label="Step" aria-valuetext=${`step ${current.step}, ${current.action}`}
        onInput=${(event) => selectStep(Number(event.target.value))} />
    </div>
    <div class="timeline-foot">
      <ul class="legend" aria-label="Skills">
        ${[...skills].map(([name, fill]) => html`<li><i style=${{ background: fill }}></i>${name}</li>`)}
        ${all.some(isSurprising) && html`<li><svg width="10" height="9" aria-hidden="true"><path class="surprise" d="M5 0 l5 9 h-10z" /></svg>surprise</li>`}
        ${all.some(hasFailed) && html`<li><svg width="9" height="9" aria-hidden="true"><path class="failed" d="M1 1 l7 7 M8 1 l-7 7" /></svg>not observed</li>`}
        ${all.some(isAsked) && html`<li><svg width="9" height="9" aria-hidden="true"><rect class="asked" x="1" y="1" width="7" height="7" rx="1" /></svg>asked for by a person</li>`}
        ${all.some((step) => step.adopted) && html`<li><svg width="9" height="9" aria-hidden="true"><path class="adopted" d="M4.5 0 l4.5 4.5 l-4.5 4.5 l-4.5 -4.5z" /></svg>new model</li>`}
      </ul>
      <div class="stepper">
        <button class="quiet" onClick=${() => selectStep(current.step - 1)} disabled=${current.step <= first} aria-label="Step before">‹</button>
        <span class="stepper-place"><b>${current.step}</b> of ${newest}</span>
        <button class="quiet" onClick=${() => selectStep(current.step + 1)} disabled=${current.step >= newest} aria-label="Step after">›</button>
        <button class=${`quiet newest ${isLive.value ? "is-on" : ""}`} aria-pressed=${isLive.value} onClick=${() => selectStep(null)}>
          ${state.value?.phase === "ended" ? "Last" : "Newest"}</button>
      </div>
    </div>
  </div>`;
}

// Neighbours of one skill are one block where fields are too narrow to be told apart.
function blocks(all, room, skills) {
  const field = placeOf(1, room) - placeOf(0, room);
  const gap = field > 6 ? 2 : 0;
  const found = [];
  for (let i = 0; i < all.length; ) {
    let j = i + 1;
    if (!gap) while (j < all.length && all[j].skill === all[i].skill) j++;
    const fill = skills.get(all[i].skill);
    const size = Math.max(1, (j - i) * field - gap);
    const name = briefAction(all[i].action);
    const isOpen = !all[i].status;
    found.push(html`<rect class=${isOpen ? "open" : ""} x=${placeOf(i, room)} y="0" width=${size} height=${HEIGHT} rx="2" style=${{ fill, stroke: isOpen ? fill : "none" }} />`);
    if (size > name.length * 7.2 + 12)
      found.push(html`<text x=${placeOf(i, room) + 6} y="17" style=${{ fill: isOpen ? "var(--ink)" : textOn(fill) }}>${name}</text>`);
    i = j;
  }
  return found;
}

function marks(all, room) {
  return all.map((step, i) => {
    const x = placeOf(i + 0.5, room);
    return [
      isSurprising(step) && html`<path class="surprise" d=${`M${x} 1 l4.5 8 h-9z`}><title>${`step ${step.step}: surprise ${step.impossible ? "without end" : plain(step.surprise)}, expected with ${chance(step.expected)}`}</title></path>`,
      hasFailed(step) && html`<path class="failed" d=${`M${x - 3.5} 2 l7 7 M${x + 3.5} 2 l-7 7`} />`,
      isAsked(step) && html`<rect class="asked" x=${placeOf(i + 0.5, room) - (isSurprising(step) || hasFailed(step) ? 12 : 3.5)} y="2" width="7" height="7" rx="1" />`,
      step.adopted && html`<path class="adopted" d=${`M${placeOf(i, room)} 1 l4 4 l-4 4 l-4 -4z`} />`,
    ];
  });
}

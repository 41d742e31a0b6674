// One mission: where it is, what was decided, and the views below.
import { Card, Findings, html, useEffect } from "./ui.js";
import { addressOf, route, VIEWS } from "./route.js";
import { alarms, at, close, connection, index, isGone, isLive, isRead, last, loadRecord, mission, open, pictures, points, problem, state, steps } from "./store.js";
import { chance, ending, phase } from "./format.js";
import { Controls, LeftOut } from "./steering.js";
import { Next } from "./next.js";
import { Sentence } from "./sentence.js";
import { Timeline } from "./timeline.js";
import { Ribbons } from "./ribbons.js";
import { Values } from "./values.js";
import { Why } from "./why.js";
import { Model } from "./model.js";
import { Steps, Table } from "./steps.js";
import { Documents } from "./documents.js";
import { Drawn } from "./drawn.js";
import { System } from "./system.js";

const TITLES = { overview: "Overview", why: "Why", steps: "Steps", model: "Model", documents: "Documents", system: "System" };
const PAGES = { overview: Overview, why: Why, steps: Steps, model: Model, documents: Documents, system: System };

export function Mission() {
  const { name, view } = route.value;
  useEffect(() => {
    open(name);
    return close;
  }, [name]);
  const step = at.value?.step;
  const isOpen = at.value && !at.value.status;
  useEffect(() => {
    if (!step) return;
    // Whoever drags the slider passes many steps.
    const soon = setTimeout(() => loadRecord(step), 60);
    return () => clearTimeout(soon);
  }, [name, step, isOpen]);
  if (problem.value && !mission.value)
    return html`<main id="main" class="page"><h1>${name}</h1><${Findings} problem=${problem.value} /><p><a href="#/">All missions</a></p></main>`;
  const Page = PAGES[view];
  return html`<main id="main" class="page">
    <${Head} />
    <${Next} />
    <div class="hero card">
      <${Sentence} />
      <${Timeline} />
    </div>
    <nav class="views" aria-label="Views">
      ${VIEWS.map((each) => html`<a href=${addressOf(name, each, route.value.step)} aria-current=${each === view ? "page" : null}>${TITLES[each]}</a>`)}
    </nav>
    <${Page} />
  </main>`;
}

const GONE = "Its aos-up has gone before the mission ended. Where it was killed, aos-up --resume takes the mission up.";

function Head() {
  const view = mission.value;
  const now = state.value;
  const isOver = now?.phase === "ended";
  const ended = isOver ? now.ending : isGone.value ? "killed" : null;
  const endings = at.value && (isLive.value || at.value === last.value ? at.value.endings_after ?? at.value.endings : at.value.endings_after ?? at.value.endings);
  const goal = endings?.goal ?? now?.goal_probability;
  return html`<header class="head">
    <div class="head-name">
      <h1>${view?.robot ?? " "}</h1>
      <p class="muted">${route.value.name}</p>
    </div>
    <div class="head-state">
      <p class=${`phase is-${ended ?? now?.phase ?? "waiting"}`} role="status">
        <i class=${isOver || !view?.is_running ? "still-dot" : "pulse"}></i>${ended ? ending(ended) : isRead.value ? phase(now?.phase ?? "waiting") : "Reading"}
        ${!isLive.value && html`<span class="past">showing step ${at.value?.step}</span>`}
      </p>
      <p class="remark">${isGone.value ? GONE : now?.remark ?? ""}</p>
      <${Alarm} />
    </div>
    <div class="goal" title="How probable the goal is, as the belief has it">
      <span class="goal-number">${chance(goal)}</span><span class="goal-word">goal</span>
      <svg viewBox="0 0 100 4" preserveAspectRatio="none" aria-hidden="true"><rect width="100" height="4" class="goal-rail" /><rect width=${(goal ?? 0) * 100} height="4" class="goal-bar" /></svg>
      ${endings?.failure > 0.0005 && html`<span class="failure">failure ${chance(endings.failure)}</span>`}
    </div>
    <${Controls} />
  </header>`;
}

function Alarm() {
  const skills = [...new Set(alarms.value.map((each) => each.skill))];
  if (!skills.length) return null;
  const { name, step } = route.value;
  return html`<p><a class="alarm" href=${addressOf(name, "model", step)}><svg width="11" height="11" viewBox="0 0 10 10" aria-hidden="true"><path d="M5 0 l5 9.5 h-10z" /></svg>The model of ${skills.join(", ")} does not hold</a></p>`;
}

function Overview() {
  return html`<div class="columns overview">
    <div class="stack">
      <${Card} id="belief" title="Belief" note=${beliefNote()}><${Ribbons} /><//>
      <${Drawn} />
      <${Card} id="all-steps" title="Steps"><${Table} /><//>
    </div>
    <div class="stack">
      <${Card} id="values" title="Values of the actions"><${Values} /><${LeftOut} /><//>
      ${pictures.value.length > 0 && html`<${Card} id="world" title="World"><${Picture} /><//>`}
    </div>
  </div>`;
}

const beliefNote = () => (points.value.length ? `After ${isLive.value ? "the newest step" : `step ${at.value?.step}`}.` : "");

function Picture() {
  const known = pictures.value;
  const wanted = at.value?.step ?? 0;
  const shown = known.filter((step) => step <= wanted).at(-1) ?? known[0];
  if (shown === undefined) return null;
  return html`<figure class="picture"><img src=${`/v1/missions/${encodeURIComponent(route.value.name)}/world/${shown}`} alt=${`The world after step ${shown}`} />
    <figcaption class="note">After step ${shown}</figcaption></figure>`;
}

// The list of runs, and a new mission.
import { Findings, html, useEffect, useState } from "./ui.js";
import { hasToken, read, send, write } from "./api.js";
import { addressOf, go } from "./route.js";
import { loadRuns, problem, runs } from "./store.js";
import { ending, moment } from "./format.js";

export function Home() {
  const all = runs.value;
  const living = (all ?? []).filter((run) => run.is_running);
  const past = (all ?? []).filter((run) => !run.is_running);
  return html`<main class="home" id="main">
    <div class="home-list">
      <h1>Missions</h1>
      <${Findings} problem=${problem.value} />
      ${all === null && !problem.value && html`<p class="empty">Looking for runs…</p>`}
      ${living.length > 0 && html`<h2 class="group">Running</h2><ul class="runs">${living.map((run) => html`<${Run} key=${run.run} run=${run} />`)}</ul>`}
      ${past.length > 0 && html`<h2 class="group">Past</h2><ul class="runs">${past.map((run) => html`<${Run} key=${run.run} run=${run} />`)}</ul>`}
      ${all?.length === 0 && html`<div class="welcome">
        <p>No mission has run in this folder yet.</p>
        <p>Start one here, or with <code>aos-up</code> in a terminal: it appears by itself.</p>
      </div>`}
    </div>
    ${!(problem.value && all === null) && html`<aside class="home-aside"><${Start} /></aside>`}
  </main>`;
}

function Run({ run }) {
  const missions = run.missions ?? [];
  const newest = missions.at(-1) ?? run.run;
  const file = run.deploy_file?.split("/").at(-1)?.replace(/\.ya?ml$/, "");
  return html`<li class=${run.is_running ? "run is-running" : "run"}>
    <a href=${addressOf(newest)}>
      <span class="run-name"><b>${run.robot}</b>${file && file !== run.robot ? html`<span class="muted">${file}</span>` : ""}</span>
      <span class=${`ending is-${run.ending}`}>${run.is_running && html`<i class="pulse"></i>`}${ending(run.ending)}</span>
      <span class="run-when muted">${moment(run.started) || run.endpoint}</span>
    </a>
    ${missions.length > 1 && html`<details><summary>${missions.length} missions</summary><ul class="of-run">${missions.slice().reverse().map((name, i) => html`<li><a href=${addressOf(name)}>Mission ${missions.length - i}</a></li>`)}</ul></details>`}
  </li>`;
}

export function Start() {
  const [projects, setProjects] = useState(null);
  const [project, setProject] = useState("");
  const [options, setOptions] = useState({ model: true, stay: false, seed: "" });
  const [failed, setFailed] = useState(null);
  const [busy, setBusy] = useState("");
  const load = () => read("/v1/projects").then((found) => {
    setProjects(found.projects);
    setProject((before) => before || found.projects[0]?.deploy_file || "");
  }, setFailed);
  useEffect(() => void load(), []);

  async function start(event) {
    event.preventDefault();
    setBusy("Starting…");
    setFailed(null);
    try {
      const body = { deploy_file: project, model: options.model, stay: options.stay };
      if (options.seed !== "") body.seed = Number(options.seed);
      const started = await write("/v1/runs", body);
      await loadRuns();
      go(addressOf(started.mission));
    } catch (error) {
      setFailed(error);
    }
    setBusy("");
  }

  async function upload(event) {
    const file = event.target.files[0];
    if (!file) return;
    setBusy(`Checking ${file.name}…`);
    setFailed(null);
    try {
      const kept = await send("/v1/projects", file);
      await load();
      setProject(kept.deploy_file);
    } catch (error) {
      setFailed(error);
    }
    setBusy("");
    event.target.value = "";
  }

  const change = (name, value) => setOptions({ ...options, [name]: value });
  if (!hasToken())
    return html`<section class="card start" aria-labelledby="start"><h2 id="start">New mission</h2>
      <p class="note">Open the address that <code>aos serve</code> prints, to start missions here. Without it this page only reads.</p></section>`;
  return html`<section class="card start" aria-labelledby="start">
    <h2 id="start">New mission</h2>
    <form onSubmit=${start}>
      <label class="field">Project
        <select value=${project} onChange=${(event) => setProject(event.target.value)}>
          ${projects?.map((each) => html`<option value=${each.deploy_file}>${each.project}${each.is_uploaded ? " (uploaded)" : ""}</option>`)}
          ${!projects?.length && html`<option value="">${projects ? "No deploy file in this folder" : "Loading…"}</option>`}
        </select></label>
      <label class="field">Seed <input inputmode="numeric" pattern="[0-9]*" placeholder="that of the file" value=${options.seed} onInput=${(event) => change("seed", event.target.value)} /></label>
      <label class="check"><input type="checkbox" checked=${options.model} onChange=${(event) => change("model", event.target.checked)} /> Skills are played by their documents; no robot moves</label>
      <label class="check"><input type="checkbox" checked=${options.stay} onChange=${(event) => change("stay", event.target.checked)} /> Stay for further missions</label>
      <button class="primary" disabled=${!project || Boolean(busy)}>Start mission</button>
      <p role="status" class="note">${busy}</p>
    </form>
    <hr />
    <label class="button">Upload a bundle…<input type="file" class="visually-hidden" onChange=${upload} accept=".zip,.tar,.gz,.tgz,.xz,.bz2" /></label>
    <p class="note">An archive of documents. It is checked first, and played by its own documents.</p>
    <${Findings} problem=${failed} />
  </section>`;
}

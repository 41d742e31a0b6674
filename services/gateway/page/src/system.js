// The system of a mission: its processes and their logs, its documents' revisions, new documents.
import { Card, Findings, html, useEffect, useState } from "./ui.js";
import { hasToken, read, readText, send, write } from "./api.js";
import { mission, reports, services } from "./store.js";
import { moment } from "./format.js";

export function System() {
  const view = mission.value;
  const [run, setRun] = useState(null);
  const [processes, setProcesses] = useState(null);
  const [bundles, setBundles] = useState([]);
  const [shown, setShown] = useState("");
  const [text, setText] = useState("");
  const [problem, setProblem] = useState(null);
  const name = view && encodeURIComponent(view.run);
  useEffect(() => {
    if (!name) return;
    read(`/v1/runs/${name}`).then(setRun, setProblem);
    read(`/v1/runs/${name}/services`).then(setProcesses, setProblem);
    read(`/v1/runs/${name}/bundles`).then((found) => setBundles(found.entries), () => setBundles([]));
  }, [name, reports.value.length, services.value.size]);
  const first = processes?.services.find((each) => each.service === "solver")?.service ?? processes?.services[0]?.service;
  const log = shown || first;
  useEffect(() => {
    if (!name || !log) return;
    const load = () => readText(`/v1/runs/${name}/logs/${log}?tail=60000`).then(setText, setProblem);
    load();
    const again = view.is_running ? setInterval(load, 2000) : null;
    return () => clearInterval(again);
  }, [name, log, view?.is_running]);
  if (!view) return null;
  return html`<div class="columns">
    <${Card} id="logs" title="Logs" className="wide">
      <div class="files" role="tablist" aria-label="Processes">
        ${(processes?.services ?? []).map((each) => html`<button role="tab" aria-selected=${each.service === log} onClick=${() => setShown(each.service)}>
          ${view.is_running && services.value.has(each.service) && html`<i class=${`presence ${services.value.get(each.service) ? "is-there" : ""}`} title=${services.value.get(each.service) ? "on the bus" : "not on the bus"}></i>`}${each.service}</button>`)}
      </div>
      <pre class="source log" tabindex="0" aria-label=${`Log of ${log}`}>${text || "The log is empty."}</pre>
      <${Findings} problem=${problem} />
    <//>
    <div class="stack">
      <${Card} id="run" title="Run">
        ${run && html`<dl class="facts">
          <div><dt>Robot</dt><dd>${run.robot}</dd></div>
          <div><dt>Started</dt><dd>${moment(run.started)}</dd></div>
          <div><dt>Deploy file</dt><dd class="path">${run.deploy_file}</dd></div>
          <div><dt>Directory</dt><dd class="path">${run.directory}</dd></div>
          <div><dt>Seed</dt><dd>${view.mission?.seed ?? run.seed}</dd></div>
          ${run.is_played && html`<div><dt>Skills</dt><dd>played by their documents</dd></div>`}
          ${run.sandbox && html`<div><dt>Sandbox</dt><dd>${run.sandbox}</dd></div>`}
        </dl>`}
        ${(processes?.ends ?? []).map((end) => html`<p class="aside"><b>${end.name}</b> ended after ${end.after_s.toFixed(1)} s, ${end.how}: ${end.then}</p>`)}
        ${run?.is_running && run.directory && hasToken() && html`<${End} run=${view.run} ended=${setRun} />`}
      <//>
      <${Card} id="bundles" title="Documents">
        <ul class="bundles">${bundles.map((each) => html`<li><b>${each.project}</b> revision ${each.revision}<span class="muted">${each.skills.join(", ")}</span></li>`)}</ul>
        ${view.is_running && html`<${Push} run=${view.run} />`}
      <//>
    </div>
  </div>`;
}

// A system that was started here has no terminal for Ctrl-C.
function End({ run, ended }) {
  const [problem, setProblem] = useState(null);
  const [isAsked, setIsAsked] = useState(false);
  const end = () => {
    setIsAsked(true);
    write(`/v1/runs/${encodeURIComponent(run)}/stop`).then(ended, (error) => {
      setProblem(error);
      setIsAsked(false);
    });
  };
  return html`<p><button class="stop" disabled=${isAsked} onClick=${end}>End the system</button></p><${Findings} problem=${problem} />`;
}

function Push({ run }) {
  const [problem, setProblem] = useState(null);
  const [told, setTold] = useState("");
  const last = reports.value[0];
  const refused = last?.is_accepted === false && { message: `${last.source || last.project} was refused; nothing has changed`, diagnostics: last.diagnostics };
  async function push(event) {
    const file = event.target.files[0];
    if (!file) return;
    setTold(`Sending ${file.name}…`);
    setProblem(null);
    try {
      const report = await send(`/v1/runs/${encodeURIComponent(run)}/bundles`, file);
      const news = [...(report.added ?? []), ...(report.changed ?? [])].join(", ");
      setTold(`Accepted: revision ${report.revision}${news ? `, ${news}` : ", nothing new"}.`);
    } catch (error) {
      setTold("");
      setProblem(error);
    }
    event.target.value = "";
  }
  return html`<div class="push">
    ${hasToken()
      ? html`<label class="button">Give it documents…<input type="file" class="visually-hidden" onChange=${push} accept=".zip,.tar,.gz,.tgz,.xz,.bz2,.ef,.sd,.am,.lf,.json" /></label>
          <p class="note">A document, or an archive of some. They take over at a decision, and the mission goes on.</p>`
      : html`<p class="note">Open the address that <code>aos serve</code> prints to change something here.</p>`}
    <p role="status">${told}</p>
    <${Findings} problem=${problem ?? refused} />
  </div>`;
}

// The documents, at the lines that the step is about: the skill's model, and the rule that gave the response.
import { Card, Findings, html, useEffect, useRef, useState } from "./ui.js";
import { read } from "./api.js";
import { at, mission, steps } from "./store.js";
import { route } from "./route.js";

export function Documents() {
  const [found, setFound] = useState(null);
  const [problem, setProblem] = useState(null);
  const [chosen, setChosen] = useState("");
  const step = at.value;
  const revision = step?.revision ?? 0;
  const { name } = route.value;
  useEffect(() => {
    let isWanted = true;
    read(`/v1/missions/${encodeURIComponent(name)}/documents?revision=${revision}`).then(
      (documents) => isWanted && (setFound(documents), setProblem(null)),
      (error) => isWanted && setProblem(error),
    );
    return () => (isWanted = false);
  }, [name, revision, Boolean(mission.value)]);
  useEffect(() => setChosen(""), [step?.skill]);
  if (problem) return html`<${Findings} problem=${problem} />`;
  if (!found) return html`<p class="empty">Reading the documents…</p>`;
  const lines = (found.skills[step?.skill] ?? []).filter((each) => each.what === "model" || each.what === `rule ${step?.seen}`);
  const file = chosen || lines[0]?.file || found.files[0]?.name;
  const text = found.files.find((each) => each.name === file)?.text ?? "";
  const about = lines.map((each) => each.file);
  return html`<${Card} id="documents" title=${`Documents of ${found.project}`} note=${`Revision ${found.revision}${step ? `; the lines of ${step.skill} are marked` : ""}.`}>
    <div class="files" role="tablist" aria-label="Files">
      ${found.files.map((each) => html`<button role="tab" aria-selected=${each.name === file} class=${about.includes(each.name) ? "is-about" : ""} onClick=${() => setChosen(each.name)}>${each.name}</button>`)}
    </div>
    <${Source} key=${file} text=${text} marked=${lines.filter((each) => each.file === file)} />
  <//>`;
}

function Source({ text, marked }) {
  const box = useRef(null);
  useEffect(() => {
    const line = box.current?.querySelector(".is-marked");
    if (line) box.current.scrollTop = Math.max(0, line.offsetTop - 60);
  }, [marked.map((each) => each.first).join()]);
  return html`<pre class="source" ref=${box} tabindex="0"><code>${text.split("\n").map((line, i) => {
    const here = marked.find((each) => each.first <= i + 1 && i + 1 <= each.last);
    return html`<span class=${here ? "line is-marked" : "line"} data-line=${i + 1}>${line || " "}\n</span>`;
  })}</code></pre>`;
}

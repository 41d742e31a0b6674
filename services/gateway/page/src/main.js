// The page: the bar on top, and below it the list or a mission.
import { render } from "preact";
import { html, useEffect, useState } from "./ui.js";
import { addressOf, go, route, startRouting } from "./route.js";
import { at, connection, listen, loadRuns, runs, selectStep, steps } from "./store.js";
import { Home } from "./home.js";
import { Mission } from "./mission.js";

const THEME = "aos-theme";
const apply = (theme) => (theme ? (document.documentElement.dataset.theme = theme) : delete document.documentElement.dataset.theme);
apply(localStorage.getItem(THEME));

const CONNECTIONS = { live: "Live", lost: "Connection lost, trying again", connecting: "Connecting", over: "Recorded", missing: "No such mission", refused: "No access" };

function Page() {
  const { kind, name } = route.value;
  const isMission = kind === "missions" && name;
  useEffect(() => {
    if (kind === "runs" && name) openRun(name);
    else if (!isMission) {
      loadRuns();
      listen();
    }
  }, [kind, name]);
  return html`
    <a class="skip" href="#main" onClick=${(event) => { event.preventDefault(); document.getElementById("main")?.focus(); }}>To the content</a>
    <header class="bar">
      <a class="brand" href="#/" aria-label="AOS, all missions"><svg viewBox="0 0 32 32" width="22" height="22" aria-hidden="true"><rect width="32" height="32" rx="8" /><path d="M6 21c5 0 5-10 10-10s5 10 10 10" /><circle cx="16" cy="11" r="3.2" /></svg><span>AOS</span></a>
      ${isMission && html`<nav aria-label="Place"><a href="#/">Missions</a></nav>`}
      <span class="room"></span>
      <span class=${`connection is-${connection.value}`} role="status"><i></i>${isMission || ["lost", "refused"].includes(connection.value) ? CONNECTIONS[connection.value] : ""}</span>
      <${Theme} />
    </header>
    ${isMission ? html`<${Mission} key=${name} />` : html`<${Home} />`}`;
}

// `aos-up --page` knows a run, whose newest mission is meant.
async function openRun(name) {
  await loadRuns();
  const run = (runs.value ?? []).find((each) => each.run === name);
  go(addressOf(run?.missions?.at(-1) ?? name), { replace: true });
}

function Theme() {
  const [theme, setTheme] = useState(localStorage.getItem(THEME) ?? "");
  const isDark = theme ? theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  function turn() {
    const next = isDark ? "light" : "dark";
    localStorage.setItem(THEME, next);
    apply(next);
    setTheme(next);
  }
  return html`<button class="quiet theme" onClick=${turn} aria-label=${isDark ? "Light colours" : "Dark colours"} title=${isDark ? "Light colours" : "Dark colours"}>${isDark ? "☀" : "☾"}</button>`;
}

// Steps by the arrow keys, wherever no field has them.
addEventListener("keydown", (event) => {
  const isTyping = event.target instanceof Element && event.target.closest("input, select, textarea, .scroll, .source, [role=tab]");
  if (isTyping || event.ctrlKey || event.metaKey || event.altKey || !at.value) return;
  if (event.key === "ArrowLeft") selectStep(at.value.step - 1);
  else if (event.key === "ArrowRight") selectStep(at.value.step + 1);
  else if (event.key === "Home") selectStep(steps.value[0].step);
  else if (event.key === "End") selectStep(null);
  else return;
  event.preventDefault();
});

await startRouting();
render(html`<${Page} />`, document.getElementById("page"));

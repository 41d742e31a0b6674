// What the page knows: the runs, and of one mission its steps, its state, its services. Filled once by requests,
// then by the event stream.
import { batch, computed, signal } from "@preact/signals";
import { read } from "./api.js";
import { go, addressOf, route } from "./route.js";

export const runs = signal(null);
export const problem = signal(null);

export const mission = signal(null); // MissionView
export const state = signal(null); // MissionState
export const steps = signal([]);
export const points = signal([]); // the belief at the start, and after each step
export const records = new Map(); // step -> {decided, observed}
export const recordsChanged = signal(0);
export const services = signal(new Map());
export const progress = signal(null);
export const reports = signal([]);
export const connection = signal("connecting"); // live, lost, missing, refused, over
export const pictures = signal([]);
export const draws = signal(false); // the documents have a picture.py
export const successor = signal(null);
export const loadedIn = signal(null);

export const last = computed(() => steps.value.at(-1) ?? null);
export const isGivenUp = computed(() => state.value?.phase === "waiting" && !!state.value.remark);
export const isGone = computed(() => !!mission.value && !mission.value.is_running && state.value?.phase !== "ended");
export const isRead = computed(() => loadedIn.value !== null);
export const isLive = computed(() => route.value.step === null);
export const at = computed(() => {
  const all = steps.value;
  if (!all.length) return null;
  const wanted = route.value.step;
  if (wanted === null) return all.at(-1);
  return all[Math.min(Math.max(wanted - all[0].step, 0), all.length - 1)];
});
export const index = computed(() => (at.value ? at.value.step - steps.value[0].step : -1));
export const record = computed(() => {
  recordsChanged.value;
  return at.value ? records.get(at.value.step) ?? null : null;
});
// The alarms that stand at the step that is shown, with the step at which each began. A new model begins anew.
export const alarms = computed(() => {
  const standing = new Map();
  for (const step of steps.value.slice(0, index.value + 1)) {
    if (step.adopted) standing.clear();
    for (const each of step.drift ?? []) {
      const name = `${each.skill} ${each.response}`;
      standing.set(name, { ...each, since: standing.get(name)?.since ?? step.step });
    }
  }
  return [...standing.values()];
});

// An outcome, the next decision and the states around them come within milliseconds, and are drawn together.
const TOGETHER_MS = 30;
const MOST_LOOKS = 3;

let source = null;
let looks = 0;
let waiting = [];
let isFlushing = false;

export function selectStep(step) {
  const { name, view } = route.value;
  const newest = last.value?.step;
  go(addressOf(name, view, step === null || step >= newest ? null : Math.max(step, steps.value[0]?.step ?? 1)), { replace: true });
}

export async function loadRuns() {
  try {
    runs.value = (await read("/v1/runs?limit=100")).runs;
    problem.value = null;
  } catch (error) {
    problem.value = error;
    if (lost() === "refused") connection.value = "refused"; // The event stream may have failed before.
  }
}

// Whoever may not read has lost nothing, and waits in vain.
const lost = () => (problem.value?.status === 401 ? "refused" : "lost");

export function listen(name = "", since = 0) {
  source?.close();
  const query = name ? `?mission=${encodeURIComponent(name)}&since=${since}` : "";
  source = new EventSource(`/v1/events${query}`);
  const own = source;
  source.onopen = () => (connection.value = state.value?.phase === "ended" || isGone.value ? "over" : "live");
  source.onerror = () => {
    if (own !== source) return;
    connection.value = lost();
    if (own.readyState === EventSource.CLOSED) setTimeout(() => own === source && reopen(name), 1500);
  };
  for (const kind of ["decision", "state", "service", "progress", "bundle", "runs"]) {
    source.addEventListener(kind, (event) => {
      waiting.push([kind, JSON.parse(event.data)]);
      if (!isFlushing) {
        isFlushing = true;
        setTimeout(flush, document.hidden ? 200 : TOGETHER_MS);
      }
    });
  }
}

// A gateway that was away and refused the stream in the meantime is asked for all of it again.
const reopen = (name) => (name ? open(name, { again: true }) : listen());

export async function open(name, { again = false } = {}) {
  const begun = performance.now();
  const path = `/v1/missions/${encodeURIComponent(name)}`;
  if (!again) forget();
  if (!again) connection.value = "connecting";
  else if (connection.value !== "missing") connection.value = lost();
  try {
    const [view, trace] = await Promise.all([read(path), read(`${path}/trace`)]);
    if (route.value.name !== name) return;
    // `latest` is a name of the newest mission: its events have its own one.
    const own = (view.mission ?? view.state)?.mission ?? name;
    if (own !== name) return go(addressOf(own, route.value.view, route.value.step), { replace: true });
    batch(() => {
      records.clear();
      progress.value = null;
      mission.value = view;
      state.value = view.state ?? null;
      draws.value = trace.draws;
      steps.value = trace.steps.map(whole);
      points.value = folded(steps.value);
      problem.value = null;
      loadedIn.value = performance.now() - begun;
    });
    if (again && at.value) loadRecord(at.value.step);
    listen(name, trace.next);
    loadPictures(name);
  } catch (error) {
    problem.value = error;
    connection.value = error.status === 404 ? "missing" : lost();
    // A system that has just been started may not answer yet.
    setTimeout(() => route.value.name === name && open(name, { again: true }), 1500);
  }
}

function forget() {
  source?.close();
  source = null;
  waiting = [];
  looks = 0;
  records.clear();
  batch(() => {
    mission.value = state.value = progress.value = successor.value = loadedIn.value = null;
    steps.value = points.value = reports.value = pictures.value = [];
    services.value = new Map();
    draws.value = false;
  });
}

export const close = () => forget();

async function loadPictures(name) {
  try {
    pictures.value = (await read(`/v1/missions/${encodeURIComponent(name)}/world`)).steps;
  } catch {
    pictures.value = [];
  }
}

export async function loadRecord(step) {
  if (records.has(step) || !mission.value) return;
  const { name } = route.value;
  try {
    const found = await read(`/v1/missions/${encodeURIComponent(name)}/decisions/${step}`);
    if (route.value.name !== name) return;
    records.set(step, found);
    recordsChanged.value++;
  } catch {
    // The next look asks again.
  }
}

// What has its usual value is left out of a row.
const whole = (row) => ({ status: "", surprise: 0, ...row });

// --- events -----------------------------------------------------------------------------------------

function flush() {
  isFlushing = false;
  const events = waiting;
  waiting = [];
  batch(() => {
    const rows = [];
    for (const [kind, event] of events) {
      if (kind === "decision") rows.push(event);
      else if (kind === "state") takeState(event);
      else if (kind === "service") services.value = new Map(services.value).set(event.service, event.is_there);
      else if (kind === "progress") progress.value = event;
      else if (kind === "bundle") reports.value = [event, ...reports.value].slice(0, 20);
      else if (kind === "runs") takeRuns(event);
    }
    if (rows.length) takeRows(rows);
  });
}

// A run that is killed says nothing, and neither does one that is taken up.
function takeRuns(event) {
  runs.value = event;
  const view = mission.value;
  const run = view && event.find((each) => each.run === view.run && each.directory);
  if (run && run.is_running !== view.is_running && state.value?.phase !== "ended") open(route.value.name, { again: true });
}

function takeState(event) {
  if (route.value.name && event.mission !== route.value.name) {
    if (event.phase !== "waiting") successor.value = event.mission;
    return;
  }
  state.value = event;
  if (event.phase === "ended") {
    connection.value = "over";
    read(`/v1/missions/${encodeURIComponent(event.mission)}`).then(
      (view) => route.value.name === event.mission && (mission.value = view),
      () => {},
    );
    loadPictures(event.mission);
  } else if (connection.value === "over" && !isGone.value) connection.value = "live";
}

function takeRows(events) {
  const all = steps.value.slice();
  let firstChanged = all.length;
  for (const { record: full, row: told } of events) {
    const row = whole(told);
    const place = all.length ? row.step - all[0].step : 0;
    if (place < 0) continue;
    const known = all[place];
    if (known && known.sequence >= row.sequence) continue;
    // A row that came in two parts keeps what was decided.
    all[place] = known && full.outcome ? { ...known, ...row, belief: { ...known.belief, ...row.belief }, endings: known.endings, predicted: known.predicted } : row;
    firstChanged = Math.min(firstChanged, place);
    const both = { ...records.get(row.step) };
    both[full.outcome ? "observed" : "decided"] = full;
    if (both.decided || !full.outcome) records.set(row.step, both);
    if (full.outcome) {
      progress.value = null;
      // Most worlds have no camera: who sees no picture after a few steps asks no more.
      if (!pictures.value.length && looks++ < MOST_LOOKS) loadPictures(full.mission);
      else if (pictures.value.length && !pictures.value.includes(row.step)) pictures.value = [...pictures.value, row.step];
    }
  }
  steps.value = all;
  points.value = folded(all, points.value, firstChanged);
  recordsChanged.value++;
}

// The beliefs after each step, out of what has changed: number 0 is the one of the first decision.
export function folded(all, before = [], from = 0) {
  const found = before.slice(0, from + (from ? 1 : 0));
  for (let i = found.length ? found.length - 1 : 0; i < all.length; i++) {
    const decided = { ...(found[i] ?? {}), ...(all[i].belief ?? {}) };
    found[i] = decided;
    found[i + 1] = { ...decided, ...(all[i].after ?? {}) };
  }
  return found;
}

// Every view has an address: #/missions/NAME/VIEW?step=12
import { signal } from "@preact/signals";
import { takeToken } from "./api.js";

export const VIEWS = ["overview", "why", "steps", "model", "documents", "system"];

// What somebody has cut in the middle of a letter stays as it is.
const decoded = (text) => {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
};

const parse = () => {
  const [path, query = ""] = location.hash.replace(/^#/, "").split("?");
  const [kind = "", name = "", view = "overview"] = path.split("/").filter(Boolean).map(decoded);
  const given = new URLSearchParams(query);
  const step = Number(given.get("step")) || null;
  return { kind, name, view: VIEWS.includes(view) ? view : "overview", step, token: given.get("token") };
};

export const route = signal({ kind: "", name: "", view: "overview", step: null });

export const addressOf = (name, view = "overview", step = null) =>
  `#/missions/${encodeURIComponent(name)}${view === "overview" ? "" : `/${view}`}${step ? `?step=${step}` : ""}`;

export function go(address, { replace = false } = {}) {
  if (replace) history.replaceState(null, "", address);
  else history.pushState(null, "", address);
  route.value = parse();
}

export async function startRouting() {
  const take = async () => {
    const found = parse();
    if (found.token) {
      const kept = location.hash.replace(/([?&])token=[^&]*&?/, "$1").replace(/[?&]$/, "");
      history.replaceState(null, "", kept || "#/");
      await takeToken(found.token).catch(() => {});
    }
    route.value = parse();
  };
  addEventListener("hashchange", take);
  addEventListener("popstate", take);
  await take();
}

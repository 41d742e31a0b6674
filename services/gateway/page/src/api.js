// Requests to the gateway. What fails is a Problem with the AOS code and the places in documents.

const KEY = "aos-token";

export class Problem extends Error {
  constructor(body) {
    super(body.detail || body.title || "the gateway cannot be reached");
    Object.assign(this, { code: "", hint: "", diagnostics: [] }, body);
  }
}

export const hasToken = () => Boolean(localStorage.getItem(KEY));

// The token comes behind the address once, and goes out of it at once.
export async function takeToken(token) {
  localStorage.setItem(KEY, token);
  await fetch("/v1/session", { method: "POST", headers: authorization() });
}

const authorization = () => {
  const token = localStorage.getItem(KEY);
  return token ? { authorization: `Bearer ${token}` } : {};
};

async function asked(path, options = {}) {
  let answer;
  try {
    answer = await fetch(path, { ...options, headers: { ...authorization(), ...options.headers } });
  } catch {
    throw new Problem({ detail: "The gateway cannot be reached.", hint: "Is `aos serve` still running?" });
  }
  if (answer.ok) return answer;
  let body;
  try {
    body = await answer.json();
  } catch {
    body = { detail: `The gateway answered ${answer.status}.` };
  }
  throw new Problem(body);
}

export const read = async (path) => (await asked(path)).json();
export const readBlob = async (path) => (await asked(path)).blob();
export const readText = async (path) => (await asked(path)).text();

export const write = async (path, body = {}) =>
  (await asked(path, { method: "POST", body: JSON.stringify(body), headers: { "content-type": "application/json" } })).json();

export const send = async (path, file) =>
  (await asked(`${path}?name=${encodeURIComponent(file.name)}`, { method: "POST", body: file })).json();

// Numbers, times and names for people. No line breaks between a number and its unit.

export const isNumber = (value) => typeof value === "number" && Number.isFinite(value);

// The digits of a value that tell something: a small one has its first three.
const isSmall = (value) => Math.abs(value) < 0.05 && Math.abs(value) > 1e-12;
export function sized(value, digits = 2) {
  if (value >= 1000) return Math.round(value).toLocaleString("en");
  return isSmall(value) ? String(Number(value.toPrecision(digits + 1))) : value.toFixed(digits);
}
export const signed = (value, digits = 2) => (isNumber(value) ? `${value < 0 ? "−" : "+"}${sized(Math.abs(value), digits)}` : "–");

// The error beside a value, unless no digit of the value has it.
export function plusMinus(error, value) {
  if (!isSmall(value)) return error >= 0.005 ? ` ± ${error.toFixed(2)}` : "";
  return error > Math.abs(value) / 200 ? ` ± ${sized(error, 1)}` : "";
}

// A number of the world: to three digits of the span in which it lies, or of its own.
export function number(value, span = Math.abs(value)) {
  if (!isNumber(value)) return "–";
  const decimals = Math.max(0, 2 - Math.floor(Math.log10(span || 1)));
  const text = decimals > 6 || span >= 1e6 ? String(Number(value.toPrecision(3))) : String(Number(value.toFixed(decimals)));
  return text.replace("-", "−");
}

export const plain = (value, digits = 2) => (isNumber(value) ? value.toFixed(digits) : "–");

// What is not certain is never shown as certain.
export function chance(value) {
  if (!isNumber(value)) return "–";
  if (value > 0.9995 && value < 1) return ">0.999";
  if (value < 0.0005 && value > 0) return "<0.001";
  return value.toFixed(3);
}

export function percent(value) {
  if (!isNumber(value)) return "–";
  if (value > 0.9995 && value < 1) return ">99.9\u00a0%";
  if (value < 0.0005 && value > 0) return "<0.1\u00a0%";
  return `${Number((value * 100).toFixed(1))}\u00a0%`;
}

export function seconds(value) {
  if (!isNumber(value)) return "";
  if (value < 0.001) return "<1\u00a0ms";
  if (value < 1) return `${Math.round(value * 1000)}\u00a0ms`;
  return value < 60 ? `${value.toFixed(1)}\u00a0s` : `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`;
}

export function moment(text) {
  const date = new Date(text);
  if (Number.isNaN(date.getTime())) return "";
  const isToday = date.toDateString() === new Date().toDateString();
  const time = date.toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
  return isToday ? `today, ${time}` : `${date.toLocaleDateString([], { day: "numeric", month: "short" })}, ${time}`;
}

const ENDINGS = {
  goal: "Goal reached",
  over: "Over, no goal",
  failure: "Failed",
  nothing_worthwhile: "Nothing worth doing",
  too_risky: "Too risky",
  step_limit: "Step limit",
  skills_failed: "Skills kept failing",
  cancelled: "Cancelled",
  fault: "Fault",
  not_started: "Not started",
  stopped: "Stopped",
  killed: "Killed",
  running: "Running",
  waiting: "Waiting",
  unreachable: "Unreachable",
};
export const ending = (name) => ENDINGS[name] ?? name;

const PHASES = {
  waiting: "Waiting",
  compiling: "Compiling the model",
  planning: "Deciding",
  acting: "Acting",
  holding: "Holding",
};
export const phase = (name) => PHASES[name] ?? name;

export const briefAction = (action) => action.replace(/([(,] ?)\w+=/g, "$1");

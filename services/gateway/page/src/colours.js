// Colours that people with any colour vision can tell apart (Paul Tol's bright scheme), always beside a word or a shape.

const WHEEL = ["#4477aa", "#ccbb44", "#66ccee", "#aa3377", "#228833", "#ee6677", "#8a8f98"];
const DARK_TEXT = new Set(["#ccbb44", "#66ccee", "#ee6677"]);
const NEGATIVE = new Set(["false", "no", "none", "0"]);

export const colour = (index) => WHEEL[index % WHEEL.length];
export const textOn = (fill) => (fill.startsWith("var") ? "var(--ink)" : DARK_TEXT.has(fill) ? "#14171a" : "#ffffff");

// The colours of a variable's values: what is false is as quiet as the paper.
export function valueColours(values) {
  const colours = new Map();
  let next = 0;
  for (const value of values) {
    const isQuiet = NEGATIVE.has(value.toLowerCase()) || value === "…";
    colours.set(value, isQuiet ? "var(--quiet)" : colour(next++));
  }
  return colours;
}

// Small parts that all views use.
import { html } from "htm/preact";
import { useEffect, useRef, useState } from "preact/hooks";
import { signal } from "@preact/signals";

export { html, useEffect, useRef, useState };

export const width = signal(innerWidth);
addEventListener("resize", () => (width.value = innerWidth));

export const Card = ({ title, note, id, children, className = "" }) => html`
  <section class="card ${className}" aria-labelledby=${id}>
    <header class="card-head"><h2 id=${id}>${title}</h2>${note && html`<p class="note">${note}</p>`}</header>
    ${children}
  </section>`;

export const Findings = ({ problem }) =>
  problem && html`
    <div class="problem" role="alert">
      <p><strong>${problem.message}</strong>${problem.code && html` <span class="code">${problem.code}</span>`}</p>
      ${problem.hint && html`<p>${problem.hint}</p>`}
      ${problem.diagnostics?.length > 0 && html`<ul class="findings">
        ${problem.diagnostics.slice(0, 50).map((found) => html`<li>
          <span class="code">${found.code}</span> <span class="place">${place(found.span)}</span> ${!problem.message?.includes(found.message) && found.message}
          ${found.hint && found.hint !== problem.hint && html`<p class="hint">${found.hint}</p>`}
          ${found.excerpt && html`<pre tabindex="0">${found.excerpt}</pre>`}
        </li>`)}
      </ul>`}
    </div>`;

const place = (span) => [span.file, span.line, span.column].filter(Boolean).join(":");

// The width of an element in pixels, and again when it changes.
export function useWidth() {
  const ref = useRef(null);
  const [size, setSize] = useState(0);
  useEffect(() => {
    const watch = new ResizeObserver(([entry]) => setSize(Math.floor(entry.contentRect.width)));
    watch.observe(ref.current);
    return () => watch.disconnect();
  }, []);
  return [ref, size];
}

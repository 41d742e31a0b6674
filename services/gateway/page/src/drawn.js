// The state as the bundle's picture.py draws it: the picture of the step that is shown.
import { Card, Findings, html, useEffect, useState } from "./ui.js";
import { readBlob } from "./api.js";
import { at, draws } from "./store.js";
import { route } from "./route.js";

export function Drawn() {
  const [found, setFound] = useState(null);
  const { name } = route.value;
  const step = at.value?.step;
  const isOver = Boolean(at.value?.status);
  useEffect(() => {
    if (!draws.value || !step) return;
    let isWanted = true;
    const show = (next) => isWanted && setFound(next);
    const path = `/v1/missions/${encodeURIComponent(name)}/decisions/${step}/picture`;
    // Whoever drags the slider passes many steps, and each picture has a process of its own.
    const soon = setTimeout(
      () =>
        readBlob(path).then(
          (data) => show({ step, url: URL.createObjectURL(data) }),
          (problem) => show({ step, problem }),
        ),
      150,
    );
    return () => {
      isWanted = false;
      clearTimeout(soon);
    };
  }, [name, step, isOver, draws.value]);
  useEffect(() => () => found?.url && URL.revokeObjectURL(found.url), [found]);
  if (!draws.value) return null;
  return html`<${Card} id="drawn" title="State" note="The likeliest value of each variable, as the bundle draws it.">
    <${Findings} problem=${found?.problem} />
    ${found?.url && html`<figure class="picture"><img src=${found.url} alt=${`The state after step ${found.step}`} /></figure>`}
  <//>`;
}

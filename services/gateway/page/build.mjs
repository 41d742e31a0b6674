// Makes the page: node build.mjs [FOLDER]. Without a folder it goes to where `aos serve` finds it.
import { build } from "esbuild";
import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const folder = process.argv[2] ?? join(here, "../aos_gateway/page");
const libraries = ["preact", "htm", "@preact/signals", "@preact/signals-core"];

await mkdir(folder, { recursive: true });
await build({
  absWorkingDir: here,
  entryPoints: { page: "src/main.js" },
  bundle: true,
  minify: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
  outdir: folder,
});
await build({ absWorkingDir: here, entryPoints: { page: "src/page.css" }, minify: true, outdir: folder });
await copyFile(join(here, "src/index.html"), join(folder, "index.html"));
await copyFile(join(here, "src/icon.svg"), join(folder, "icon.svg"));

const licences = [];
for (const name of libraries) {
  const place = join(here, "node_modules", name);
  const { version } = JSON.parse(await readFile(join(place, "package.json"), "utf8"));
  licences.push(`${name} ${version}\n\n${(await readFile(join(place, "LICENSE"), "utf8")).trim()}\n`);
}
await writeFile(join(folder, "licences.txt"), licences.join(`\n${"-".repeat(72)}\n\n`));

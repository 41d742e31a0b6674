// Makes the page: node build.mjs [FOLDER]. Without a folder it goes to where `aos serve` finds it. All its files are
// compressed, as browsers get them.
import { build } from "esbuild";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

const here = dirname(fileURLToPath(import.meta.url));
const folder = process.argv[2] ?? join(here, "../aos_gateway/page");
const libraries = ["preact", "htm", "@preact/signals", "@preact/signals-core"];

await mkdir(folder, { recursive: true });
const common = { absWorkingDir: here, minify: true, outdir: folder, write: false };
const script = await build({
  ...common,
  entryPoints: { page: "src/main.js" },
  bundle: true,
  format: "esm",
  target: "es2022",
  charset: "utf8",
  legalComments: "none",
});
const styles = await build({ ...common, entryPoints: { page: "src/page.css" } });
const compress = (path, contents) => writeFile(`${path}.gz`, gzipSync(contents, { level: 9 }));
for (const { path, contents } of [...script.outputFiles, ...styles.outputFiles]) {
  await compress(path, contents);
}
for (const name of ["index.html", "icon.svg"]) {
  await compress(join(folder, name), await readFile(join(here, "src", name)));
}

// The text of the Apache License comes with AOS already, which has the same.
const apache = "Apache License 2.0, the text that comes with AOS as LICENSE: http://www.apache.org/licenses/LICENSE-2.0";
const licences = [];
for (const name of libraries) {
  const place = join(here, "node_modules", name);
  const { version } = JSON.parse(await readFile(join(place, "package.json"), "utf8"));
  const text = (await readFile(join(place, "LICENSE"), "utf8")).trim();
  const told = text.startsWith("Apache License") ? apache : text;
  licences.push(`${name} ${version}\n\n${told}\n`);
}
await compress(join(folder, "licences.txt"), licences.join(`\n${"-".repeat(72)}\n\n`));

// Bundles the script of the page, and the licences of what is in it, into a folder: that of the assets, which are committed so that
// `cargo build` needs no Node. The crate takes page.html and page.css from src/ as they are.
import { build } from "esbuild";
import { readdir, readFile, writeFile } from "node:fs/promises";

const folder = process.argv[2] ?? "../assets";
const PACKAGES = ["preact", "@preact/signals", "@preact/signals-core", "smol-toml", "three"];

await build({
  entryPoints: { page: "src/main.ts" },
  outdir: folder,
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  legalComments: "none",
  define: { "process.env.NODE_ENV": '"production"' },
});

let licences = "The page contains these packages, under these licences.\n";
for (const name of PACKAGES) {
  const its = `node_modules/${name}`;
  const { version } = JSON.parse(await readFile(`${its}/package.json`, "utf8"));
  const file = (await readdir(its)).find((file) => /^licen[cs]e/i.test(file));
  licences += `\n== ${name} ${version}\n\n${(await readFile(`${its}/${file}`, "utf8")).trim()}\n`;
}
await writeFile(`${folder}/LICENSES.txt`, licences);

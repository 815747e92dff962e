// Builds the page into ../assets, which are committed so that `cargo build` needs no Node.
import { build } from "esbuild";
import { readdir, readFile, writeFile, copyFile } from "node:fs/promises";

const PACKAGES = ["preact", "@preact/signals", "@preact/signals-core", "three"];

await build({
  entryPoints: { page: "src/page.tsx" },
  outdir: "../assets",
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  legalComments: "none",
  define: { "process.env.NODE_ENV": '"production"' },
});
await copyFile("src/page.html", "../assets/page.html");
await copyFile("src/page.css", "../assets/page.css");

let licences = "The page contains these packages, under these licences.\n";
for (const name of PACKAGES) {
  const folder = `node_modules/${name}`;
  const { version } = JSON.parse(await readFile(`${folder}/package.json`, "utf8"));
  const file = (await readdir(folder)).find((file) => /^licen[cs]e/i.test(file));
  licences += `\n== ${name} ${version}\n\n${(await readFile(`${folder}/${file}`, "utf8")).trim()}\n`;
}
await writeFile("../assets/LICENSES.txt", licences);

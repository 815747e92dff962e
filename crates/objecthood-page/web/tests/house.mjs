// What the tests share: the program, the browser, and the words in which results are told.
import { execFile, spawn } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdir, mkdtemp, readdir, rm } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { promisify } from "node:util";
import { chromium } from "playwright-core";

const { OBJECTHOOD_PROGRAM: program, OBJECTHOOD_CHROMIUM: browserPath = "/usr/bin/chromium", OBJECTHOOD_PICTURES: pictures } = process.env;
/** The folder of real data, if it is there. */
export const data = process.env.OBJECTHOOD_DATA;
if (!program) throw new Error("run me by `cargo xtask test`");

const run = promisify(execFile);
const tests = [];

/** A test, which runs in its turn. */
export function test(name, body) {
  tests.push({ name, body });
}

export function skip(why) {
  console.log(`skipped: ${why}`);
}

/** Runs the tests one after the other and says how they went, as the tests of Rust do. */
export async function finish() {
  let failed = 0;
  for (const { name, body } of tests) {
    try {
      await body();
      console.log(`test ${name} ... ok`);
    } catch (error) {
      failed++;
      console.log(`test ${name} ... FAILED\n${error.stack}`);
    }
  }
  console.log(`test result: ${failed ? "FAILED" : "ok"}. ${tests.length - failed} passed; ${failed} failed`);
  process.exitCode = failed ? 1 : 0;
}

/** What `objecthood` prints. */
export async function objecthood(...words) {
  return (await run(program, words, { maxBuffer: 1 << 28 })).stdout;
}

/** Serves the page over an input; `page` has its address, `end` ends it. */
export async function view(...words) {
  const child = spawn(program, ["view", ...words], { stdio: ["ignore", "pipe", "inherit"] });
  const address = await new Promise((resolve, reject) => {
    child.stdout.once("data", (line) => resolve(String(line).trim()));
    child.once("exit", (code) => reject(new Error(`objecthood view ended with ${code}`)));
  });
  return { address, pid: child.pid, end: () => child.kill("SIGINT") };
}

/** A browser of its own, without a profile, that reaches nothing but this machine. */
export function launch() {
  const flags = ["--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"];
  // Without a graphics card WebGL is drawn by the processor.
  const drawing = ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  return chromium.launch({ executablePath: browserPath, args: [...flags, ...drawing] });
}

/** A tab that keeps what it asks for and what it complains of. */
export async function tab(browser, { width = 1280, height = 720, scheme = "light" } = {}) {
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme });
  const page = await context.newPage();
  const [requests, complaints] = [[], []];
  page.on("request", (request) => requests.push(request.url()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("console", (line) => ["error", "warning"].includes(line.type()) && complaints.push(line.text()));
  return { page, requests, complaints };
}

/** Keeps a picture of the tab for whoever looks at it. */
export async function keep(page, name) {
  if (!pictures) return;
  await mkdir(pictures, { recursive: true });
  await page.screenshot({ path: join(pictures, `${name}.png`) });
}

export async function inFolder(body) {
  const folder = await mkdtemp(join(tmpdir(), "objecthood-page-"));
  try {
    return await body(folder);
  } finally {
    await rm(folder, { recursive: true });
  }
}

export function hash(labels) {
  return createHash("sha256").update(Buffer.from(labels.buffer, labels.byteOffset, labels.byteLength)).digest("hex");
}

/** How many colours a canvas has; 1 = it is blank. */
export function colorsOf(page, canvas) {
  return page.locator(canvas).first().evaluate((element) => {
    const copy = new OffscreenCanvas(element.width, element.height).getContext("2d");
    copy.drawImage(element, 0, 0);
    return new Set(new Uint32Array(copy.getImageData(0, 0, element.width, element.height).data.buffer)).size;
  });
}

/** A folder of point clouds, and the first of them: real ones, or else synthetic ones. */
export async function scenes() {
  let input = data && join(data, "mosd/learn");
  if (!input) {
    skip("the page on real scenes: there is no data");
    const folder = await mkdtemp(join(tmpdir(), "objecthood-scenes-"));
    await objecthood("synth", "--family", "tabletop", "--scenes", "9", "--out", folder);
    input = join(folder, "tabletop");
  }
  const clouds = (await readdir(input)).filter((name) => name.endsWith(".pcd"));
  const [first] = clouds.sort((a, b) => a.length - b.length || (a < b ? -1 : 1));
  return { input, first: join(input, first) };
}

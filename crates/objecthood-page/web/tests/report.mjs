// Reports in a browser: they open from the file, and ask for nothing.
import assert from "node:assert/strict";
import { stat } from "node:fs/promises";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { colorsOf, finish, inFolder, keep, launch, objecthood, scenes, tab, test } from "./house.mjs";

const browser = await launch();
const { input, first } = await scenes();

async function opened(folder, name) {
  const { page, requests, complaints } = await tab(browser);
  const file = join(folder, name);
  await page.goto(String(pathToFileURL(file)));
  await page.locator(".side-0").waitFor();
  return { page, requests: () => requests.filter((url) => !/^(data|blob):/.test(url)), complaints, bytes: (await stat(file)).size };
}

test("a_report_opens_from_its_file_and_asks_for_nothing", () => inFolder(async (folder) => {
  await objecthood("segment", first, "--out", folder, "--report");
  const { page, requests, complaints, bytes } = await opened(folder, "report.html");
  assert.ok(bytes <= 4e6, `${bytes} bytes for a frame`);
  assert.ok((await colorsOf(page, ".side-0")) > 100, "the picture is not blank");
  const picture = () => page.locator(".side-0").evaluate((canvas) => canvas.toDataURL());
  const before = await picture();
  await page.getByLabel("Opacity of objects").fill("1");
  await page.waitForTimeout(300);
  assert.notEqual(await picture(), before, "the slider moves the layer");
  for (const key of ["1", "2", "4", "5", "6", "7", "9"]) await page.keyboard.press(key);
  await page.locator(".objects .id").first().click();
  await keep(page, "report-1280");
  await page.keyboard.press("v");
  await page.waitForTimeout(1500);
  assert.ok((await colorsOf(page, ".space canvas")) > 100, "the points are not blank");
  assert.equal(requests().length, 1, "the file itself, and nothing else");
  assert.deepEqual(complaints, []);
}));

test("a_report_of_many_frames_is_small_and_shows_each", () => inFolder(async (folder) => {
  await objecthood("segment", input, "--out", folder, "--report");
  const { page, complaints, bytes } = await opened(folder, "report.html");
  const rows = page.locator(".list tbody tr");
  const count = await rows.count();
  assert.ok(bytes <= 1e6 + 0.19e6 * Math.max(count, 21), `${bytes} bytes for ${count} frames`);
  const picture = () => page.locator(".side-0").evaluate((canvas) => canvas.toDataURL());
  const before = await picture();
  await rows.nth(count - 1).click();
  for (let k = 0; k < 50 && (await picture()) === before; k++) await page.waitForTimeout(200);
  assert.notEqual(await picture(), before, "another frame");
  await page.getByRole("button", { name: /^objects/ }).click();
  await keep(page, "report-frames-1280");
  assert.deepEqual(complaints, []);
}));

await finish();
await browser.close();

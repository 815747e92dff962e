// Reports in a browser: they open from the file, and ask for nothing.
import assert from "node:assert/strict";
import { stat } from "node:fs/promises";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { colorsOf, data, finish, inFolder, keep, launch, objecthood, scenes, skip, tab, test } from "./house.mjs";

const browser = await launch();
const { input, first } = await scenes();

async function opened(folder, name) {
  const { page, requests, complaints } = await tab(browser);
  const file = join(folder, name);
  await page.goto(String(pathToFileURL(file)));
  await page.locator(".side-0, .sheet-of-figures").first().waitFor();
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
  await page.getByRole("tab", { name: "Times" }).click();
  const laps = await page.locator(".parameters tbody tr").evaluateAll((rows) => rows.map((row) => row.textContent));
  const method = laps.filter((lap) => !/^(reading|encoding|writing)/.test(lap)).reduce((sum, lap) => sum + Number(/([\d.]+) ms/.exec(lap)[1]), 0);
  assert.ok(laps.some((lap) => lap.startsWith("writing")), "Times has what is around the method");
  const said = await page.locator(".parameters .score").innerText();
  const median = Number(/median (\d+) ms a frame for the method/.exec(said)[1]);
  assert.ok(Math.abs(median - method) <= 1, `${median} ms are those of the method, ${method}`);
  assert.match(said, /^1 frame, \d+ objects?,/);
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
  assert.match(await page.locator(".parameters .score").innerText(), / objects over all frames,/);
  await page.getByRole("button", { name: /^objects/ }).click();
  const heads = await page.locator(".list th button").evaluateAll((all) => all.map((one) => {
    const range = document.createRange();
    range.selectNodeContents(one);
    const { left, right } = range.getBoundingClientRect();
    return { left, right };
  }));
  for (let k = 1; k < heads.length; k++) assert.ok(heads[k].left - heads[k - 1].right >= 4, `a gap before head ${k}`);
  await keep(page, "report-frames-1280");
  assert.deepEqual(complaints, []);
}));

test("a_report_of_figures_alone_opens", () => inFolder(async (folder) => {
  await objecthood("eval", "--family", "tabletop", "--scenes", "1", "--report", join(folder, "figures.html"));
  const { page, requests, complaints } = await opened(folder, "figures.html");
  assert.equal(await page.locator(".figures tbody tr").count(), 1);
  assert.equal(requests().length, 1);
  assert.deepEqual(complaints, []);
}));

if (data) {
  test("the_report_of_an_evaluation_has_its_figures_plots_and_hardest_scenes", () => inFolder(async (folder) => {
    await objecthood("eval", join(data, "mosd"), "--split", "learn", "--report", join(folder, "eval.html"));
    const { page, complaints } = await opened(folder, "eval.html");
    assert.match(await page.locator(".figures").innerText(), /overlap/);
    assert.ok((await page.locator(".figures tbody tr").count()) > 5, "tables");
    const widths = await page.locator(".plot").evaluateAll((plots) => plots.map(({ naturalWidth }) => naturalWidth));
    assert.ok(widths.length === 2 && widths.every((width) => width > 100), `plots ${widths}`);
    await keep(page, "report-eval-1280");
    await page.getByRole("tab", { name: "Frames" }).click();
    assert.equal(await page.locator(".list tbody tr").count(), 12);
    assert.match(await page.locator(".side .score").innerText(), /correct/);
    assert.deepEqual(complaints, []);
  }));

  test("the_report_of_a_video_has_tracks_and_what_happened", () => inFolder(async (folder) => {
    await objecthood("track", join(data, "video/hand-plush"), "--frames", "0..40", "--out", folder, "--report");
    const { page, complaints } = await opened(folder, "report.html");
    const events = page.locator(".timeline button");
    assert.ok((await events.count()) > 0, "events");
    const picture = () => page.locator(".side-0").evaluate((canvas) => canvas.toDataURL());
    const before = await picture();
    await events.last().click();
    for (let k = 0; k < 50 && (await picture()) === before; k++) await page.waitForTimeout(200);
    assert.notEqual(await picture(), before, "an event leads to its frame");
    const tracks = await page.locator(".lives tbody tr").count();
    assert.ok(tracks > 1, "tracks");
    assert.match(await page.locator(".parameters .score").innerText(), new RegExp(`, ${tracks} tracks,`));
    await keep(page, "report-video-1280");
    await page.keyboard.press("=");
    await page.keyboard.press("v");
    await page.waitForTimeout(1500);
    assert.ok((await colorsOf(page, ".space canvas")) > 100, "the points are not blank");
    await keep(page, "report-video-space-1280");
    assert.deepEqual(complaints, []);
  }));
} else {
  skip("reports of real scenes and videos: there is no data");
}

await finish();
await browser.close();

// The live page in a browser: it shows what the command line says.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";

import { colorsOf, finish, hash, inFolder, keep, launch, objecthood, scenes, skip, tab, test, view } from "./house.mjs";
import { CHANGES } from "./changes.mjs";
import { labelsOf } from "./png.mjs";

const { OBJECTHOOD_DATA: data } = process.env;

/** The header of an answer, and the labels in one of its maps, if it is there. */
async function unpacked(response, map) {
  const body = await response.body();
  const length = body.readUInt32LE(0);
  const header = JSON.parse(body.toString("utf8", 4, 4 + length));
  const place = header.maps.find(({ name }) => name === map);
  if (!place) return { header, labels: null };
  const start = 4 + length + place.offset;
  return { header, labels: new Uint16Array(Uint8Array.from(body.subarray(start, start + place.length)).buffer) };
}

/** Does something, and waits for the next picture of a side; the labels in it. */
async function looked(page, act, side = 0) {
  const answered = page.waitForResponse((response) => response.url().endsWith("/look") && response.request().postDataJSON().side === side);
  await act();
  return unpacked(await answered, "objects");
}

const type = (page, name, value) => async () => {
  const box = page.locator(`[id="p-${name}"]`);
  await box.fill(String(value));
  await box.press("Tab");
};

/** The labels that the command line finds, and the number of its objects. */
function segmented(file, ...options) {
  return inFolder(async (folder) => {
    await objecthood("segment", file, "--out", folder, "--write", "labels", ...options);
    const name = file.split("/").at(-1).replace(/\.pcd$/, "");
    return labelsOf(join(folder, `${name}.labels.png`));
  });
}

const browser = await launch();
const served = [];

async function open(words, options) {
  const server = await view(...words);
  served.push(server);
  const opened = await tab(browser, options);
  await opened.page.goto(server.address);
  await opened.page.locator(".side-0").waitFor();
  await opened.page.waitForFunction(() => /shown in \d+ ms/.test(document.querySelector(".status")?.textContent ?? ""));
  return { ...opened, ...server };
}

const { input, first } = await scenes();

test("it_opens_without_a_complaint_and_asks_nobody_else", async () => {
  const { page, requests, complaints, address, end } = await open([input]);
  assert.ok((await colorsOf(page, ".side-0")) > 100, "the picture is not blank");
  await keep(page, "page-1280");
  assert.equal(await page.locator(".side").evaluate((side) => side.scrollWidth - side.clientWidth), 0, "the list fits into its panel");
  await page.keyboard.press("v");
  await page.waitForTimeout(1500);
  assert.ok((await colorsOf(page, ".space canvas")) > 100, "the points are not blank");
  await keep(page, "space-1280");
  await page.keyboard.press("v");
  await page.locator(".tile").nth(8).getByText("correct").waitFor();
  await keep(page, "sheet-1280");
  assert.deepEqual(complaints, []);
  assert.deepEqual(requests.filter((url) => !url.startsWith(address) && !url.startsWith("data:")), []);
  end();
});

test("a_parameter_of_every_stage_gives_the_labels_of_the_command_line", async () => {
  const { page, complaints, end } = await open([first]);
  const before = hash(await segmented(first));
  let differ = 0;
  for (const [stage, [name, value]] of Object.entries(CHANGES)) {
    const { header, labels } = await looked(page, type(page, name, value));
    assert.deepEqual(header.settings.set, { [name]: value });
    const said = hash(await segmented(first, "--set", `${name}=${value}`));
    assert.equal(hash(labels), said, `labels after a change of ${stage}`);
    differ += Number(said !== before);
    const reset = await looked(page, () => page.getByRole("button", { name: `Reset ${name}` }).click());
    assert.equal(hash(reset.labels), before, `labels after the reset of ${stage}`);
  }
  assert.ok(differ >= 4, `${differ} changes made a difference`);
  assert.deepEqual(complaints, []);
  end();
});

test("the_published_method_gives_the_labels_of_the_command_line", async () => {
  const { page, end } = await open([first]);
  const { labels } = await looked(page, () => page.getByLabel("Method").selectOption("paper"));
  assert.equal(hash(labels), hash(await segmented(first, "--method", "paper")));
  end();
});

test("a_click_explains_as_the_command_line_does", async () => {
  const { page, end } = await open([first]);
  const picture = page.locator(".stage .frame");
  const box = await picture.boundingBox();
  const full = page.waitForResponse((r) => r.url().endsWith("/explain") && r.request().postDataJSON().in_full);
  await picture.click({ position: { x: box.width / 2, y: box.height / 2 + 40 } });
  await full;
  await page.locator(".try button").first().waitFor();
  const at = (await page.locator(".side strong").textContent()).replace("Pixel ", "").replace(", ", ",");
  const said = (await page.locator(".said pre").allTextContents()).map((line) => line.trimEnd()).join("\n").trim();
  const expected = (await objecthood("explain", first, "--at", at)).split("\n").map((line) => line.trimEnd()).join("\n").trim();
  assert.equal(said, expected);
  await keep(page, "explain-1280");
  const rows = page.locator(".said .columns");
  await rows.first().evaluate((row) => row.scrollIntoView());
  await keep(page, "explain-borders-1280");
  const cells = rows.locator("span");
  const cut = await cells.evaluateAll((all) => all.filter((cell) => cell.scrollWidth > cell.clientWidth).map((cell) => cell.textContent));
  assert.ok((await rows.count()) > 2, "the borders are a table");
  assert.deepEqual(cut, [], "every cell of the table fits");
  const tooWide = await page.locator(".said").evaluate((said) => said.scrollWidth - said.clientWidth);
  assert.equal(tooWide, 0, "the table fits into the panel");
  const { header } = await looked(page, () => page.locator(".try button").first().click());
  assert.equal(Object.keys(header.settings.set).length, 1, "`try it` sets a parameter");
  end();
});

test("every_parameter_is_tried_for_two_pixels_and_what_is_found_can_be_tried", async () => {
  const { page, complaints, end } = await open([first]);
  const { labels } = await looked(page, () => page.keyboard.press("5"));
  const width = 640;
  const seen = [...new Set(labels)].filter(Boolean).slice(0, 2);
  // The middle one of the pixels of an object is well inside.
  const inside = seen.map((id) => {
    const own = [...labels.keys()].filter((i) => labels[i] === id);
    return own[own.length >> 1];
  });
  const picture = page.locator(".stage .frame");
  const box = await picture.boundingBox();
  const place = (i) => ({ x: (((i % width) + 0.5) * box.width) / width, y: ((Math.floor(i / width) + 0.5) * box.width) / width });
  await picture.click({ position: place(inside[0]) });
  await page.getByText(`A is in object ${seen[0]}`).waitFor();
  await picture.click({ position: place(inside[1]), modifiers: ["Shift"] });
  assert.deepEqual(await page.locator(".cross b").allTextContents(), ["A", "B"]);
  await page.getByRole("button", { name: "What would make A and B one object?" }).waitFor();
  // Until the search ends, a better find may become the first.
  await page.getByText("with a value that was tried").waitFor({ timeout: 300000 });
  await keep(page, "repairs-1280");
  const find = page.locator(".found li").first();
  await find.waitFor();
  const name = await find.locator("strong").first().textContent();
  const tried = await looked(page, () => find.getByRole("button", { name: /^try/ }).click());
  const [a, b] = inside.map((i) => tried.labels[i]);
  assert.ok(a > 0 && a === b, `${a} and ${b} are one object`);
  assert.deepEqual(Object.keys(tried.header.settings.set), [name]);
  await page.locator(".parameter.revealed", { hasText: name }).waitFor();
  await keep(page, "repaired-1280");
  const asBefore = page.waitForResponse((r) => r.url().endsWith("/look") && Object.keys(r.request().postDataJSON().settings.set).length === 0);
  await find.getByRole("button", { name: /^undo/ }).click();
  assert.equal(hash((await unpacked(await asBefore, "objects")).labels), hash(labels));
  await page.keyboard.press("Escape");
  assert.equal(await page.locator(".cross").count(), 0);
  assert.deepEqual(complaints, []);
  end();
});

test("what_is_not_allowed_is_said_with_its_range_and_so_is_an_end_of_the_server", async () => {
  const { page, end } = await open([first]);
  await type(page, "objectness.threshold", 7)();
  await page.getByText("7 is not allowed: from 0 to 1. It stays at 0.55.").waitFor();
  end();
  await page.waitForTimeout(1500);
  await type(page, "objectness.threshold", 0.5)();
  await page.getByText("Start `objecthood view` again").waitFor();
});

test("a_search_that_fails_ends", async () => {
  const { page, end } = await open([first]);
  await page.route("**/explain", (route) =>
    route.request().postDataJSON().in_full ? route.fulfill({ status: 422, json: { error: "it cannot be searched" } }) : route.continue());
  await page.locator(".stage .frame").click();
  await page.getByRole("alert").getByText("it cannot be searched").waitFor();
  assert.equal(await page.locator(".side [aria-label=Explanation]").getAttribute("aria-busy"), "false");
  await page.locator(".said pre").first().waitFor();
  end();
});

test("a_range_is_told_from_its_unit", async () => {
  const { page, end } = await open([first]);
  const meaning = page.locator('[id="p-sensor.disparity_quantum_per_m-meaning"]');
  assert.match(await meaning.textContent(), / 0\.000001 to 1 \(1\/m\), default/);
  end();
});

test("two_settings_are_compared", async () => {
  const { page, end } = await open([first]);
  const kept = await looked(page, () => page.keyboard.press("b"), 1);
  const changed = await looked(page, type(page, ...CHANGES.objects), 0);
  assert.notEqual(hash(kept.labels), hash(changed.labels));
  const clip = () => page.locator(".side-1").evaluate((canvas) => getComputedStyle(canvas).clipPath);
  const middle = await clip();
  await page.locator(".swipe input").fill("0.2");
  assert.notEqual(await clip(), middle, "the line moves");
  await keep(page, "compare-1280");
  const swapped = await looked(page, () => page.keyboard.press("x"), 0);
  assert.equal(hash(swapped.labels), hash(kept.labels));
  end();
});

test("copied_settings_find_the_same_elsewhere", async () => {
  const { page, end } = await open([first]);
  await looked(page, type(page, ...CHANGES.shapes));
  const { labels } = await looked(page, type(page, ...CHANGES.objects));
  await page.getByRole("button", { name: "Copy settings" }).click();
  await keep(page, "copy-1280");
  const toml = await page.locator("dialog textarea").inputValue();
  const found = await inFolder(async (folder) => {
    const file = join(folder, "settings.toml");
    await writeFile(file, toml);
    return segmented(first, "--config", file);
  });
  assert.equal(hash(found), hash(labels));
  await page.getByRole("tab", { name: "command line" }).click();
  const command = await page.locator("dialog textarea").inputValue();
  const options = command.split(" ").slice(command.split(" ").indexOf("--method"));
  assert.equal(hash(await segmented(first, ...options)), hash(labels));
  end();
});

test("settings_come_back_from_a_file_and_after_a_reload", async () => {
  const { page, end } = await open([first]);
  const { labels } = await looked(page, type(page, ...CHANGES.objects));
  const again = await looked(page, () => page.reload());
  assert.equal(hash(again.labels), hash(labels), "after a reload");
  await page.keyboard.press("c");
  const [saved] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save to a file" }).click()]);
  assert.equal(saved.suggestedFilename(), "objecthood.toml");
  await page.getByRole("button", { name: "Close" }).click();
  await looked(page, () => page.getByRole("button", { name: /^Reset all/ }).click());
  await page.keyboard.press("c");
  const file = { name: "objecthood.toml", mimeType: "application/toml", buffer: await readFile(await saved.path()) };
  const loaded = await looked(page, () => page.locator("dialog input[type=file]").setInputFiles(file));
  assert.equal(hash(loaded.labels), hash(labels), "from the file");
  end();
});

/** A regression: an explanation, which asks for one more layer, was told as a change that changed nothing. */
test("what_came_and_went_stays_said_and_colors_stay_with_their_objects", async () => {
  const { page, end } = await open([first]);
  const status = page.locator(".status");
  const swatches = () => page.locator(".objects .swatch").evaluateAll((all) => all.map((one) => one.style.background));
  const before = await swatches();
  await looked(page, type(page, "objectness.min_size_px", "10000"));
  await page.locator(".status", { hasText: / [1-9]\d* went/ }).waitFor();
  const said = await status.textContent();
  const left = await swatches();
  assert.ok(left.length > 0 && left.length < before.length && left.every((color) => before.includes(color)), `${left} of ${before}`);
  const picture = page.locator(".stage .frame");
  const box = await picture.boundingBox();
  const full = page.waitForResponse((r) => r.url().endsWith("/explain") && r.request().postDataJSON().in_full);
  await picture.click({ position: { x: box.width / 2, y: box.height / 2 + 40 } });
  await full;
  await page.waitForTimeout(500);
  assert.equal(await status.textContent(), said);
  end();
});

test("everything_fits_from_a_tablet_to_4k_dark_and_light", async () => {
  for (const [width, height, scheme] of [[820, 1180, "light"], [1280, 720, "dark"], [3840, 2160, "light"]]) {
    const { page, end } = await open([input], { width, height, scheme });
    const tooWide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
    assert.ok(tooWide <= 0, `${tooWide} px too wide at ${width}x${height}`);
    await keep(page, `page-${width}-${scheme}`);
    await page.context().close();
    end();
  }
});

const video = data && join(data, "video/tum-fr1-rpy");
if (video && existsSync(video)) {
  test("a_video_is_scrubbed_and_keeps_the_settings", async () => {
    const { page, complaints, end } = await open([video]);
    await looked(page, type(page, ...CHANGES.objects));
    const slider = page.locator("#scrubber");
    for (const number of [5, 19]) {
      const { header, labels } = await looked(page, () => slider.fill(String(number)));
      assert.equal(header.frame, number);
      const [name, value] = CHANGES.objects;
      const found = await inFolder(async (folder) => {
        const one = [video, "--frames", `${number}..${number + 1}`, "--out", folder, "--write", "labels", "--set", `${name}=${value}`];
        await objecthood("segment", ...one);
        const file = header.name.split("/").at(-1).replace(/\.png$/, "");
        return labelsOf(join(folder, `${file}.labels.png`));
      });
      assert.equal(hash(labels), hash(found), `labels of frame ${number}`);
    }
    await keep(page, "video-1280");
    assert.deepEqual(complaints, []);
    end();
  });

  test("objects_are_followed_as_the_command_line_follows_them", async () => {
    const [plush, to] = [join(data, "video/hand-plush"), 30];
    const { page, complaints, end } = await open([plush, "--frames", "0..40"]);
    await page.locator("#scrubber").fill(String(to));
    let last = null;
    const ended = page.waitForResponse(async (response) => {
      if (!response.url().endsWith("/follow")) return false;
      last = await unpacked(response, "tracks");
      return last.labels !== null;
    });
    await page.keyboard.press("=");
    await ended;
    const tracks = await inFolder(async (folder) => {
      await objecthood("track", plush, "--frames", "0..40", "--out", folder);
      const file = last.header.film.stamps_s.length === to + 1 && `${(to / 15).toFixed(6)}`;
      return labelsOf(join(folder, `labels/${file}.png`));
    });
    assert.equal(hash(last.labels), hash(tracks), `tracks of frame ${to}`);
    await page.getByRole("tab", { name: "Story" }).click();
    await page.locator(".timeline button").first().waitFor();
    await page.locator(".lives tbody tr").first().waitFor();
    await keep(page, "video-tracks-1280");
    // Another parameter follows anew.
    await type(page, ...CHANGES.objects)();
    await page.waitForResponse(async (response) => response.url().endsWith("/follow") && (await unpacked(response, "tracks")).labels !== null);
    await page.keyboard.press("v");
    await page.waitForTimeout(1500);
    await keep(page, "video-tracks-space-1280");
    assert.deepEqual(complaints, []);
    end();
  });

  /** A regression: many frames asked for the tracks, which no look has, were refused, and stayed empty without a word. */
  test("many_frames_show_objects_while_tracks_are_on_and_say_what_is_refused", async () => {
    const { page, complaints, end } = await open([join(data, "video/hand-plush"), "--frames", "0..4"]);
    const isOn = (name) => page.getByRole("button", { name }).getAttribute("aria-pressed");
    const both = async () => [await isOn("0 objects"), await isOn("= tracks")];
    const ended = page.waitForResponse(async (response) => response.url().endsWith("/follow") && (await unpacked(response, "tracks")).labels !== null);
    await page.keyboard.press("=");
    await ended;
    assert.deepEqual(await both(), ["false", "true"], "tracks take the place of objects");
    await page.keyboard.press("v");
    await page.keyboard.press("v");
    const tiles = page.locator(".tile");
    await tiles.nth(3).getByText(/: \d+ objects?$/).waitFor();
    assert.ok((await colorsOf(page, ".tile canvas")) > 100, "the tile is not blank");
    await page.locator(".sheet .bar").getByText(/^\d+ objects in 4 frames/).waitFor();
    await keep(page, "video-sheet-1280");
    await page.keyboard.press("0");
    assert.deepEqual(await both(), ["true", "false"], "objects take the place of tracks");
    assert.deepEqual(complaints, []);
    await page.route("**/look", (route) => route.fulfill({ status: 422, json: { error: "this frame is gone" } }));
    await type(page, ...CHANGES.objects)();
    await tiles.nth(3).getByText("this frame is gone").waitFor();
    await keep(page, "video-sheet-refused-1280");
    end();
  });
} else {
  skip("the page on a video: there is no data");
}

await finish();
served.forEach(({ end }) => end());
await browser.close();

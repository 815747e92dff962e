// Draws the picture of the page in the README, of a synthetic scene.
import { resolve } from "node:path";

import { inFolder, launch, objecthood, tab, view } from "./house.mjs";

const file = resolve(process.argv[2]);
const browser = await launch();
await inFolder(async (folder) => {
  await objecthood("synth", "--family", "tabletop", "--seed", "34", "--scenes", "6", "--out", folder);
  // The page shows the names of the frames as the command line has them: without the folder of this machine.
  process.chdir(folder);
  const server = await view("tabletop");
  const { page } = await tab(browser);
  await page.goto(server.address);
  await page.waitForFunction(() => /shown in \d+ ms/.test(document.querySelector(".status")?.textContent ?? ""));
  await page.keyboard.press("5");
  // The middle of the surest object.
  await page.locator(".objects .id").first().click();
  const box = await page.evaluate(async () => {
    const body = await (await fetch("look", { method: "POST", body: '{"tab":1}' })).arrayBuffer();
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(body, 4, new DataView(body).getUint32(0, true))));
    return { ...header.scene.objects[0].box_px, image: header.scene.image };
  });
  const frame = await page.locator(".stage .frame").boundingBox();
  const scale = frame.width / box.image.width_px;
  const full = page.waitForResponse((r) => r.url().endsWith("/explain") && r.request().postDataJSON().in_full);
  await page.mouse.click(frame.x + scale * (box.u + box.width / 2), frame.y + scale * (box.v + box.height / 2));
  await full;
  await page.waitForTimeout(1000);
  await page.screenshot({ path: file, type: "jpeg", quality: 82 });
  server.end();
});
await browser.close();

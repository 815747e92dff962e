// How long it takes from a slider to the picture on the screen: the median of 50 changes of a parameter of each stage.
import { CHANGES } from "./changes.mjs";
import { launch, scenes, tab, view } from "./house.mjs";

const COUNT = 50;

const { first } = await scenes();
const server = await view(first);
const browser = await launch();
const { page } = await tab(browser);
await page.goto(server.address);
await page.waitForFunction(() => /shown in \d+ ms/.test(document.querySelector(".status")?.textContent ?? ""));
const version = (await browser.version());
console.log(`${first}, Chromium ${version} without a graphics card\n\n| stage | parameter | median [ms] | 90 % below [ms] |\n|---|---|---|---|`);
for (const [stage, [name, value]] of Object.entries(CHANGES)) {
  const box = page.locator(`[id="p-${name}"]`);
  const usual = Number(await box.inputValue());
  const times = [];
  for (let k = 0; k < COUNT; k++) {
    const took = await page.evaluate(([name, value]) => new Promise((resolve) => {
      new PerformanceObserver((list, observer) => {
        observer.disconnect();
        resolve(list.getEntries()[0].duration);
      }).observe({ entryTypes: ["measure"] });
      const box = document.getElementById(`p-${name}`);
      box.value = value;
      box.dispatchEvent(new Event("change", { bubbles: true }));
    }), [name, k % 2 === 0 ? value : usual]);
    times.push(took);
  }
  times.sort((a, b) => a - b);
  console.log(`| ${stage} | ${name} | ${times[COUNT / 2].toFixed(0)} | ${times[0.9 * COUNT].toFixed(0)} |`);
}
server.end();
await browser.close();

// The pace of the live view with a browser on the same machine: pictures a second, the time from a click to its
// picture, the work at rest, memory. Prints a table of medians. See .ci/page.
const { chromium } = require("playwright-core");
const { spawn } = require("node:child_process");
const { readFileSync } = require("node:fs");
const os = require("node:os");

const [folder, seconds] = process.argv.slice(2);
const FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"];
const median = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Processor time that a process has taken, s; and what it holds in memory, MB. */
function spent(pid) {
  const fields = readFileSync(`/proc/${pid}/stat`, "utf8").split(") ")[1].split(" ");
  return (Number(fields[11]) + Number(fields[12])) / 100;
}

function held(pid) {
  return Number(readFileSync(`/proc/${pid}/status`, "utf8").match(/VmRSS:\s+(\d+)/)[1]) / 1024;
}

/** What the page says of itself: pictures over the last second, ms from the last click to its picture. */
async function shown(page) {
  const text = await page.textContent("#numbers");
  const [, rate, delay] = text.match(/(\d+) pictures\/s(?:, (\d+) ms)?/) || [];
  return { rate: Number(rate), delay: Number(delay) };
}

/** Does something again and again for a while, and asks the page after each time. */
async function watched(page, ms, deed) {
  const [rates, delays] = [[], []];
  for (let end = Date.now() + ms, i = 0; Date.now() < end; i++) {
    await deed(i);
    const { rate, delay } = await shown(page);
    if (Date.now() > end - ms + 1500) rates.push(rate), delays.push(delay);
  }
  return { rate: median(rates), delay: median(delays) };
}

async function measured(browser, width, lasting) {
  const program = spawn(process.env.SUNGAZE, ["view", "--no-open", "--width", width, "--out", `${folder}/viewings`]);
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  try {
    await page.goto(await new Promise((resolve) => program.stdout.once("data", (text) => resolve(String(text).trim()))));
    await page.getByRole("button", { name: "Stare at the light" }).click();
    const box = await page.locator("#canvas").boundingBox();
    const at = (x, y) => [box.x + x * box.width, box.y + y * box.height];
    const still = await watched(page, 8000, () => pause(500));
    const clicks = await watched(page, 10000, async () => (await page.mouse.click(...at(0.2 + 0.6 * Math.random(), 0.2 + 0.6 * Math.random())), pause(300)));
    await page.mouse.move(...at(0.5, 0.3));
    await page.mouse.down();
    const drag = await watched(page, 10000, async (i) => (await page.mouse.move(...at(0.5 + 0.3 * Math.sin(i / 20), 0.5 - 0.3 * Math.cos(i / 20))), pause(10)));
    await page.mouse.up();
    await page.keyboard.press("Space");
    await pause(1000);
    const before = spent(program.pid);
    await pause(5000);
    const rest = 20 * (spent(program.pid) - before);
    const memory = [];
    if (lasting > 0) {
      await page.keyboard.press("Space");
      await page.locator("#speed span", { hasText: /^100/ }).click();
      for (let i = 0; i <= 6; i++) {
        memory.push(held(program.pid).toFixed(0));
        if (i < 6) await pause((1000 * lasting) / 6);
      }
    }
    console.log(`| ${width} x ${(width * 9) / 16} | ${still.rate} | ${clicks.rate} | ${drag.rate} | ${clicks.delay} ms | ${rest.toFixed(1)} % | ${memory.join(", ")} |`);
  } finally {
    program.kill();
    await page.close();
  }
}

async function main() {
  const browser = await chromium.launch({ executablePath: process.env.BROWSER, args: FLAGS });
  console.log(`${os.cpus().length} processors, load ${os.loadavg().map((load) => load.toFixed(1)).join(" ")}`);
  console.log("| picture | pictures/s held | clicked | dragged | click to picture | of a core at rest | MB at 100x, every sixth |\n|---|---|---|---|---|---|---|");
  await measured(browser, 480, 0);
  await measured(browser, 960, Number(seconds));
  console.log(`load ${os.loadavg().map((load) => load.toFixed(1)).join(" ")}`);
  await browser.close();
}

main().catch((error) => { console.error(error); process.exit(1); });

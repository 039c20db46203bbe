// What must be in the page, asked of a real browser: report.html from the disk, then the live view. See .ci/page.
const { chromium } = require("playwright-core");
const { spawn } = require("node:child_process");
const assert = require("node:assert/strict");

const [folder, shots] = process.argv.slice(2);
const FLAGS = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking",
  "--disable-component-update", "--disable-sync"];
const LOOKS = [["light", 1280], ["light", 390], ["dark", 1280], ["dark", 390]];

/** A page that fails on any error and on any request beyond `origin`. */
async function opened(browser, url, origin, [scheme, width]) {
  const context = await browser.newContext({ viewport: { width, height: 800 }, colorScheme: scheme });
  const page = await context.newPage();
  const faults = [];
  page.on("pageerror", (error) => faults.push(error.message));
  page.on("console", (message) => message.type() === "error" && faults.push(message.text()));
  page.on("request", (request) => {
    if (!request.url().startsWith(origin) && !/^(data|blob):/.test(request.url())) faults.push(`asked for ${request.url()}`);
  });
  await page.goto(url);
  return { page, close: async () => { assert.deepEqual(faults, []); await context.close(); } };
}

/** What holds for both uses: nothing beside the screen, everything to operate has a name. */
async function sound(page) {
  const wide = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
  assert.ok(wide <= 0, `the page is ${wide} pixels wider than the screen`);
  const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input, select")]
    .filter((element) => element.checkVisibility() && !element.labels?.length && !element.ariaLabel && !element.textContent.trim())
    .map((element) => element.outerHTML));
  assert.deepEqual(nameless, []);
}

async function report(browser, look) {
  const url = `file://${folder}/sunset/report.html`;
  const { page, close } = await opened(browser, url, `file://${folder}/`, look);
  const words = await page.textContent("#words");
  for (const heading of ["Not modelled", "Plan", "Check", "Constants and their sources", "Settings"]) assert.ok(words.includes(heading), heading);
  assert.equal(await page.locator("#curves svg[role=img]").count(), 3);
  const clock = () => page.textContent("#clock");
  await page.keyboard.press("End");
  assert.equal(await clock(), "60.0 s");
  await page.keyboard.press("Home");
  for (let i = 0; i < 35; i++) await page.keyboard.press("ArrowRight");
  await page.waitForTimeout(400);
  const stage = page.locator("#stage");
  const after = await stage.screenshot();
  await page.keyboard.down("b");
  await page.waitForTimeout(200);
  assert.ok(!after.equals(await stage.screenshot()), "holding B shows the picture before");
  await page.keyboard.up("b");
  await page.focus("#wipe");
  for (let i = 0; i < 50; i++) await page.keyboard.press("ArrowRight");
  assert.ok(await page.isVisible("#edge"), "the wipe has an edge");
  await sound(page);
  await page.screenshot({ path: `${shots}/report.${look.join(".")}.png`, fullPage: true });
  await close();
}

/** Mean red, green and blue of the live picture around a point, fractions. */
function colour(page, x, y) {
  return page.evaluate(([x, y]) => {
    const canvas = document.getElementById("canvas");
    const { data } = canvas.getContext("2d").getImageData(x * canvas.width - 2, y * canvas.height - 2, 5, 5);
    return [0, 1, 2].map((k) => data.filter((_, i) => i % 4 === k).reduce((a, b) => a + b) / 25);
  }, [x, y]);
}

async function until(what, holds) {
  for (let i = 0; i < 300; i++) {
    if (await holds()) return;
    await new Promise((resolve) => setTimeout(resolve, 100));
  }
  assert.fail(`never: ${what}`);
}

async function live(browser, url, look) {
  const { page, close } = await opened(browser, url, new URL(url).origin, look);
  const time = async () => parseFloat(await page.textContent("#clock"));
  await until("a first picture", async () => (await page.textContent("#numbers")).includes("Gaze"));
  await page.keyboard.press("r");
  await page.getByRole("button", { name: "Stare at the light" }).waitFor();
  await until("a picture of the red sun", async () => { const [r, g] = await colour(page, 0.5, 0.5); return r > g + 60; });
  await page.screenshot({ path: `${shots}/live.begin.${look.join(".")}.png` });
  await page.focus("#begin");
  await page.keyboard.press("Enter");
  await until("the sun turns green", async () => { const [r, g] = await colour(page, 0.5, 0.5); return g > r + 60; });
  const shown = await page.textContent("#numbers");
  const elsewhere = await colour(page, 0.25, 0.3);
  const box = await page.locator("#canvas").boundingBox();
  await page.mouse.click(box.x + 0.25 * box.width, box.y + 0.3 * box.height);
  await until("an after-image at the new gaze", async () => (await colour(page, 0.25, 0.3))[0] < elsewhere[0] - 30);
  await page.keyboard.press("Space");
  await page.waitForTimeout(500);
  const stopped = await time();
  await page.waitForTimeout(400);
  assert.equal(await time(), stopped, "space pauses");
  await page.screenshot({ path: `${shots}/live.after.${look.join(".")}.png`, fullPage: true });
  await page.keyboard.down("b");
  await until("before, while B is held", async () => (await colour(page, 0.25, 0.3))[0] > elsewhere[0] - 10);
  await page.keyboard.up("b");
  await page.keyboard.press("ArrowDown");
  await until("an arrow key looks elsewhere", async () => (await page.textContent("#numbers")).includes("0.310"));
  await page.locator("#time").evaluate((slider) => { slider.value = 0.5; slider.dispatchEvent(new Event("input")); });
  await until("the slider goes back", async () => (await time()) <= 0.5);
  await page.getByRole("button", { name: "Save" }).click();
  await until("saved", async () => (await page.textContent("#hint")).startsWith("Saved"));
  await page.getByLabel("Age").fill("70");
  await until("the eye has aged", async () => (await page.locator("label", { hasText: /^Age$/ }).locator("xpath=following-sibling::output").textContent()) === "70 years");
  await page.getByLabel("Age").fill("30");
  await sound(page);
  await close();
  return shown;
}

/** A visit by the keyboard alone: every control is reached, and its keys do what they say. */
async function keyboard(browser, url) {
  const { page, close } = await opened(browser, url, new URL(url).origin, LOOKS[0]);
  const focused = () => page.evaluate(() => document.activeElement.id || document.activeElement.name);
  const press = async (...keys) => { for (const key of keys) await page.keyboard.press(key); };
  const clock = async () => parseFloat(await page.textContent("#clock"));
  await until("a first picture", async () => (await page.textContent("#numbers")).includes("Gaze"));
  await press("r");
  await page.getByRole("button", { name: "Stare at the light" }).waitFor();
  await page.focus("#begin");
  await press("Enter");
  await until("time runs", async () => (await clock()) > 1);
  await press("Shift+ArrowLeft", "Shift+ArrowLeft");
  await until("the gaze has moved", async () => (await page.textContent("#numbers")).includes("0.300, 0.500"));
  const reached = new Set();
  for (let i = 0; i < 30; i++) {
    await press("Tab");
    reached.add(await focused());
  }
  for (const control of ["play", "time", "speed", "before", "rest", "save"]) assert.ok(reached.has(control), `${control} is reached`);
  await page.focus("#time");
  await press("Space");
  await until("space pauses from the slider", async () => (await page.textContent("#play")) === "Play");
  const last = await clock();
  await press("Home");
  await until("the slider begins at the start", async () => (await clock()) === 0);
  await press("End");
  await until("and ends at the end", async () => (await clock()) === last);
  await page.focus("#before");
  const shown = () => page.evaluate(() => document.getElementById("canvas").toDataURL());
  const after = await shown();
  await page.keyboard.down("Space");
  await until("before, while its button is held", async () => (await shown()) !== after);
  await page.keyboard.up("Space");
  await until("and after again", async () => (await shown()) === after);
  await page.focus("#save");
  await press("Enter");
  await until("saved", async () => (await page.textContent("#hint")).startsWith("Saved"));
  await page.focus("#saved");
  await press("ArrowDown");
  await until("opened", async () => (await page.textContent("#hint")).includes("lived again"));
  await until("lived again", async () => (await clock()) === last);
  await close();
}

async function stranger(browser, url) {
  const { page, close } = await opened(browser, url.replace(/#t=.*/, "#t=guessed"), new URL(url).origin, LOOKS[0]);
  await until("a page without the token is told", async () => (await page.textContent("#hint")).includes("lacks its token"));
  await close();
}

async function main() {
  const browser = await chromium.launch({ executablePath: process.env.BROWSER, args: FLAGS });
  for (const look of LOOKS) await report(browser, look);
  const program = spawn(process.env.SUNGAZE, ["view", "--no-open", "--out", `${folder}/viewings`]);
  try {
    const url = await new Promise((resolve) => program.stdout.once("data", (text) => resolve(String(text).trim())));
    await stranger(browser, url);
    await keyboard(browser, url);
    for (const look of LOOKS) console.log(look.join(" "), (await live(browser, url, look)).match(/Shown(.*)/)?.[1] ?? "");
  } finally {
    program.kill();
    await browser.close();
  }
  console.log(`page: report and live view hold; screenshots in ${shots}`);
}

main().catch((error) => { console.error(error); process.exit(1); });

// Drives a browser through report pages, from the disk and without a network, and prints as JSON
// what it saw: `node drive.mjs FOLDER PEAK MAIN-PAGE OTHER-PAGE…`. PEAK is the link (`#t=…`) of a
// peak between samples. Pictures go into the folder.
import { chromium } from "playwright-core";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { basename, join } from "node:path";
import { pathToFileURL } from "node:url";

const [folder, peakLink, main, ...others] = process.argv.slice(2);

const SIZES = { desktop: { width: 1440, height: 900 }, phone: { width: 390, height: 844 } };

const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: [
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
  ],
});

/** Opens a page, and keeps what goes wrong and what it asks for. */
async function open(path, { size = "desktop", colorScheme = "light", hash = "", ...more } = {}) {
  const context = await browser.newContext({ viewport: SIZES[size], colorScheme, ...more });
  const page = await context.newPage();
  const seen = { requests: [], troubles: [] };
  page.on("request", (request) => seen.requests.push(request.url().slice(0, 200)));
  page.on("console", (message) => {
    if (["error", "warning"].includes(message.type())) seen.troubles.push(message.text());
  });
  page.on("pageerror", (error) => seen.troubles.push(String(error.stack)));
  await page.goto(pathToFileURL(path) + hash);
  await page.waitForSelector("html[data-ready], #trouble:not([hidden])", { timeout: 60_000 });
  return { page, seen };
}

const timeOf = async (page) => Number(await page.inputValue("#time"));

const picture = async (page, id) => {
  const data = await page.evaluate((name) => document.getElementById(name).toDataURL(), id);
  return createHash("sha256").update(data).digest("hex");
};

/** Every value that the charts tell, with what it is of. */
const readings = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll(".card[open] .panel")].flatMap((panel) =>
      [...panel.querySelectorAll(".key")].map((key) => ({
        quantity: panel.closest(".card").id,
        run: panel.querySelector(".run-name")?.textContent ?? "",
        item: key.querySelector("span").textContent,
        dashed: key.classList.contains("dashed"),
        text: key.querySelector("output").textContent,
      })),
    ),
  );

const stretches = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll(".card[open] .chart")].map(({ dataset }) => [Number(dataset.from), Number(dataset.to)]),
  );

/** Places of the time cursors, as times (ms), of all charts that show them. */
const cursors = (page) =>
  page.evaluate(() =>
    [...document.querySelectorAll(".card[open] .chart")].map((chart) => {
      const over = chart.querySelector(".u-over").getBoundingClientRect();
      const line = chart.querySelector(".now").getBoundingClientRect();
      const [from, to] = [Number(chart.dataset.from), Number(chart.dataset.to)];
      return from + ((line.left + line.width / 2 - over.left) / over.width) * (to - from);
    }),
  );

const chartBox = (page, card) => page.locator(`${card} .u-over`).first().boundingBox();

/** A link leads to its moment: charts, cursors, drawing, table. */
async function link(page) {
  await page.evaluate(() => (location.hash = "#t=12.53&run=four-bar-c"));
  await page.waitForFunction(() => document.getElementById("time").value === "12.5300");
  return {
    time: await timeOf(page),
    shown: await page.evaluate(() => document.querySelector("#shown input:checked").parentElement.textContent),
    readings: await readings(page),
    cursors: await cursors(page),
    moment: await page.innerText("#moment"),
    address: await page.getAttribute("#link", "href"),
  };
}

/** Goes to a link, and waits for its moment. */
async function goTo(page, hash) {
  await page.evaluate((to) => (location.hash = to), hash);
  const time = Number(hash.match(/t=([\d.]+)/)[1]).toFixed(4);
  await page.waitForFunction((told) => document.getElementById("time").value === told, time);
}

/** A link carries the zoom of the charts. */
async function zoomLink(page) {
  await goTo(page, "#t=12.53&run=four-bar-c&from=10&to=20");
  return {
    stretches: await stretches(page),
    address: await page.getAttribute("#link", "href"),
    told: await page.innerText("#stretch"),
  };
}

/** Charts over the crank angle: the same stretch, cursor, values, and what a click leads to. */
async function overAngle(page) {
  await page.selectOption("#over", "angle");
  const told = {
    stretches: await stretches(page),
    cursors: await cursors(page),
    readings: await readings(page),
    address: await page.getAttribute("#link", "href"),
  };
  const box = await chartBox(page, "#chart-force");
  told.pixel = 300 / box.width;
  await page.mouse.click(box.x + 0.25 * box.width, box.y + box.height / 2);
  told.clicked = await timeOf(page);
  await page.click("#zoom-all");
  [told.whole] = await stretches(page);
  await page.selectOption("#over", "time");
  await goTo(page, told.address);
  told.followed = await stretches(page);
  await page.selectOption("#over", "time");
  await page.click("#zoom-all");
  return told;
}

/** What is drawn on the stage while something happens: bold values, and how far lines reach. */
async function drawnOnStage(page, happen) {
  await page.evaluate(() => {
    const kept = { fillText: CanvasRenderingContext2D.prototype.fillText, lineTo: CanvasRenderingContext2D.prototype.lineTo };
    window.drawn = { kept, labels: [], across: [Infinity, -Infinity], down: [Infinity, -Infinity] };
    const { drawn } = window;
    CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
      const isValue = this.canvas.id === "stage" && this.font.includes("600") && /^[\d.]+ \D*N$/.test(text);
      if (isValue) drawn.labels.push({ text, x, y, width: this.measureText(text).width });
      return kept.fillText.call(this, text, x, y);
    };
    CanvasRenderingContext2D.prototype.lineTo = function (x, y) {
      if (this.canvas.id === "stage") {
        drawn.across = [Math.min(drawn.across[0], x), Math.max(drawn.across[1], x)];
        drawn.down = [Math.min(drawn.down[0], y), Math.max(drawn.down[1], y)];
      }
      return kept.lineTo.call(this, x, y);
    };
  });
  await happen();
  return page.evaluate(() => {
    const { kept, ...drawn } = window.drawn;
    Object.assign(CanvasRenderingContext2D.prototype, kept);
    const { clientWidth: width, clientHeight: height } = document.getElementById("stage");
    return { ...drawn, width, height };
  });
}

/** Arrows longer than the stage. */
async function arrows(page) {
  await goTo(page, "#t=12.53&run=four-bar-c");
  const before = await drawnOnStage(page, () => page.locator("#arrows").fill("80"));
  const { labels: after, ...reach } = await drawnOnStage(page, () => page.locator("#arrows").fill("160"));
  await page.locator("#stage").screenshot({ path: join(folder, "arrows.png") });
  await page.locator("#arrows").fill("81");
  return { before: before.labels, after, ...reach };
}

async function paths(page) {
  const whole = await picture(page, "paths");
  await goTo(page, "#t=12.53&run=four-bar-c&from=10&to=20");
  const zoomed = await picture(page, "paths");
  await goTo(page, "#t=13");
  const told = { whole, zoomed, moved: await picture(page, "paths"), words: await page.innerText("#chart-paths .note") };
  await page.locator("#chart-paths").screenshot({ path: join(folder, "paths.png") });
  await page.evaluate(() => scrollTo(0, 0));
  await page.click("#zoom-all");
  return told;
}

/** Saves a picture and a film, and plays the film. */
async function saved(page) {
  await goTo(page, "#t=12&run=four-bar-c&from=12&to=13");
  await page.selectOption("#speed", String(1 / 1000));
  const press = async (id) => {
    const [download] = await Promise.all([page.waitForEvent("download", { timeout: 60_000 }), page.click(id)]);
    const path = join(folder, id === "#film" ? "film.webm" : "picture.png");
    await download.saveAs(path);
    return { name: download.suggestedFilename(), bytes: readFileSync(path) };
  };
  const told = {};
  for (const [name, id] of [["picture", "#picture"], ["film", "#film"]]) {
    const { bytes, ...file } = await press(id);
    told[name] = { ...file, head: bytes.subarray(0, 8).toString("hex") };
    if (name === "picture") told.picture.width = bytes.readUInt32BE(16) & ~1;
    else told.played = await playFilm(bytes);
  }
  await page.click("#zoom-all");
  return { ...told, button: await page.innerText("#film") };
}

async function playFilm(bytes) {
  const page = await browser.newPage();
  const told = await page.evaluate(async (data) => {
    const film = Object.assign(document.createElement("video"), { muted: true, src: `data:video/webm;base64,${data}` });
    const happens = (name) => new Promise((done) => film.addEventListener(name, done, { once: true }));
    await happens("loadeddata");
    const frame = () => {
      const canvas = Object.assign(document.createElement("canvas"), { width: film.videoWidth, height: film.videoHeight });
      canvas.getContext("2d").drawImage(film, 0, 0);
      return canvas.toDataURL();
    };
    const first = frame();
    // Such files do not tell their length: the end is sought beyond it.
    film.currentTime = 1e6;
    await happens("seeked");
    // What is sought is drawn a little later than it is found.
    let last = frame();
    for (let look = 0; look < 100 && last === first; look++) {
      await new Promise((done) => setTimeout(done, 50));
      last = frame();
    }
    return { width: film.videoWidth, first, last, seconds: film.currentTime };
  }, bytes.toString("base64"));
  await page.close();
  const hash = (text) => createHash("sha256").update(text).digest("hex");
  return { ...told, first: hash(told.first), last: hash(told.last) };
}

/** Powers of ten as computers write them, anywhere but in the case's own text. */
const powers = (page) =>
  page.evaluate(() => {
    for (const node of document.querySelectorAll("#made details")) node.open = true;
    const words = [...document.querySelectorAll("main > :not(#made), #made table")].map((node) => node.innerText).join("\n");
    for (const node of document.querySelectorAll("#made details")) node.open = false;
    const shown = words.split("\n").filter((line) => !/sha256|SHA-256|quote|source/.test(line));
    return { words, computers: shown.filter((line) => /\d[eE][-+]?\d|10\^/.test(line)) };
  });

/** Targets of fingers that are too small on a phone. */
async function touch() {
  const { page } = await open(main, { size: "phone", hasTouch: true, isMobile: true, hash: "#t=12.53&run=four-bar-c" });
  await page.evaluate(() => document.querySelector(".look").setAttribute("open", ""));
  const told = await page.evaluate(() => {
    const nodes = [...document.querySelectorAll("a, button, select, input, summary")].filter((node) => node.getClientRects().length);
    const targets = nodes.map((node) => node.closest("label") ?? node);
    const small = targets.filter((node) => {
      const { width, height } = node.getBoundingClientRect();
      return width < 40 || height < 40;
    });
    const overflow = document.documentElement.scrollWidth - innerWidth;
    return { count: targets.length, small: small.map((node) => node.outerHTML.slice(0, 120)), overflow };
  });
  await page.screenshot({ path: join(folder, "touch.png"), fullPage: true });
  await page.context().close();
  return told;
}

/** A peak between samples is told like any value. */
async function peak(page) {
  await page.evaluate((hash) => (location.hash = hash), peakLink);
  await page.waitForFunction((time) => document.getElementById("time").value === time, Number(peakLink.match(/t=([\d.]+)/)[1]).toFixed(4));
  return { readings: await readings(page) };
}

async function play(page) {
  const before = { time: await timeOf(page), stage: await picture(page, "stage"), dials: await picture(page, "dials") };
  await page.click("#play");
  const pressed = await page.getAttribute("#play", "aria-pressed");
  await page.waitForFunction((time) => Number(document.getElementById("time").value) > time + 0.1, before.time);
  await page.click("#play");
  const after = { time: await timeOf(page), stage: await picture(page, "stage"), dials: await picture(page, "dials") };
  await page.waitForTimeout(200);
  return { before, after, pressed, later: await timeOf(page) };
}

async function slowMotion(page) {
  await page.selectOption("#speed", String(1 / 20000));
  const before = { time: await timeOf(page), clock: Date.now() };
  await page.click("#play");
  await page.waitForTimeout(1000);
  await page.click("#play");
  return { passed: (await timeOf(page)) - before.time, wall: Date.now() - before.clock };
}

async function click(page) {
  const box = await chartBox(page, "#chart-force");
  const [[from, to]] = await stretches(page);
  await page.mouse.click(box.x + 0.25 * box.width, box.y + box.height / 2);
  const expected = from + 0.25 * (to - from);
  return { expected, time: await timeOf(page), pixel: (to - from) / box.width, cursors: await cursors(page) };
}

/** Drags over a chart: all must show the stretch; a double click brings the whole back. */
async function drag(page) {
  const box = await chartBox(page, "#chart-force");
  const [[from, to]] = await stretches(page);
  const y = box.y + box.height / 2;
  await page.mouse.move(box.x + 0.4 * box.width, y);
  await page.mouse.down();
  await page.mouse.move(box.x + 0.42 * box.width, y, { steps: 4 });
  await page.mouse.move(box.x + 0.45 * box.width, y, { steps: 4 });
  await page.mouse.up();
  const zoomed = await stretches(page);
  const expected = [0.4, 0.45].map((share) => from + share * (to - from));
  const hovered = await hover(page, box);
  await page.mouse.dblclick(box.x + 0.6 * box.width, y);
  return { expected, zoomed, hovered, pixel: (to - from) / box.width, back: await stretches(page) };
}

/** What the force chart tells under the pointer, at several places. */
async function hover(page, box) {
  const told = [];
  for (const share of [0.2, 0.33, 0.5, 0.71, 0.9]) {
    await page.mouse.move(box.x + share * box.width, box.y + 10);
    await page.waitForTimeout(60);
    told.push({ pointer: await page.innerText("#pointer"), readings: await readings(page) });
  }
  return told;
}

async function keys(page) {
  const times = {};
  const at = async (name) => (times[name] = await timeOf(page));
  await page.evaluate(() => document.activeElement?.blur());
  await page.keyboard.press("Home");
  await at("home");
  await page.keyboard.press("ArrowRight");
  await at("right");
  await page.keyboard.press("Shift+ArrowRight");
  await at("shiftRight");
  await page.keyboard.press("ArrowLeft");
  await at("left");
  for (const name of ["next", "afterNext"]) {
    await page.keyboard.press("n");
    await at(name);
  }
  await page.keyboard.press("p");
  await at("previous");
  await page.keyboard.press("End");
  await at("end");
  await page.keyboard.press("Home");
  await page.keyboard.press("Space");
  const playing = await page.getAttribute("#play", "aria-pressed");
  await page.keyboard.press("Space");
  const stopped = await page.getAttribute("#play", "aria-pressed");
  return { times, playing, stopped, chart: await chartKeys(page), slider: await sliderKeys(page) };
}

/** With the focus on a chart, keys are the chart's. */
async function chartKeys(page) {
  await page.evaluate(() => (location.hash = "#t=5"));
  await page.waitForFunction(() => document.getElementById("time").value === "5.0000");
  await page.focus("#chart-force .chart");
  await page.keyboard.press("ArrowRight");
  const right = await timeOf(page);
  await page.keyboard.press("ArrowLeft");
  const left = await timeOf(page);
  await page.keyboard.press("+");
  const zoomed = await stretches(page);
  await page.keyboard.press("0");
  return { right, left, zoomed, back: await stretches(page) };
}

async function sliderKeys(page) {
  await page.focus("#slider");
  const before = Number(await page.inputValue("#slider"));
  await page.keyboard.press("ArrowRight");
  return { notches: Number(await page.inputValue("#slider")) - before, told: await page.getAttribute("#slider", "aria-valuetext") };
}

/** The reader's factor changes the drawing, and the drawing says so. */
async function factor(page) {
  const before = await picture(page, "stage");
  await page.click(".look summary");
  await page.locator("#factor").fill("0");
  return { before, after: await picture(page, "stage"), told: await page.innerText("#factor-value") };
}

/** What a screen reader finds. */
const names = (page) =>
  page.evaluate(() => {
    const named = (node) =>
      node.getAttribute("aria-label") || node.labels?.[0]?.textContent.trim() || node.textContent.trim() || node.title;
    const controls = [...document.querySelectorAll("button, input, select, canvas[id], [role=application]")];
    return {
      nameless: controls.filter((node) => node.getAttribute("aria-hidden") !== "true" && !named(node)).map((node) => node.outerHTML.slice(0, 200)),
      tables: document.querySelectorAll("section table").length,
      rows: document.querySelectorAll("#contacts tbody tr").length,
    };
  });

async function pictures() {
  const taken = [];
  for (const size of Object.keys(SIZES)) {
    for (const colorScheme of ["light", "dark"]) {
      const { page, seen } = await open(main, { size, colorScheme, hash: "#t=12.53&run=four-bar-c" });
      const path = join(folder, `${size}-${colorScheme}.png`);
      const bytes = await page.screenshot({ path });
      const overflow = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      const paper = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
      taken.push({ size, colorScheme, bytes: bytes.length, overflow, paper, cursors: await cursors(page), troubles: seen.troubles });
      if (size === "desktop" && colorScheme === "dark") {
        const pdf = await page.pdf({ path: join(folder, "print.pdf"), format: "A4", printBackground: true });
        taken.at(-1).pdf = pdf.length;
      }
      await page.context().close();
    }
  }
  return taken;
}

async function otherPages() {
  const told = {};
  for (const path of others) {
    const { page, seen } = await open(path);
    const time = await timeOf(page);
    await page.keyboard.press("n");
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("End");
    await page.waitForTimeout(50);
    told[basename(path, ".html")] = {
      ...seen,
      ready: await page.evaluate(() => document.documentElement.dataset.ready === "yes"),
      title: await page.title(),
      heading: await page.innerText("h1"),
      text: await page.innerText("main"),
      begin: time,
      end: await timeOf(page),
      charts: await page.locator(".card[open] .uplot").count(),
      playable: await page.isEnabled("#play"),
      overAngle: await page.locator("#over").isVisible(),
      paths: await page.locator("#paths").isVisible(),
    };
    await page.screenshot({ path: join(folder, `${basename(path, ".html")}.png`) });
    await page.context().close();
  }
  return told;
}

const { page, seen } = await open(main);
const told = { ...seen };
for (const step of [peak, link, zoomLink, overAngle, factor, arrows, paths, play, slowMotion, click, drag, keys, names, powers, saved]) {
  told[step.name] = await step(page);
}
await page.context().close();
told.touch = await touch();
told.pictures = await pictures();
told.others = await otherPages();
await browser.close();
console.log(JSON.stringify(told));

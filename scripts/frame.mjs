// A frame of a report page's animation, as a PNG: `node frame.mjs PAGE HASH PICTURE`. HASH is a
// link to the moment, as the page gives it: `#t=12.53&run=four-bar-c`.
import { pathToFileURL } from "node:url";
import { chromium } from "../tests/browser/node_modules/playwright-core/index.mjs";

const [page, hash, picture] = process.argv.slice(2);

const browser = await chromium.launch({
  executablePath: "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking"],
});
const context = await browser.newContext({
  viewport: { width: 1440, height: 900 },
  deviceScaleFactor: 2,
  colorScheme: "light",
});
const tab = await context.newPage();
await tab.goto(pathToFileURL(page) + hash);
await tab.waitForSelector("html[data-ready]", { timeout: 60_000 });
const stage = tab.locator("#stage");
await stage.evaluate((canvas) => (canvas.style.border = "none"));
await stage.screenshot({ path: picture });
await browser.close();

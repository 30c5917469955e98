// Puts the page together.
import { refreshTheme, setUpTheme, lightForPrint } from "./theme.js";
import { fixed, significant } from "./format.js";
import { readRuns } from "./run.js";
import { Clock } from "./clock.js";
import { Stage } from "./stage.js";
import { Dials } from "./dials.js";
import { Strip } from "./strip.js";
import { Transport } from "./transport.js";
import { Charts } from "./charts.js";
import { Paths } from "./paths.js";
import { Film } from "./film.js";

const byId = (id) => document.getElementById(id);

async function start() {
  if (typeof DecompressionStream === "undefined") {
    throw new Error("this browser cannot unpack gzip (Chrome 80, Firefox 113, Safari 16.4 and later can)");
  }
  const runs = await readRuns(byId("runs"));
  refreshTheme();
  const sampled = runs.filter((run) => run.times.length > 0);
  byId("motion").hidden = sampled.length === 0;
  const begin = Math.min(...sampled.map((run) => run.begin));
  const end = Math.max(...sampled.map((run) => run.end));
  const clock = sampled.length ? new Clock(begin, end) : new Clock(0, 0);
  const colourOf = jointColours(runs);
  const stage = new Stage(byId("stage"), runs, clock, colourOf);
  new Dials(byId("dials"), stage, clock, colourOf);
  const charts = new Charts(byId("charts"), runs, clock, colourOf);
  const strip = new Strip(byId("strip"), runs, stage, clock, colourOf, () => charts.times());
  const paths = new Paths(byId("charts"), charts.own, clock, colourOf, (run) => charts.stretchOf(run));
  const transport = new Transport(runs, clock, stage, charts, colourOf);
  const film = new Film(stage, clock, () => charts.stretchOf(stage.shown[0]));
  charts.changes.push(() => strip.draw(), () => paths.redraw(), () => film.tell());
  setUpStage(stage, transport, () => {
    strip.redraw();
    clock.set(clock.time);
  });
  setUpTheme(byId("theme"));
  setUpPrint();
  transport.readLink();
  clock.set(clock.time);
  document.documentElement.dataset.ready = "yes";
}

/** The same colour for a joint in every run; those with clearance first. */
function jointColours(runs) {
  const names = [...runs.flatMap((run) => run.clearances), ...runs.flatMap((run) => run.joints)];
  const order = [...new Set(names)];
  return (name) => order.indexOf(name);
}

function setUpStage(stage, transport, changed) {
  const choice = byId("shown");
  const radios = [];
  const add = (text, shown) => {
    const radio = Object.assign(document.createElement("input"), { type: "radio", name: "shown" });
    radio.addEventListener("change", () => {
      stage.show(shown);
      changed();
    });
    const label = document.createElement("label");
    label.append(radio, Object.assign(document.createElement("span"), { textContent: text }));
    choice.append(label);
    radios.push({ radio, shown });
    return radio;
  };
  const drawn = stage.drawable;
  for (const run of drawn) add(run.label, [run]);
  if (drawn.length > 1) add("all", drawn);
  // An ideal mechanism is a ghost in the others; the first of these is the one to begin with.
  const first = radios.find(({ shown: [run] }) => run.clearances.length > 0) ?? radios[0];
  if (first) {
    first.radio.checked = true;
    stage.show(first.shown);
    changed();
  }
  choice.hidden = drawn.length < 2;
  transport.choose = (run) => {
    const wanted = radios.find(({ shown }) => shown.length === 1 && shown[0] === run);
    if (!wanted || wanted.radio.checked) return;
    wanted.radio.checked = true;
    stage.show(wanted.shown);
    changed();
  };
  setUpLook(stage, drawn);
}

function setUpLook(stage, drawn) {
  const follow = byId("follow");
  for (const name of new Set(drawn.flatMap((run) => run.joints))) follow.add(new Option(`joint ${name}`, name));
  follow.addEventListener("change", () => {
    stage.follow = follow.value || null;
    stage.draw();
  });
  setUpFactor(byId("factor"), byId("factor-value"), stage.factor, 1, Math.max(10, 4 * stage.factor), (value) => {
    stage.factor = value;
    stage.draw();
  });
  byId("factor").closest("label").hidden = stage.clearances().length === 0;
  setUpFactor(byId("arrows"), byId("arrows-value"), 1, 0.1, 30, (value) => {
    stage.forceFactor = value;
    stage.draw();
  });
  const box = (id, name) => byId(id).addEventListener("change", (event) => {
    stage[name] = event.target.checked;
    stage.draw();
  });
  box("forces", "forces");
  box("ghost", "ghost");
  byId("ghost").closest("label").hidden = drawn.every((run) => !run.reference);
}

/** A slider whose notches are equal ratios. */
function setUpFactor(slider, output, value, least, most, set) {
  const ratio = most / least;
  slider.max = 200;
  slider.value = Math.round((200 * Math.log(value / least)) / Math.log(ratio));
  const tell = (factor) => {
    output.textContent = `× ${factor < 10 ? significant(factor, 2) : fixed(factor, 0)}`;
    slider.setAttribute("aria-valuetext", output.textContent);
  };
  tell(value);
  slider.addEventListener("input", () => {
    const factor = Number(Number(least * ratio ** (slider.value / 200)).toPrecision(2));
    tell(factor);
    set(factor);
  });
}

/** On paper all is light, and contact tables stay as they are on the screen. */
function setUpPrint() {
  addEventListener("beforeprint", () => lightForPrint(true));
  addEventListener("afterprint", () => lightForPrint(false));
}

start().catch((error) => {
  const place = byId("trouble");
  place.hidden = false;
  place.textContent = `The charts and the drawing cannot be shown: ${error.message}. The tables can be read.`;
  console.error(error);
});

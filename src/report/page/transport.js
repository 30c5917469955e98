// Play, pause, slow motion, slider, jumps from impact to impact, keys, links to a moment.
import { SPEEDS } from "./clock.js";
import { fraction, inUnit, milliseconds, significant, prefixed } from "./format.js";
import { seriesColour } from "./theme.js";

/** Positions of the slider. */
const NOTCHES = 10000;

/** Shortest time between two updates of the tables while it plays (ms). */
const TABLE_INTERVAL = 120;

const find = (id) => document.getElementById(id);

export class Transport {
  constructor(runs, clock, stage, charts, colourOf) {
    Object.assign(this, { runs, clock, stage, charts, colourOf, told: 0 });
    const { begin, end } = clock;
    this.slider = find("slider");
    this.slider.max = NOTCHES;
    this.slider.disabled = find("play").disabled = end <= begin;
    this.slider.addEventListener("input", () => clock.set(begin + (this.slider.value / NOTCHES) * (end - begin)));
    this.setUpSpeeds();
    this.setUpButtons();
    find("time").addEventListener("change", (event) => clock.set(Number(event.target.value) / 1e3));
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("hashchange", () => this.readLink());
    clock.watch((tick) => this.follow(tick));
    charts.changes.push(() => this.writeLink());
    this.readLink();
    this.follow({ playing: false });
  }

  setUpSpeeds() {
    const select = find("speed");
    for (const speed of SPEEDS) select.add(new Option(fraction(speed), speed, false, speed === this.clock.speed));
    select.addEventListener("change", () => (this.clock.speed = Number(select.value)));
  }

  setUpButtons() {
    const press = (id, action) => find(id).addEventListener("click", action);
    press("play", () => this.clock.toggle());
    press("first", () => this.clock.set(this.clock.begin));
    press("previous-impact", () => this.jump(-1));
    press("next-impact", () => this.jump(1));
    press("back", () => this.step(-1));
    press("forward", () => this.step(1));
    const none = this.runs.every((run) => run.contacts.length === 0);
    find("previous-impact").disabled = find("next-impact").disabled = none;
    press("link", () => this.copyLink());
  }

  /** Runs whose impacts and samples count: those on the stage, or all where none is drawn. */
  counted() {
    return this.stage.shown.length ? this.stage.shown : this.runs;
  }

  /** Goes to the peak of the next or the previous impact. */
  jump(direction) {
    this.clock.pause();
    const peaks = this.counted().flatMap((run) => run.contacts.map(({ peakTime }) => peakTime));
    this.goBeyond(peaks, direction);
  }

  /** Goes to the next or the previous sample. */
  step(direction, count = 1) {
    this.clock.pause();
    const run = this.counted()[0];
    if (!run || run.times.length === 0) return;
    let row = run.rowAt(this.clock.time) + direction;
    const onRow = run.times[row - direction] === this.clock.time;
    if (direction < 0 && !onRow) row += 1;
    for (let left = count; ; row += direction) {
      if (row < 0 || row >= run.times.length) break;
      if (run.isSample[row] && --left === 0) break;
    }
    this.clock.set(run.times[Math.min(Math.max(row, 0), run.times.length - 1)]);
  }

  /** Goes to the nearest of these times beyond the present one. */
  goBeyond(times, direction) {
    const nearly = 1e-9 * (this.clock.end - this.clock.begin);
    let nearest = null;
    for (const time of times) {
      const ahead = (time - this.clock.time) * direction;
      if (ahead > nearly && (nearest === null || ahead < (nearest - this.clock.time) * direction)) nearest = time;
    }
    if (nearest !== null) this.clock.set(nearest);
  }

  /** Keys of the page; whatever has the focus and uses a key itself keeps it. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const { target } = event;
    if (target.closest?.("input, select, textarea, .chart, .scroll, pre")) return;
    const pressing = event.key === " " && target.closest?.("button, summary, a");
    const many = event.shiftKey ? 20 : 1;
    const actions = {
      " ": () => this.clock.toggle(),
      ArrowLeft: () => this.step(-1, many),
      ArrowRight: () => this.step(1, many),
      n: () => this.jump(1),
      p: () => this.jump(-1),
      Home: () => this.clock.set(this.clock.begin),
      End: () => this.clock.set(this.clock.end),
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action || pressing) return;
    event.preventDefault();
    action();
  }

  follow({ playing }) {
    const { begin, end, time } = this.clock;
    const notch = end > begin ? Math.round(((time - begin) / (end - begin)) * NOTCHES) : 0;
    if (Number(this.slider.value) !== notch) this.slider.value = notch;
    this.slider.setAttribute("aria-valuetext", `${milliseconds(time)} ms`);
    if (document.activeElement !== find("time")) find("time").value = (time * 1e3).toFixed(4);
    const play = find("play");
    play.textContent = playing ? "❚❚ Pause" : "▶ Play";
    play.setAttribute("aria-pressed", String(playing));
    const now = performance.now();
    if (playing && now - this.told < TABLE_INTERVAL) return;
    this.told = now;
    this.tellMoment(playing);
    if (!playing) this.writeLink();
  }

  /** The table of the moment: what each joint of the runs on the stage does. */
  tellMoment(playing) {
    const { time } = this.clock;
    find("moment").setAttribute("aria-live", playing ? "off" : "polite");
    const period = this.counted().map((run) => run.period).find(Boolean);
    const turns = time / period;
    const turn = period ? `turn ${Math.floor(turns) + 1}, ${significant(360 * (turns % 1), 4)}° into it` : "";
    find("turn").textContent = turn;
    const names = this.counted().map((run) => run.label).join(", ");
    find("moment-caption").textContent = `${names} at ${milliseconds(time)} ms${turn && ", "}${turn}`;
    const rows = this.counted().flatMap((run) => this.rowsOf(run, time));
    find("moment-rows").replaceChildren(...rows);
  }

  rowsOf(run, time) {
    if (run.times.length === 0) return [];
    run.seek(time);
    const several = this.counted().length > 1;
    const clearances = run.clearances.length > 0 || !several ? run.joints : [];
    const loose = (name) => run.clearancesOf(run.joints.indexOf(name)).length > 0;
    return clearances.filter((name) => !several || loose(name)).map((name) => {
      const clearance = run.clearances.indexOf(name);
      const joint = run.joints.indexOf(name);
      const [fx, fy] = run.forceAt(joint);
      const force = Math.hypot(fx, fy);
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      head.textContent = several ? `${run.label}, ${name}` : name;
      head.style.setProperty("--colour", seriesColour(this.colourOf(name)));
      const told = [this.modeOf(run, joint, time), this.offsetOf(run, name, clearance), inUnit(force, prefixed("N", force), 4)];
      const cells = told.map((text) => Object.assign(document.createElement("td"), { textContent: text }));
      row.append(head, ...cells);
      return row;
    });
  }

  modeOf(run, joint, time) {
    const [clearance, ...others] = run.clearancesOf(joint);
    if (clearance === undefined) return "ideal";
    if (others.length > 0) {
      const touching = [clearance, ...others].filter((one) => run.contactAt(one, time));
      const names = touching.map((one) => run.clearances[one]);
      return names.length > 0 ? `contact ${names.join(", ")}` : "flight";
    }
    const contact = run.contactAt(clearance, time);
    if (!contact) return "flight";
    return `contact ${run.contactsOf(clearance).indexOf(contact) + 1} of ${run.contactsOf(clearance).length}`;
  }

  offsetOf(run, name, clearance) {
    if (clearance < 0) return "–";
    const eccentricity = Math.hypot(...run.offsetAt(name));
    const radial = run.radial(clearance);
    return radial === null ? `${significant(eccentricity * 1e3, 5)} mm` : `${significant(eccentricity / radial, 5)} c`;
  }

  /**
   * `#t=12.53&run=four-bar-a&from=10&to=20&over=angle`: a time (ms), which run is on the stage, the
   * stretch (ms) that the charts are zoomed to, and what they are drawn over.
   */
  readLink() {
    const link = new URLSearchParams(location.hash.slice(1));
    const run = this.runs.find(({ label }) => label === link.get("run"));
    if (run) this.choose?.(run);
    this.charts.readLink(link);
    const time = Number.parseFloat(link.get("t"));
    if (!Number.isFinite(time)) return;
    this.clock.pause();
    this.clock.set(time / 1e3);
  }

  writeLink() {
    const time = (this.clock.time * 1e3).toFixed(6).replace(/\.?0+$/, "");
    const [shown, ...more] = this.stage.shown;
    const run = this.runs.length > 1 && shown && !more.length ? `&run=${encodeURIComponent(shown.label)}` : "";
    const charts = Object.entries(this.charts.link()).map(([name, value]) => `&${name}=${value}`);
    this.address = `#t=${time}${run}${charts.join("")}`;
    find("link").href = this.address;
  }

  /** The link itself changes the address; this puts it on the clipboard, where that is allowed. */
  copyLink() {
    navigator.clipboard?.writeText(location.href.split("#")[0] + this.address).catch(() => {});
  }
}

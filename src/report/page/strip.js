// Contacts over the slider: a lane for each clearance of each run.
import { seriesColour, theme, onTheme } from "./theme.js";
import { prepare, label } from "./pen.js";

/** Length of what all of these begin with, up to a hyphen, an underscore or a point. */
function commonPrefix([first, ...rest]) {
  let length = 0;
  for (let k = 0; k < first?.length && rest.every((text) => text[k] === first[k]); k++) {
    if ("-_.".includes(first[k])) length = k + 1;
  }
  return length;
}

/** Room for the lanes' names, left of them (px). */
const GUTTER = 64;

export class Strip {
  /** `shownStretch()` tells the stretch (s) that the charts show. */
  constructor(canvas, runs, stage, clock, colourOf, shownStretch) {
    Object.assign(this, { canvas, runs, stage, clock, colourOf, shownStretch, picture: null });
    this.period = runs.map((run) => run.period).find(Boolean) ?? null;
    onTheme(() => this.redraw());
    new ResizeObserver(() => this.redraw()).observe(canvas);
    clock.watch(() => this.draw());
    canvas.addEventListener("pointerdown", (event) => this.drag(event));
    canvas.addEventListener("pointermove", (event) => event.buttons && this.drag(event));
    this.redraw();
  }

  /** Takes up the runs that the stage shows. */
  redraw() {
    const shown = this.stage.shown.length ? this.stage.shown : this.runs;
    this.lanes = shown.flatMap((run) =>
      run.clearances.map((name, clearance) => ({ run, name, contacts: run.contactsOf(clearance) })),
    );
    this.prefix = commonPrefix(shown.map(({ label }) => label));
    this.lane = this.lanes.length > 6 ? 10 : 13;
    this.canvas.style.height = `${Math.max(8, this.lanes.length * this.lane + 4)}px`;
    this.picture = null;
    this.draw();
  }

  drag(event) {
    if (event.type === "pointerdown") this.canvas.setPointerCapture(event.pointerId);
    this.clock.set(this.timeAt(event.offsetX));
  }

  x(time) {
    const { begin, end } = this.clock;
    return end > begin ? GUTTER + ((time - begin) / (end - begin)) * (this.canvas.clientWidth - GUTTER) : GUTTER;
  }

  timeAt(x) {
    const { begin, end } = this.clock;
    return begin + ((x - GUTTER) / (this.canvas.clientWidth - GUTTER)) * (end - begin);
  }

  draw() {
    const prepared = prepare(this.canvas);
    if (!prepared) return;
    const { pen, width, height } = prepared;
    this.picture ??= this.paintLanes(width, height);
    pen.drawImage(this.picture, 0, 0, width, height);
    const stretch = this.shownStretch();
    if (stretch) {
      pen.fillStyle = theme().text;
      pen.globalAlpha = 0.12;
      pen.fillRect(GUTTER, 0, this.x(stretch[0]) - GUTTER, height);
      pen.fillRect(this.x(stretch[1]), 0, width - this.x(stretch[1]), height);
      pen.globalAlpha = 1;
    }
    pen.fillStyle = theme().now;
    pen.fillRect(this.x(this.clock.time) - 1, 0, 2, height);
  }

  /** A lane's joint, and at the first lane of a run among several its name. */
  nameLane(pen, k, y) {
    const { run, name } = this.lanes[k];
    const size = Math.min(11, this.lane);
    pen.save();
    pen.beginPath();
    pen.rect(0, 0, GUTTER - 4, y + this.lane);
    pen.clip();
    label(pen, name, GUTTER - 6, y, { size, align: "right", colour: seriesColour(this.colourOf(name)), weight: "600" });
    const first = k === 0 || this.lanes[k - 1].run !== run;
    pen.beginPath();
    pen.rect(0, 0, GUTTER - 12 - pen.measureText(name).width, y + this.lane);
    pen.clip();
    if (first && this.stage.shown.length > 1) label(pen, run.label.slice(this.prefix), 0, y, { size: size - 1, colour: theme().muted });
    pen.restore();
  }

  /** The lanes, which do not change with time, on a canvas of their own. */
  paintLanes(width, height) {
    const picture = document.createElement("canvas");
    [picture.width, picture.height] = [this.canvas.width, this.canvas.height];
    const pen = picture.getContext("2d");
    pen.scale(picture.width / width, picture.height / height);
    const { begin, end } = this.clock;
    pen.fillStyle = theme().grid;
    if (this.period && (end - begin) / this.period < width / 8) {
      for (let turn = Math.ceil(begin / this.period); turn * this.period <= end; turn++) {
        pen.fillRect(this.x(turn * this.period), 0, 1, height);
      }
    }
    this.lanes.forEach(({ run, name, contacts }, k) => {
      if (run.horizon && run.horizon[0] < run.end) {
        pen.fillStyle = theme().muted;
        pen.globalAlpha = 0.22;
        pen.fillRect(this.x(run.horizon[0]), k * this.lane + 2, this.x(run.end) - this.x(run.horizon[0]), this.lane);
        pen.globalAlpha = 1;
      }
      const top = 2 + k * this.lane;
      pen.fillStyle = theme().faint;
      pen.fillRect(GUTTER, top + this.lane / 2 - 0.5, width - GUTTER, 1);
      this.nameLane(pen, k, top + this.lane / 2);
      pen.fillStyle = seriesColour(this.colourOf(name));
      const most = contacts.reduce((largest, { force }) => Math.max(largest, force || 0), 0);
      for (const contact of contacts) {
        const left = this.x(contact.begin);
        const size = most > 0 ? 0.35 + 0.65 * Math.sqrt(Math.max(0, contact.force || 0) / most) : 1;
        const tall = (this.lane - 2) * size;
        pen.fillRect(left, top + (this.lane - tall) / 2, Math.max(1.2, this.x(contact.end) - left), tall);
      }
    });
    return picture;
  }
}

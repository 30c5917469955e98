// Each journal centre in its clearance circle, true to scale.
import { prefixed, significant } from "./format.js";
import { theme, seriesColour, onTheme } from "./theme.js";
import { prepare, label, circle, fadingPath, arrowWithin } from "./pen.js";
import { tailOf } from "./mechanism.js";

const SMALLEST_DIAL = 116;

export class Dials {
  constructor(canvas, stage, clock, colourOf) {
    Object.assign(this, { canvas, stage, clock, colourOf });
    clock.watch(() => this.draw());
    onTheme(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** The dials to draw, one a clearance of each run on the stage. */
  dials() {
    return this.stage.shown.flatMap((run) =>
      run.clearances.map((name, clearance) => ({ run, name, clearance, radial: run.radial(clearance) })),
    );
  }

  draw() {
    const dials = this.dials().filter(({ radial }) => radial !== null);
    this.canvas.hidden = dials.length === 0;
    if (dials.length === 0) return;
    const width = this.canvas.clientWidth;
    const most = Math.max(1, Math.floor(width / SMALLEST_DIAL));
    const rows = Math.ceil(dials.length / most);
    const columns = Math.ceil(dials.length / rows);
    const side = Math.min(width / columns, 158);
    const under = this.stage.shown.length > 1 ? 32 : 18;
    this.canvas.style.height = `${rows * (side + under)}px`;
    const prepared = prepare(this.canvas);
    if (!prepared) return;
    const left = (prepared.width - columns * side) / 2;
    dials.forEach((dial, k) => {
      const x = left + (k % columns) * side + side / 2;
      const y = Math.floor(k / columns) * (side + under) + side / 2;
      this.drawDial(prepared.pen, dial, x, y, side / 2 - 12);
    });
  }

  drawDial(pen, { run, name, clearance, radial }, x, y, radius) {
    const colour = seriesColour(this.colourOf(name));
    const { time } = this.clock;
    const touching = run.contactAt(clearance, Math.min(time, run.end)) !== null;
    circle(pen, x, y, radius);
    pen.fillStyle = theme().panel;
    pen.fill();
    pen.strokeStyle = touching ? colour : theme().muted;
    pen.lineWidth = touching ? 3 : 1.5;
    pen.stroke();
    pen.strokeStyle = theme().grid;
    pen.lineWidth = 1;
    pen.beginPath();
    pen.moveTo(x - radius, y);
    pen.lineTo(x + radius, y);
    pen.moveTo(x, y - radius);
    pen.lineTo(x, y + radius);
    pen.stroke();
    const scale = radius / radial;
    const path = tailOf(run, name, time, this.stage.tail);
    fadingPath(pen, path.map(([a, b]) => [x + scale * a, y - scale * b]), colour, 1.6);
    const [a, b] = run.offsetAt(name);
    if (!Number.isFinite(a)) return;
    const [px, py] = [x + scale * a, y - scale * b];
    circle(pen, px, py, 4.5);
    pen.fillStyle = colour;
    pen.fill();
    pen.strokeStyle = theme().paper;
    pen.lineWidth = 1.2;
    pen.stroke();
    if (this.stage.largestForce > 0) {
      const [fx, fy] = run.forceAt(run.joints.indexOf(name));
      const length = (0.9 * radius * this.stage.forceFactor) / this.stage.largestForce;
      const box = { left: x - radius - 10, top: y - radius - 10, right: x + radius + 10, bottom: y + radius + 10 };
      arrowWithin(pen, box, [px, py], [fx * length, -fy * length], theme().text, 2);
    }
    const { unit, size } = prefixed("m", radial);
    const below = { size: 11, align: "center" };
    label(pen, `${name}: c = ${significant(radial / size, 3)} ${unit}`, x, y + radius + 12, below);
    if (this.stage.shown.length > 1) label(pen, run.label, x, y + radius + 26, { ...below, colour: theme().muted });
  }
}

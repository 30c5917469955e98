// The way of each journal in its clearance circle, over the stretch that the charts show.
import { prefixed, significant } from "./format.js";
import { theme, seriesColour, onTheme } from "./theme.js";
import { prepare, label, circle } from "./pen.js";

/** Sides of a circle's square (px). */
const SMALLEST = 165;
const LARGEST = 300;

export class Paths {
  /** `stretch()` tells the stretch (s) of a run that is drawn. */
  constructor(place, runs, clock, colourOf, stretch) {
    Object.assign(this, { clock, colourOf, stretch, picture: null });
    this.paths = runs.flatMap((run) =>
      run.clearances.map((name, clearance) => ({ run, name, radial: run.radial(clearance) })),
    );
    this.paths = this.paths.filter(({ run, name, radial }) => radial !== null && run.column("clearance_x", name));
    if (this.paths.length === 0) return;
    this.several = new Set(this.paths.map(({ run }) => run)).size > 1;
    this.element = Object.assign(document.createElement("details"), { id: "chart-paths", className: "card", open: true });
    const summary = Object.assign(document.createElement("summary"), { textContent: "Paths of the journals" });
    this.canvas = document.createElement("canvas");
    this.canvas.id = "paths";
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The way of each journal centre in its clearance circle over the stretch that the charts show");
    this.note = Object.assign(document.createElement("p"), { className: "note" });
    this.element.append(summary, this.canvas, this.note);
    place.append(this.element);
    this.element.addEventListener("toggle", () => this.draw());
    clock.watch(() => this.draw());
    onTheme(() => this.redraw());
    new ResizeObserver(() => this.redraw()).observe(this.canvas);
  }

  /** Takes up another stretch. */
  redraw() {
    this.picture = null;
    this.draw();
  }

  draw() {
    if (!this.element?.open) return;
    const width = this.canvas.clientWidth;
    const columns = Math.min(this.paths.length, Math.max(1, Math.floor(width / SMALLEST)));
    const side = Math.min(width / columns, LARGEST);
    const under = this.several ? 34 : 20;
    this.canvas.style.height = `${Math.ceil(this.paths.length / columns) * (side + under)}px`;
    const prepared = prepare(this.canvas);
    if (!prepared) return;
    const { pen, height } = prepared;
    const left = (width - columns * side) / 2;
    this.places = this.paths.map((path, k) => {
      const far = 1.04 * this.reach(path);
      const [x, y] = [left + (k % columns) * side + side / 2, Math.floor(k / columns) * (side + under) + side / 2];
      return { x, y, scale: (side / 2 - 8) / far, bottom: y + side / 2 };
    });
    this.picture ??= this.paint(width, height);
    pen.drawImage(this.picture, 0, 0, width, height);
    this.paths.forEach((path, k) => this.drawJournal(pen, path, this.places[k]));
  }

  /** How far a journal comes from the middle (m) in the whole run. */
  reach(path) {
    if (path.far) return path.far;
    const { run, name, radial } = path;
    const [x, y] = [run.column("clearance_x", name), run.column("clearance_y", name)];
    path.far = radial;
    for (let row = 0; row < x.length; row++) {
      const far = Math.hypot(x[row], y[row]);
      if (far > path.far) path.far = far;
    }
    return path.far;
  }

  paint(width, height) {
    const picture = document.createElement("canvas");
    [picture.width, picture.height] = [this.canvas.width, this.canvas.height];
    const pen = picture.getContext("2d");
    pen.scale(picture.width / width, picture.height / height);
    pen.lineJoin = "round";
    let grey = false;
    this.paths.forEach((path, k) => (grey = this.paintPath(pen, path, this.places[k]) || grey));
    const zoomed = this.paths.some(({ run }) => this.stretch(run)[0] > run.begin || this.stretch(run)[1] < run.end);
    const stretch = zoomed ? "In the stretch that the charts show" : "Of the whole run; zoom the charts for a part of it";
    this.note.textContent = `${stretch}. The dashed circle is the radial clearance c${grey ? "; grey is beyond the horizon" : ""}.`;
    return picture;
  }

  /** Whether some of it is grey. */
  paintPath(pen, { run, name, radial }, { x, y, scale, bottom }) {
    const colour = seriesColour(this.colourOf(name));
    const [from, to] = this.stretch(run);
    const horizon = run.horizon && run.horizon[0] < run.end ? run.horizon[0] : Infinity;
    circle(pen, x, y, radial * scale);
    pen.fillStyle = theme().panel;
    pen.fill();
    pen.lineWidth = 0.8;
    const grey = to > horizon;
    if (grey) this.line(pen, run, name, [Math.max(from, horizon), to], { x, y, scale }, theme().muted, 0.55);
    this.line(pen, run, name, [from, Math.min(to, horizon)], { x, y, scale }, colour, 1);
    pen.setLineDash([5, 4]);
    pen.strokeStyle = theme().text;
    circle(pen, x, y, radial * scale);
    pen.lineWidth = 1;
    pen.stroke();
    pen.setLineDash([]);
    const { unit, size } = prefixed("m", radial);
    const below = { size: 12, align: "center" };
    label(pen, `${name}: c = ${significant(radial / size, 3)} ${unit}`, x, bottom + 6, below);
    if (this.several) label(pen, run.label, x, bottom + 21, { ...below, size: 11, colour: theme().muted });
    return grey;
  }

  line(pen, run, name, [from, to], { x, y, scale }, colour, alpha) {
    if (!(from < to)) return;
    const [a, b] = [run.column("clearance_x", name), run.column("clearance_y", name)];
    const point = ([dx, dy]) => [x + scale * dx, y - scale * dy];
    pen.beginPath();
    run.seek(from);
    pen.moveTo(...point(run.offsetAt(name)));
    const first = run.row + 1;
    run.seek(to);
    for (let row = first; row <= run.row; row++) pen.lineTo(...point([a[row], b[row]]));
    pen.lineTo(...point(run.offsetAt(name)));
    pen.strokeStyle = colour;
    pen.globalAlpha = alpha;
    pen.stroke();
    pen.globalAlpha = 1;
  }

  drawJournal(pen, { run, name }, { x, y, scale }) {
    run.seek(this.clock.time);
    const [a, b] = run.offsetAt(name);
    if (!Number.isFinite(a)) return;
    circle(pen, x + scale * a, y - scale * b, 4.5);
    pen.fillStyle = theme().now;
    pen.fill();
    pen.strokeStyle = theme().paper;
    pen.lineWidth = 1.5;
    pen.stroke();
  }
}

// Charts over time or crank angle: a card a quantity, in it a panel a run; zoom and time cursor are
// shared.
import { fixed, inUnit, milliseconds, prefixed } from "./format.js";
import { theme, seriesColour, onTheme } from "./theme.js";
import { QUANTITIES } from "./quantities.js";
import { axesOf, axisNumbers, splits } from "./axes.js";

const PANEL_HEIGHT = 150;
const LONE_PANEL_HEIGHT = 210;

/** Smallest range of an axis, as a share of the largest value on it. */
const FLATTEST = 1e-3;

/** Shortest stretch that can be zoomed to, as a share of the whole. */
const SHORTEST = 1e-6;

/** A run's curves in one chart. */
class Panel {
  constructor(card, run) {
    Object.assign(this, { card, run, plot: null, hovered: null });
    this.element = element("div", "panel");
    this.head = element("div", "panel-head");
    this.element.append(this.head);
    this.place = element("div", "chart");
    this.place.tabIndex = 0;
    this.place.setAttribute("role", "application");
    this.place.setAttribute("aria-label", `${card.quantity.title} in ${run.label}`);
    this.place.addEventListener("keydown", (event) => this.key(event));
    this.element.append(this.place);
    this.line = element("div", "now");
  }

  /** Draws the panel anew with the items chosen on its card. */
  build(width, height) {
    this.plot?.destroy();
    const { card, run } = this;
    const { quantity, charts } = card;
    this.curves = this.chosenCurves();
    const data = [charts.axis.rows(run), ...this.curves.map(({ values }) => values)];
    const series = this.curves.map(({ colour, dashed }) => ({
      stroke: () => (dashed ? theme().ghost : colour()),
      width: dashed ? 1.2 : 1.5,
      dash: dashed ? [6, 4] : undefined,
      points: { show: run.times.length === 1 },
    }));
    this.plot = new uPlot(
      {
        width,
        height,
        padding: [6, 18, 0, 0],
        legend: { show: false },
        cursor: {
          y: false,
          drag: { x: true, y: false, dist: 4, setScale: false },
          points: { size: 7, fill: (plot, k) => series[k - 1].stroke() },
          sync: { key: "time", setSeries: false, scales: ["x", null], filters: { pub: moves, sub: moves } },
        },
        scales: {
          x: { time: false, range: (plot, low, high) => (low < high ? [low, high] : [low - 0.5, high + 0.5]) },
          y: { range: (plot) => card.range(plot.scales.x, this) },
        },
        axes: this.axes(),
        series: [{}, ...series],
        hooks: {
          setCursor: [(plot) => this.hover(plot)],
          setSelect: [(plot) => this.select(plot)],
          draw: [() => this.placeNow()],
          drawClear: [(plot) => this.drawBeyond(plot, quantity)],
          drawAxes: [(plot) => this.drawMarks(plot, quantity)],
        },
      },
      data,
      this.place,
    );
    this.plot.over.append(this.line);
    this.plot.over.addEventListener("pointerdown", (event) => (this.pressed = event.clientX));
    this.plot.over.addEventListener("click", (event) => this.click(event));
    this.plot.over.addEventListener("dblclick", () => charts.zoom(null));
    const items = this.curves.filter(({ dashed }) => !dashed).map(({ item }) => item);
    this.place.setAttribute("aria-label", `${quantity.title} of ${items.join(", ")} in ${run.label} over ${charts.axis.id === "angle" ? "the crank angle" : "time"}. Left and right arrow keys go from point to point, plus and minus zoom, 0 shows the whole run.`);
    this.buildHead();
    this.show(charts.stretch);
    this.tell();
  }

  /** Curves of the chosen items, and below them those of the run without clearances. */
  chosenCurves() {
    const { card, run } = this;
    const { quantity } = card;
    const curves = [];
    for (const item of card.chosen) {
      const colour = () => card.colour(item);
      const values = quantity.items(run).includes(item) ? quantity.values(run, item) : null;
      if (values) curves.push({ item, values, colour, dashed: false });
    }
    const ideal = quantity.alone ? null : run.reference;
    for (const { item } of ideal ? [...curves] : []) {
      if (!quantity.items(ideal).includes(item)) continue;
      const values = onRows(quantity.values(ideal, item), ideal.times, run.times);
      if (values) curves.unshift({ item, values, colour: () => theme().ghost, dashed: true });
    }
    return curves;
  }

  axes() {
    const stroke = () => theme().muted;
    const grid = { stroke: () => theme().grid, width: 1 };
    const ticks = { stroke: () => theme().grid, width: 1, size: 4 };
    const font = "11px system-ui, sans-serif";
    const last = this.card.panels.at(-1) === this;
    const numbers = (plot, values) => axisNumbers(values);
    const { axis } = this.card.charts;
    const scaled = (plot, values) => axisNumbers(values.map((value) => value / this.card.size));
    return [
      { stroke, grid, ticks, font, size: 22, gap: 3, space: 60, incrs: axis.steps, values: numbers, label: last ? axis.title : undefined, labelSize: 15, labelFont: font, labelGap: 0 },
      { stroke, grid, ticks, font, size: 56, gap: 4, space: 26, splits: (plot, k, low, high) => splits(low / this.card.size, high / this.card.size).map((value) => value * this.card.size), values: scaled },
    ];
  }

  /** Names and values of the curves, above the chart. */
  buildHead() {
    const several = this.card.panels.length > 1 || this.card.charts.runs.length > 1;
    this.head.replaceChildren();
    if (several) this.head.append(element("span", "run-name", this.run.label));
    for (const curve of this.curves) {
      const key = element("span", curve.dashed ? "key dashed" : "key");
      key.style.setProperty("--colour", curve.colour());
      const name = curve.dashed ? `${curve.item}, ${this.run.reference.label}` : curve.item;
      curve.output = element("output", "value");
      key.append(element("i", "swatch"), element("span", "", name), curve.output);
      this.head.append(key);
    }
    const end = horizonOf(this.run, this.card.quantity);
    if (end === null) delete this.place.dataset.beyond;
    else {
      this.place.dataset.beyond = end * 1e3;
      this.head.append(element("span", "muted", `grey: beyond the horizon at ${milliseconds(end)} ms, one draw from a distribution`));
    }
    if (this.curves.length === 0) this.head.append(element("span", "muted", "nothing of this in this run"));
  }

  /** Tells the values under the pointer, or else at the time of the page. */
  tell() {
    const { card, run } = this;
    const time = card.charts.clock.time;
    for (const curve of this.curves) {
      const value = this.hovered === null ? onLine(curve.values, run, time) : curve.values[this.hovered];
      curve.output.textContent = inUnit(value, card, 6);
    }
  }

  hover(plot) {
    const index = plot.cursor.left >= 0 ? plot.cursor.idx ?? null : null;
    if (index === this.hovered) return;
    this.hovered = index;
    this.tell();
    if (plot.cursor.event) this.card.charts.tellPointer(index === null ? null : this.run.times[index]);
  }

  select(plot) {
    const { left, width } = plot.select;
    if (width < 4) return;
    const [from, to] = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
    plot.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
    this.card.charts.zoom([from, to]);
  }

  click(event) {
    if (Math.abs(event.clientX - this.pressed) > 3) return;
    const { left } = this.plot.over.getBoundingClientRect();
    const { axis, clock } = this.card.charts;
    clock.pause();
    clock.set(axis.timeAt(this.run, this.plot.posToVal(event.clientX - left, "x")));
  }

  /** Keys of a chart that has the focus. */
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { charts } = this.card;
    const actions = {
      ArrowLeft: () => this.stepRow(event.shiftKey ? -20 : -1),
      ArrowRight: () => this.stepRow(event.shiftKey ? 20 : 1),
      "+": () => charts.zoomBy(0.5),
      "=": () => charts.zoomBy(0.5),
      "-": () => charts.zoomBy(2),
      0: () => charts.zoom(null),
      Escape: () => charts.zoom(null),
    };
    if (!actions[event.key]) return;
    event.preventDefault();
    event.stopPropagation();
    actions[event.key]();
  }

  stepRow(count) {
    const { clock } = this.card.charts;
    const { times } = this.run;
    clock.pause();
    const row = this.run.rowAt(clock.time);
    const from = count < 0 && times[row] < clock.time ? row + 1 : row;
    clock.set(times[Math.min(Math.max(from + count, 0), times.length - 1)]);
  }

  /** Shows a stretch of the axis; the whole, where there is none. */
  show(stretch) {
    const [min, max] = stretch ?? this.card.charts.whole;
    this.plot.setScale("x", { min, max });
    [this.place.dataset.from, this.place.dataset.to] = [min, max];
  }

  /** Puts the time cursor where the time is. */
  placeNow() {
    const { axis, clock } = this.card.charts;
    const x = this.plot.valToPos(axis.at(this.run, clock.time), "x");
    const inside = x >= -0.5 && x <= this.plot.over.clientWidth + 0.5;
    this.line.hidden = !inside;
    if (inside) this.line.style.transform = `translateX(${x}px)`;
  }

  /** Grey ground behind the horizon of the run, where its numbers mean nothing any more. */
  drawBeyond(plot, quantity) {
    const { ctx, bbox } = plot;
    const end = horizonOf(this.run, quantity);
    if (end === null) return;
    const from = Math.min(Math.max(plot.valToPos(this.card.charts.axis.at(this.run, end), "x", true), bbox.left), bbox.left + bbox.width);
    ctx.save();
    ctx.fillStyle = theme().muted;
    ctx.globalAlpha = 0.22;
    ctx.fillRect(from, bbox.top, bbox.left + bbox.width - from, bbox.height);
    ctx.restore();
  }

  /** Horizontal marks, as the clearance of a journal. */
  drawMarks(plot, quantity) {
    if (!quantity.mark) return;
    const { ctx, bbox } = plot;
    ctx.save();
    ctx.strokeStyle = theme().muted;
    ctx.lineWidth = devicePixelRatio;
    ctx.setLineDash([2 * devicePixelRatio, 3 * devicePixelRatio]);
    for (const { item } of this.curves) {
      const height = quantity.mark(this.run, item);
      if (height === null) continue;
      const y = plot.valToPos(height, "y", true);
      ctx.beginPath();
      ctx.moveTo(bbox.left, y);
      ctx.lineTo(bbox.left + bbox.width, y);
      ctx.stroke();
    }
    ctx.restore();
  }
}

/** A quantity: its items to choose from, and a panel for each run that has some. */
class Card {
  constructor(charts, quantity, runs) {
    Object.assign(this, { charts, quantity, runs });
    this.items = [...new Set(runs.flatMap((run) => quantity.items(run)))];
    this.chosen = this.firstChoice();
    this.element = element("details", "card");
    this.element.id = `chart-${quantity.id}`;
    this.element.open = quantity.open;
    this.title = element("summary", "", quantity.title);
    this.body = element("div", "card-body");
    this.element.append(this.title, this.body);
    this.choice = this.buildChoice();
    this.panels = runs.map((run) => new Panel(this, run));
    const note = this.noteText();
    this.body.append(this.choice, ...this.panels.map((panel) => panel.element));
    if (note) this.body.append(element("p", "note", note));
    this.element.addEventListener("toggle", () => this.build());
    new ResizeObserver(() => this.resize()).observe(this.body);
  }

  noteText() {
    const { note, sampled } = this.quantity;
    if (this.runs.every((run) => run.contacts.length === 0)) return "";
    return note ?? (sampled ? "Drawn through the samples of the file; what happens between them is not seen here." : "");
  }

  /** The joints with clearance; a single curve, where several runs are compared. */
  firstChoice() {
    const { joints, first } = this.quantity;
    if (first) return new Set(this.items.filter((item) => first.includes(item)));
    const loose = this.items.filter((item) => this.runs.some((run) => run.clearances.includes(item)));
    const choice = joints && loose.length ? loose : this.items;
    return new Set(this.runs.length > 1 ? choice.slice(0, 1) : choice);
  }

  buildChoice() {
    const choice = element("fieldset", "choice");
    choice.append(element("legend", "hidden", `Curves of ${this.quantity.title}`));
    for (const item of this.items) {
      const box = Object.assign(document.createElement("input"), { type: "checkbox", checked: this.chosen.has(item) });
      box.addEventListener("change", () => {
        if (box.checked) this.chosen.add(item);
        else this.chosen.delete(item);
        this.chosen = new Set(this.items.filter((known) => this.chosen.has(known)));
        this.build();
      });
      const label = element("label", "chip");
      label.style.setProperty("--colour", this.colour(item));
      label.append(box, element("i", "swatch"), document.createTextNode(item));
      choice.append(label);
    }
    choice.hidden = this.items.length < 2;
    return choice;
  }

  colour(item) {
    const number = this.quantity.joints ? this.charts.colourOf(item) : this.items.indexOf(item);
    return seriesColour(number);
  }

  build() {
    if (!this.element.open || this.body.clientWidth === 0) return;
    for (const panel of this.panels) panel.curves = panel.chosenCurves();
    this.ranges = null;
    const largest = Math.max(...this.charts.whole.map(() => 0), this.largest());
    Object.assign(this, prefixed(this.quantity.unit, largest));
    this.title.textContent = `${this.quantity.title} (${this.unit})`;
    this.choice.querySelectorAll("label").forEach((label, k) => label.style.setProperty("--colour", this.colour(this.items[k])));
    for (const panel of this.panels) panel.build(this.body.clientWidth, this.heightOf(panel));
  }

  heightOf(panel) {
    const last = this.panels.at(-1) === panel;
    return (this.panels.length === 1 ? LONE_PANEL_HEIGHT : PANEL_HEIGHT) + (last ? 15 : 0);
  }

  largest() {
    const [low, high] = this.extremes(this.panels, -Infinity, Infinity);
    return Math.max(Math.abs(low), Math.abs(high), 0);
  }

  /** Smallest and largest value of all curves of these panels in a stretch of the axis. */
  extremes(panels, from, to) {
    let [low, high] = [Infinity, -Infinity];
    for (const { run, curves } of panels) {
      if (run.times.length === 0) continue;
      const { axis } = this.charts;
      const [begin, end] = [from, to].map((place) => (Number.isFinite(place) ? axis.timeAt(run, place) : place));
      const [first, last] = [run.rowAt(begin), Math.min(run.rowAt(end) + 1, run.times.length - 1)];
      for (const { values } of curves) {
        for (let row = first; row <= last; row++) {
          const value = values[row];
          if (value < low) low = value;
          if (value > high) high = value;
        }
      }
      for (const { item } of curves) {
        const mark = this.quantity.mark?.(run, item) ?? high;
        [low, high] = [Math.min(low, mark), Math.max(high, mark)];
      }
    }
    return low <= high ? [low, high] : [0, 0];
  }

  /** Range of the vertical axis in the stretch shown. */
  range({ min, max }, panel) {
    const panels = this.charts.sameScale ? this.panels : [panel];
    let [low, high] = this.extremes(panels.filter(({ curves }) => curves), min ?? -Infinity, max ?? Infinity);
    const { floor } = this.quantity;
    // A column is rounded to a millionth of its largest value: that must not look like noise.
    const least = FLATTEST * Math.max(Math.abs(low), Math.abs(high)) || this.size || 1;
    if (high - low < least) [low, high] = [(low + high - least) / 2, (low + high + least) / 2];
    const rim = 0.06 * (high - low);
    if (floor !== undefined && low >= floor && low - floor < 0.5 * (high - floor)) return [floor, high + rim];
    return [low - rim, high + rim];
  }

  resize() {
    if (!this.element.open) return;
    const width = this.body.clientWidth;
    if (width === 0 || width === this.width) return;
    this.width = width;
    if (!this.panels[0].plot) return this.build();
    for (const panel of this.panels) {
      panel.plot.setSize({ width, height: this.heightOf(panel) });
      panel.placeNow();
    }
  }
}

export class Charts {
  constructor(place, runs, clock, colourOf) {
    Object.assign(this, { runs, clock, colourOf, stretch: null, sameScale: true, changes: [] });
    const sampled = runs.filter((run) => run.times.length > 0);
    // A run that others have for their ideal is drawn in theirs.
    const ideals = new Set(sampled.map((run) => run.reference).filter(Boolean));
    const own = sampled.filter((run) => !ideals.has(run));
    this.own = own;
    this.axes = axesOf(own);
    this.useAxis(this.axes[0]);
    this.cards = [];
    for (const quantity of QUANTITIES) {
      const having = own.filter((run) => quantity.items(run).length > 0);
      if (having.length) this.cards.push(new Card(this, quantity, having));
    }
    place.append(...this.cards.map((card) => card.element));
    for (const card of this.cards) card.build();
    onTheme(() => this.rebuild());
    this.setUpAxes();
    clock.watch((tick) => this.follow(tick));
    this.setUpButtons();
    this.tellStretch();
  }

  setUpButtons() {
    const press = (id, action) => document.getElementById(id).addEventListener("click", action);
    press("zoom-in", () => this.zoomBy(0.5));
    press("zoom-out", () => this.zoomBy(2));
    press("zoom-all", () => this.zoom(null));
    const box = document.getElementById("same-scale");
    box.closest("label").hidden = this.cards.every((card) => card.panels.length < 2);
    box.addEventListener("change", () => {
      this.sameScale = box.checked;
      this.zoom(this.stretch);
    });
  }

  /** Panels that are drawn. */
  panels() {
    return this.cards.flatMap((card) => (card.element.open ? card.panels : [])).filter((panel) => panel.plot);
  }

  setUpAxes() {
    const select = document.getElementById("over");
    const names = { time: "time", angle: "crank angle" };
    for (const { id } of this.axes) select.add(new Option(names[id], id));
    select.closest("label").hidden = this.axes.length < 2;
    select.addEventListener("change", () => this.draw(select.value, this.times()));
  }

  useAxis(axis) {
    this.axis = axis;
    const { begin, end } = this.clock;
    const ends = [axis.at(this.own[0], begin), axis.at(this.own[0], end), ...this.own.flatMap((run) => [axis.at(run, run.begin), axis.at(run, run.end)])];
    this.whole = [Math.min(...ends), Math.max(...ends)];
  }

  /** Draws everything over an axis, by its name, and of it a stretch of time (s), or the whole. */
  draw(name, stretch) {
    this.useAxis(this.axes.find(({ id }) => id === name) ?? this.axes[0]);
    document.getElementById("over").value = this.axis.id;
    this.stretch = stretch && this.within(stretch.map((time) => this.axis.at(this.own[0], time)));
    this.rebuild();
    this.zoom(this.stretch);
  }

  /** The stretch zoomed to as times (s) of a run; nothing where the whole is shown. */
  times(run = this.own[0]) {
    return this.stretch && this.stretch.map((place) => this.axis.timeAt(run, place));
  }

  /** What is shown of a run (s). */
  stretchOf(run) {
    const { begin, end } = run ?? this.clock;
    const within = (time) => Math.min(Math.max(time, begin), end);
    return this.times(run)?.map(within) ?? [begin, end];
  }

  /** What a link says of the charts: their axis, and the stretch (ms) they are zoomed to. */
  link() {
    const over = this.axis.id === "time" ? {} : { over: this.axis.id };
    if (!this.stretch) return over;
    const [from, to] = this.times().map((time) => Number((time * 1e3).toFixed(6)));
    return { from, to, ...over };
  }

  /** Follows a link, as far as it speaks of the charts. */
  readLink(link) {
    const [from, to] = ["from", "to"].map((name) => Number.parseFloat(link.get(name)) / 1e3);
    const zoomed = from < to;
    if (!zoomed && !link.has("over")) return;
    if (this.own.length) this.draw(link.get("over"), zoomed ? [from, to] : null);
  }

  /** Shows a stretch of the axis in all charts, or the whole. */
  zoom(stretch) {
    this.stretch = stretch && this.within(stretch);
    for (const panel of this.panels()) panel.show(this.stretch);
    this.tellStretch();
    for (const change of this.changes) change();
  }

  within([from, to]) {
    const [begin, end] = this.whole;
    const length = Math.max(to - from, SHORTEST * (end - begin));
    if (length >= end - begin) return null;
    const first = Math.min(Math.max(from, begin), end - length);
    return [first, first + length];
  }

  /** Zooms about the time of the page. */
  zoomBy(factor) {
    const [from, to] = this.stretch ?? this.whole;
    const now = this.axis.at(this.own[0], this.clock.time);
    const about = now >= from && now <= to ? now : (from + to) / 2;
    this.zoom([about - (about - from) * factor, about + (to - about) * factor]);
  }

  follow({ time, playing }) {
    if (this.stretch) {
      const [from, to] = this.stretch;
      const now = this.axis.at(this.own[0], time);
      if (now < from || now > to) this.zoom([now - 0.1 * (to - from), now + 0.9 * (to - from)]);
    }
    const due = performance.now() - (this.told ?? 0) > 100;
    if (due || !playing) this.told = performance.now();
    for (const panel of this.panels()) {
      panel.placeNow();
      if (due || !playing) panel.tell();
    }
  }

  tellPointer(time) {
    document.getElementById("pointer").textContent = time === null ? "" : `values at ${milliseconds(time)} ms, under the pointer`;
  }

  tellStretch() {
    const [from, to] = this.stretch ?? this.whole;
    const decimals = Math.min(6, Math.max(1, 3 - Math.floor(Math.log10(to - from || 1))));
    document.getElementById("stretch").textContent = `${fixed(from, decimals)} to ${fixed(to, decimals)} ${this.axis.unit}`;
  }

  rebuild() {
    for (const card of this.cards) card.build();
  }
}

/** Time (s) behind which a quantity of a run means nothing; null where all of it does. */
function horizonOf(run, quantity) {
  if (!run.horizon) return null;
  const end = run.horizon[quantity.state ? 0 : 1];
  return end < run.end ? end : null;
}

/** A value at a time on the straight lines between rows. */
function onLine(values, run, time) {
  if (time > run.end) return NaN;
  run.seek(time);
  return run.at(values);
}

/** A curve of another run at the rows of this one, on straight lines; nothing beyond its end. */
function onRows(values, times, rows) {
  if (!values || times.length === 0) return null;
  let next = 1;
  return rows.map((time) => {
    if (time > times[times.length - 1]) return NaN;
    while (next < times.length - 1 && times[next] < time) next++;
    if (times.length === 1) return values[0];
    const share = (time - times[next - 1]) / (times[next] - times[next - 1]);
    return values[next - 1] + share * (values[next] - values[next - 1]);
  });
}

function moves(type) {
  return type === "mousemove" || type === "mouseleave";
}

function element(tag, className, text) {
  return Object.assign(document.createElement(tag), { className, textContent: text ?? "" });
}

// The stage: one run's mechanism, or those of all runs beside one another.
import { roundDown, significant, prefixed } from "./format.js";
import { theme, onTheme } from "./theme.js";
import { arrow, prepare, label, scaleBar } from "./pen.js";
import { extent, jointPlace, circles, drawMechanism, drawGhost } from "./mechanism.js";

/** How long the force of an impact between two frames stays to be seen (ms). */
const HOLD = 350;

/** Share of the stage's smaller side that the largest force of all runs takes. */
const LARGEST_ARROW = 0.4;

export class Stage {
  constructor(canvas, runs, clock, colourOf) {
    Object.assign(this, { canvas, runs, clock, colourOf });
    this.drawable = runs.filter((run) => run.drawing && run.times.length > 0);
    this.extents = new Map(this.drawable.map((run) => [run, extent(run)]));
    this.shown = this.drawable.slice(0, 1);
    this.follow = null;
    this.ghost = true;
    this.forces = true;
    this.forceFactor = 1;
    this.held = [];
    this.tail = tailDuration(runs);
    this.largestForce = largestForce(this.drawable);
    this.factor = this.fittingFactor();
    clock.watch((tick) => {
      this.hold(tick);
      this.draw();
    });
    onTheme(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(canvas);
  }

  /** Shows these runs. */
  show(runs) {
    this.shown = runs.filter((run) => this.drawable.includes(run));
    this.draw();
  }

  /** Enlargement of the offsets that shows the largest clearance as half of its bearing. */
  fittingFactor() {
    const clearances = this.clearances();
    if (clearances.length === 0) return 1;
    const wanted = Math.min(...clearances.map((clearance) => (0.5 * clearance.bearing_radius) / clearance.radial));
    const box = union(this.drawable.map((run) => this.extents.get(run)));
    const size = box ? Math.max(box.right - box.left, box.top - box.bottom) : 0;
    const widest = Math.max(...clearances.map((clearance) => clearance.radial));
    const visible = (0.02 * size) / widest;
    return Math.max(1, roundDown(Math.max(wanted, visible)));
  }

  clearances() {
    const joints = this.drawable.flatMap((run) => run.drawing.joints);
    return joints.map((joint) => joint.clearance).filter(Boolean);
  }

  /** Remembers the impacts that a frame jumped over, so that none goes unseen. */
  hold({ time, before, moved }) {
    const now = performance.now();
    this.held = moved ? this.held.filter((held) => now - held.since < HOLD) : [];
    if (!moved) return;
    for (const run of this.shown) {
      for (const contact of run.contacts) {
        if (contact.peakTime <= before || contact.peakTime > time) continue;
        const joint = run.jointOf(contact.clearance);
        run.seek(contact.peakTime);
        const offset = run.offsetAt(run.joints[joint]);
        this.held.push({ run, joint, since: now, offset, force: run.forceAt(joint) });
      }
    }
  }

  draw() {
    const prepared = prepare(this.canvas);
    if (!prepared) return;
    const { pen, width, height } = prepared;
    if (this.shown.length === 0) {
      label(pen, "There is nothing to draw: no samples, or a case that this program does not read.", width / 2, height / 2, { align: "center", colour: theme().muted });
      return;
    }
    const cells = this.cells(width, height);
    this.shown.forEach((run, k) => this.drawCell(pen, run, cells[k]));
    const [run] = this.shown;
    const view = this.viewOf(run, cells[0]);
    this.drawScales(pen, { width, height }, view, this.lookOf(run, cells[0]));
  }

  /** Places for the runs shown, in as many columns as let them be largest. */
  cells(width, height) {
    const count = this.shown.length;
    const box = union(this.shown.map((run) => this.extents.get(run)));
    const shape = (box.right - box.left) / Math.max(box.top - box.bottom, 1e-9) || 1;
    const size = (columns) => Math.min(width / columns / shape, height / Math.ceil(count / columns));
    const choices = Array.from({ length: count }, (_, k) => k + 1);
    const columns = choices.reduce((best, columns) => (size(columns) > 1.001 * size(best) ? columns : best));
    const rows = Math.ceil(count / columns);
    const cell = { width: width / columns, height: (height - (count > 1 ? 24 : 0)) / rows };
    return this.shown.map((_, k) => ({ ...cell, left: (k % columns) * cell.width, top: Math.floor(k / columns) * cell.height }));
  }

  drawCell(pen, run, cell) {
    pen.save();
    pen.beginPath();
    pen.rect(cell.left, cell.top, cell.width, cell.height);
    pen.clip();
    const view = this.viewOf(run, cell);
    const { time } = this.clock;
    const look = this.lookOf(run, cell);
    // Scales stand at the bottom, and the name of the run at the top.
    const { left, right, top, bottom } = look.box;
    look.taken = [{ left, right, top: bottom - (this.shown.length > 1 ? 0 : 36), bottom }];
    if (this.shown.length > 1) look.taken.push({ left, right, top, bottom: top + 24 });
    if (this.ghost && run.reference?.drawing && run.reference.times.length > 0) {
      run.reference.seek(time);
      drawGhost(pen, run.reference, view);
    }
    run.seek(time);
    drawMechanism(pen, run, view, look);
    if (this.shown.length > 1 || time > run.end) {
      const over = time > run.end ? ", ended" : "";
      label(pen, run.label + over, cell.left + 10, cell.top + 14, { weight: "600" });
    }
    pen.restore();
  }

  lookOf(run, cell) {
    const now = performance.now();
    const smaller = Math.min(cell.width, cell.height);
    const drive = run.drives.length ? run.column("angular_velocity", drivenBody(run)) : null;
    return {
      factor: this.factor,
      forces: this.forces,
      forceScale: this.largestForce > 0 ? (this.forceFactor * LARGEST_ARROW * smaller) / this.largestForce : 0,
      box: { left: cell.left + 3, top: cell.top + 3, right: cell.left + cell.width - 3, bottom: cell.top + cell.height - 3 },
      held: this.held.map((held) => ({ ...held, alpha: Math.max(0, 1 - (now - held.since) / HOLD) })),
      colourOf: this.colourOf,
      names: cell.width > 200,
      symbol: Math.min(1, Math.max(0.5, smaller / 300)),
      barWidth: Math.max(5, Math.min(12, 0.02 * smaller)),
      wall: Math.max(3, Math.min(6, 0.01 * smaller)),
      backwards: drive !== null && drive[0] < 0,
      time: this.clock.time,
      tail: this.tail,
    };
  }

  /** Metres to pixels: the whole mechanism, or a joint and its surroundings. */
  viewOf(run, cell) {
    const joint = run.joints.indexOf(this.follow);
    if (joint >= 0) return this.closeView(run, joint, cell);
    const box = union(this.shown.map((shown) => this.extents.get(shown)));
    const rim = Math.min(64, 0.14 * Math.min(cell.width, cell.height) + 12);
    const [wide, high] = [cell.width - 2 * rim, cell.height - 2 * rim];
    const scale = Math.min(wide / Math.max(box.right - box.left, 1e-9), high / Math.max(box.top - box.bottom, 1e-9));
    const alone = box.right - box.left < 1e-9 && box.top - box.bottom < 1e-9;
    const centre = [(box.left + box.right) / 2, (box.bottom + box.top) / 2];
    const fitting = alone ? null : this.smallestScale(run, scale, cell);
    return viewAt(centre, fitting ?? this.scaleOfBearing(run, cell), cell);
  }

  /** A scale at which the bearings of a mechanism that is mostly bearing fit, too. */
  smallestScale(run, scale, cell) {
    const radii = run.drawing.joints.map(({ clearance }) => clearance?.bearing_radius ?? 0);
    const largest = Math.max(0, ...radii);
    return largest > 0 ? Math.min(scale, (0.27 * Math.min(cell.width, cell.height)) / largest) : scale;
  }

  scaleOfBearing(run, cell) {
    return this.smallestScale(run, Infinity, cell) === Infinity ? 1000 : this.smallestScale(run, Infinity, cell);
  }

  closeView(run, joint, cell) {
    run.seek(this.clock.time);
    const centre = jointPlace(run, joint, this.factor);
    const { clearance } = run.drawing.joints[joint];
    const box = this.extents.get(run);
    const size = Math.max(box.right - box.left, box.top - box.bottom, 1e-9);
    const smaller = Math.min(cell.width, cell.height);
    const radius = clearance ? Math.max(clearance.bearing_radius, this.factor * clearance.radial) : size / 12;
    return viewAt(centre, (0.28 * smaller) / radius, cell);
  }

  /** Bars for lengths and forces, and how far the drawing exaggerates. */
  drawScales(pen, { width, height }, view, look) {
    const y = height - 14;
    const length = roundDown(Math.min(80, 0.16 * width) / view.scale);
    const { unit, size } = prefixed("m", length);
    scaleBar(pen, 12, y, length * view.scale, `${significant(length / size, 1)} ${unit}`);
    const after = 12 + length * view.scale + 70;
    if (look.forces && look.forceScale > 0) {
      const force = roundDown(Math.min(80, 0.16 * width) / look.forceScale);
      const { unit: newton, size: of } = prefixed("N", force);
      scaleBar(pen, after, y, force * look.forceScale, `${significant(force / of, 1)} ${newton}`);
    }
    const gravity = this.shown[0].drawing.gravity;
    const strength = Math.hypot(...(gravity ?? [0, 0]));
    if (strength > 0) {
      const [x, y] = gravity.map((part) => part / strength);
      arrow(pen, width - 30 - 14 * x, 32 + 14 * y, 28 * x, -28 * y, theme().muted, 1.8);
      label(pen, "g", width - 18, 32, { colour: theme().muted });
    }
    if (this.clearances().length === 0) return;
    const times = `× ${significant(this.factor, this.factor < 10 ? 2 : 3)}`;
    const note = this.factor === 1 ? "offsets true to scale" : `offsets in bearings ${times}, exaggerated`;
    const look11 = { size: 11, colour: theme().muted };
    if (width < 480) label(pen, note, 12, y - 18, look11);
    else label(pen, note, width - 12, y, { ...look11, align: "right" });
  }
}

function viewAt([x, y], scale, cell) {
  const [middleX, middleY] = [cell.left + cell.width / 2, cell.top + cell.height / 2];
  return { scale, x: (metres) => middleX + scale * (metres - x), y: (metres) => middleY - scale * (metres - y) };
}

function union(boxes) {
  return boxes.filter(Boolean).reduce((all, box) => ({
    left: Math.min(all.left, box.left),
    right: Math.max(all.right, box.right),
    bottom: Math.min(all.bottom, box.bottom),
    top: Math.max(all.top, box.top),
  }));
}

/** The second body of the first driven joint. */
function drivenBody(run) {
  const joint = run.drawing.joints.find(({ driven }) => driven);
  return joint && joint.between[1].body !== null ? run.bodies[joint.between[1].body] : undefined;
}

/** Largest force of a contact; of any joint, where no run has contacts. */
function largestForce(runs) {
  const contacts = runs.flatMap((run) => run.contacts.map(({ force }) => force));
  const peaks = contacts.filter(Number.isFinite);
  if (peaks.length) return peaks.reduce((most, force) => Math.max(most, force), 0);
  let most = 0;
  for (const run of runs) {
    for (const name of run.joints) {
      for (const force of run.forceMagnitude(name) ?? []) if (force > most) most = force;
    }
  }
  return most;
}

/** How far back the journals' paths go (s): a quarter of a turn, or of a tenth of the run. */
function tailDuration(runs) {
  const period = runs.map((run) => run.period).find(Boolean);
  const longest = Math.max(...runs.map((run) => run.end - run.begin));
  return period ? period / 4 : longest / 20;
}

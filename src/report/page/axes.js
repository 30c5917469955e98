// What charts are drawn over: time, or the angle of the crank; and the numbers of axes.
import { fixed } from "./format.js";

/** Steps of ticks that angles are counted in (°). */
const DEGREES = [0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 15, 30, 45, 90, 180, 360, 720, 1800, 3600, 7200, 18000, 36000, 72000, 180000, 360000];

/** Time (ms). */
class TimeAxis {
  constructor() {
    Object.assign(this, { id: "time", unit: "ms", title: "time (ms)", kept: new Map() });
  }

  at(run, time) {
    return time * 1e3;
  }

  timeAt(run, place) {
    return place / 1e3;
  }

  /** Places of all rows of a run. */
  rows(run) {
    if (!this.kept.has(run)) this.kept.set(run, run.times.map((time) => this.at(run, time)));
    return this.kept.get(run);
  }
}

/** Angle of the only drive (°), counted in the sense in which it turns. */
class AngleAxis extends TimeAxis {
  constructor(backwards) {
    super();
    const title = backwards ? "crank angle, backwards (°)" : "crank angle (°)";
    Object.assign(this, { id: "angle", unit: "°", title, sense: backwards ? -1 : 1, steps: DEGREES });
  }

  at(run, time) {
    run.seek(time);
    return this.sense * degrees(run, (column) => run.at(column));
  }

  timeAt(run, angle) {
    const rows = this.rows(run);
    let [low, high] = [0, rows.length - 1];
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (rows[middle] <= angle) low = middle;
      else high = middle;
    }
    const share = rows[high] > rows[low] ? (angle - rows[low]) / (rows[high] - rows[low]) : 0;
    return run.times[low] + Math.min(Math.max(share, 0), 1) * (run.times[high] - run.times[low]);
  }
}

/** The axes that charts of these runs can have; that of the angle where all cranks turn one way. */
export function axesOf(runs) {
  const senses = new Set(runs.map(sense));
  const [turns] = senses;
  return [new TimeAxis(), ...(runs.length > 0 && senses.size === 1 && turns ? [new AngleAxis(turns < 0)] : [])];
}

/** 1 or −1 where the run's only drive never turns back, 0 otherwise. */
function sense(run) {
  if (run.drives.length !== 1 || !run.drawing || run.times.length < 2) return 0;
  const angles = run.times.map((_, row) => degrees(run, (column) => column[row]));
  const turned = Math.sign(angles[angles.length - 1] - angles[0]);
  const back = angles.some((angle, row) => row > 0 && turned * (angle - angles[row - 1]) < 0);
  return back ? 0 : turned;
}

/** Angle (°) of the drive's second body relative to its first. */
function degrees(run, value) {
  const { between } = run.drawing.joints.find(({ driven }) => driven);
  const [first, second] = between.map(({ body }) => (body === null ? 0 : value(run.column("angle", run.bodies[body]))));
  return ((second - first) * 180) / Math.PI;
}

/** Round numbers in a range, four or five of them. */
export function splits(low, high) {
  const rough = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map((lead) => lead * power).find((size) => size >= rough);
  const numbers = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) numbers.push(k * step);
  return numbers;
}

/** Numbers of an axis, all with the decimals that the finest of them needs. */
export function axisNumbers(values) {
  const step = values.length > 1 ? Math.abs(values[1] - values[0]) : Math.abs(values[0]) || 1;
  const decimals = Math.min(9, Math.max(0, -Math.floor(Math.log10(step * 1.0001))));
  const needs = Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6 ? decimals + 1 : decimals;
  return values.map((value) => fixed(value, needs));
}

// One run: its columns over time, with what the contact tables know put between the samples.
import { unpack } from "./unpack.js";

/** All runs of the page. */
export async function readRuns(element) {
  const runs = await Promise.all(JSON.parse(element.textContent).map(readRun));
  for (const run of runs) run.reference = run.reference === null ? null : runs[run.reference];
  return runs;
}

async function readRun(told) {
  const names = Object.keys(told.columns);
  const values = await Promise.all(names.map((name) => unpack(told.columns[name])));
  return new Run(told, new Map(names.map((name, k) => [name, values[k]])));
}

class Run {
  constructor(told, columns) {
    Object.assign(this, told);
    this.columns = columns;
    this.times = columns.get("time");
    this.begin = this.times.length ? this.times[0] : 0;
    this.end = this.times.length ? this.times[this.times.length - 1] : 0;
    this.contacts = this.readContacts();
    this.contactsBy = this.clearances.map((_, k) => this.contacts.filter((contact) => contact.clearance === k));
    this.addKnownMoments();
    this.row = 0;
    this.share = 0;
  }

  /** A column by its name in result files; nothing where the file has it not. */
  column(dataset, item) {
    return this.columns.get(item === undefined ? dataset : `${dataset}.${item}`) ?? null;
  }

  /** Contacts of all clearances, in the order of their peaks. */
  readContacts() {
    const of = (name) => this.columns.get(`contact_${name}`) ?? [];
    const [clearance, begin, end, peakTime] = [of("clearance"), of("begin"), of("end"), of("peak_time")];
    const [force, depth, rate] = [of("peak_force"), of("peak_penetration"), of("impact_rate")];
    const contacts = Array.from(begin, (_, k) => ({
      clearance: clearance[k],
      begin: begin[k],
      end: Number.isNaN(end[k]) ? this.end : end[k],
      open: Number.isNaN(end[k]),
      peakTime: Number.isNaN(peakTime[k]) ? begin[k] : peakTime[k],
      force: force[k],
      depth: depth[k],
      rate: rate[k],
    }));
    return contacts.sort((one, other) => one.peakTime - other.peakTime);
  }

  /** Contacts of one clearance, in the order of time. */
  contactsOf(clearance) {
    return this.contactsBy[clearance];
  }

  /** Radial clearance c (m) of a journal, where the case tells it. */
  radial(clearance) {
    const joint = this.drawing?.joints[this.joints.indexOf(this.clearances[clearance])];
    return joint?.clearance?.radial ?? null;
  }

  /** The same of any clearance, before a straight wall the play there (m). */
  play(clearance) {
    return this.radial(clearance) ?? this.drawing?.joints[this.jointOf(clearance)]?.walls?.gap ?? null;
  }

  /** The joint that a clearance is in, by index: corners and flanks have its name and a number. */
  jointOf(clearance) {
    const name = this.clearances[clearance];
    const joint = this.joints.indexOf(name);
    return joint < 0 ? this.joints.indexOf(name.replace(/_\d$/, "")) : joint;
  }

  /** The clearances of a joint, by index. */
  clearancesOf(joint) {
    return this.clearances.map((_, clearance) => clearance).filter((clearance) => this.jointOf(clearance) === joint);
  }

  /**
   * What is known between the samples: contacts begin and end at no depth, and peak as their table
   * says. The time of the greatest depth is not in the file; it is taken at the peak of the force.
   */
  knownMoments() {
    const moments = [];
    for (const contact of this.contacts) {
      const { clearance, begin, end, open, peakTime, force, depth } = contact;
      if (begin > this.begin) moments.push({ time: begin, clearance, force: 0, depth: 0 });
      moments.push({ time: peakTime, clearance, force, depth });
      if (!open) moments.push({ time: end, clearance, force: 0, depth: 0 });
    }
    const of = (name) => this.columns.get(`peak_${name}`) ?? [];
    const [clearance, time, force] = [of("clearance"), of("time"), of("force")];
    for (let k = 0; k < time.length; k++) moments.push({ time: time[k], clearance: clearance[k], force: force[k] });
    const inside = moments.filter(({ time }) => time >= this.begin && time <= this.end);
    return inside.sort((one, other) => one.time - other.time);
  }

  /** Puts rows for the known moments between the samples. */
  addKnownMoments() {
    if (this.times.length === 0) return;
    const samples = this.times;
    const nearly = 1e-9 * (this.end - this.begin);
    const times = [];
    const known = []; // by row: what is known there, or nothing
    const from = []; // by row: its sample, or the one before it
    const isSample = [];
    const moments = this.knownMoments();
    const add = (time, sample, really) => {
      times.push(time);
      from.push(sample);
      isSample.push(really);
      known.push(null);
    };
    const note = (moment) => (known[known.length - 1] ??= []).push(moment);
    let next = 0;
    for (let sample = 0; sample < samples.length; sample++) {
      while (next < moments.length && moments[next].time < samples[sample] - nearly) {
        const { time } = moments[next];
        if (time > times[times.length - 1] + nearly) add(time, sample - 1, false);
        note(moments[next++]);
      }
      add(samples[sample], sample, true);
    }
    while (next < moments.length) note(moments[next++]);
    const rows = { times: Float64Array.from(times), from, isSample };
    const over = [...this.columns].filter(([name]) => name !== "time" && !/^(contact|peak)_/.test(name));
    for (const [name, values] of over) this.columns.set(name, between(values, samples, rows));
    this.times = rows.times;
    this.isSample = isSample;
    known.forEach((moments, row) => {
      if (!isSample[row]) for (const moment of moments) this.know(moment, row);
    });
  }

  know({ clearance, force, depth }, row) {
    const name = this.clearances[clearance];
    const normal = this.column("normal_force", name);
    if (normal) normal[row] = force;
    if (depth === undefined) return;
    const penetration = this.column("penetration", name);
    if (penetration) penetration[row] = depth;
    const [x, y] = [this.column("clearance_x", name), this.column("clearance_y", name)];
    const radial = this.radial(clearance);
    if (!x || !y || radial === null) return;
    const longer = (radial + depth) / Math.hypot(x[row], y[row]);
    if (Number.isFinite(longer)) [x[row], y[row]] = [x[row] * longer, y[row] * longer];
  }

  /** The row at or before a time. */
  rowAt(time) {
    let [low, high] = [0, this.times.length - 1];
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /** Goes to a time: `at` then tells values there, on straight lines between rows. */
  seek(time) {
    const within = Math.min(Math.max(time, this.begin), this.end);
    this.row = this.rowAt(within);
    const next = Math.min(this.row + 1, this.times.length - 1);
    const step = this.times[next] - this.times[this.row];
    this.share = step > 0 ? (within - this.times[this.row]) / step : 0;
  }

  /** The value of a column at the time sought; nothing without rows. */
  at(values) {
    if (!values || this.row >= values.length) return NaN;
    const value = values[this.row];
    return this.share > 0 ? value + this.share * (values[this.row + 1] - value) : value;
  }

  /** Force (N) on the second body of a joint at the time sought. */
  forceAt(joint) {
    const name = this.joints[joint];
    const sampled = [this.at(this.column("joint_force_x", name)), this.at(this.column("joint_force_y", name))];
    const normal = this.column("normal_force", name);
    if (!normal) return sampled;
    // The contact's own columns know the peaks; the joint's do not.
    const [x, y] = this.offsetAt(name);
    const length = Math.hypot(x, y);
    if (!(length > 0)) return [0, 0];
    const [fn, ft] = [this.at(normal), this.at(this.column("tangential_force", name)) || 0];
    return [(-fn * x - ft * y) / length, (-fn * y + ft * x) / length];
  }

  /** Journal centre minus bearing centre (m) at the time sought. */
  offsetAt(name) {
    return [this.at(this.column("clearance_x", name)) || 0, this.at(this.column("clearance_y", name)) || 0];
  }

  /** Magnitude of a joint's force (N) over the rows; nothing where the file has none. */
  forceMagnitude(name) {
    const normal = this.column("normal_force", name);
    const [x, y] = normal
      ? [normal, this.column("tangential_force", name)]
      : [this.column("joint_force_x", name), this.column("joint_force_y", name)];
    if (!x) return null;
    return x.map((value, row) => Math.hypot(value, y ? y[row] : 0));
  }

  /** The contact of a clearance at a time, if it touches. */
  contactAt(clearance, time) {
    return this.contactsOf(clearance).find(({ begin, end }) => begin <= time && time <= end) ?? null;
  }
}

/** A column over the samples, with values on straight lines at the rows put between. */
function between(values, samples, { times, from, isSample }) {
  return times.map((time, row) => {
    const sample = from[row];
    if (isSample[row]) return values[sample];
    const share = (time - samples[sample]) / (samples[sample + 1] - samples[sample]);
    return values[sample] + share * (values[sample + 1] - values[sample]);
  });
}

// What the charts show: a card each, a curve an item.

const ENERGIES = [
  ["kinetic", "energy_kinetic"],
  ["potential", "energy_potential"],
  ["elastic", "energy_elastic"],
  ["dissipated", "energy_dissipated"],
  ["drive work", "drive_work"],
  ["load work", "load_work"],
];

const column = (dataset) => (run, item) => run.column(dataset, item);

/** Length of a vector that the file has by x and y. */
const magnitude = (dataset) => (run, item) => {
  const [x, y] = [run.column(`${dataset}_x`, item), run.column(`${dataset}_y`, item)];
  return x && y ? x.map((value, row) => Math.hypot(value, y[row])) : null;
};

/**
 * Cards in their order. `items(run)` names the curves that a run can have, `values(run, item)`
 * gives one over the run's rows; `state` says that it is known as long as the state is, and not
 * only as long as forces are; `joints` says that the items are joints, which have colours of
 * their own; `floor` keeps the axis from going below; `sampled` says that the curve knows nothing
 * between the samples; `first` names the curves to begin with, and `alone` keeps the ideal
 * mechanism's away.
 */
export const QUANTITIES = [
  {
    id: "force",
    title: "Force in joint",
    unit: "N",
    joints: true,
    open: true,
    floor: 0,
    items: (run) => run.joints,
    values: (run, item) => run.forceMagnitude(item),
    note: "Peaks of contacts are those of the contact table, whatever the samples are.",
  },
  {
    id: "eccentricity",
    state: true,
    title: "Eccentricity of journal in bearing, or of corner in guide",
    unit: "m",
    joints: true,
    open: true,
    floor: 0,
    items: (run) => run.clearances,
    values: eccentricity,
    mark: (run, item) => run.play(run.clearances.indexOf(item)),
    note: "The line is the radial clearance c, or the play.",
  },
  {
    id: "depth",
    state: true,
    title: "Depth of penetration",
    unit: "m",
    joints: true,
    open: false,
    floor: 0,
    items: (run) => run.clearances,
    values: (run, item) => run.column("penetration", item)?.map((depth) => Math.max(depth, 0)) ?? null,
    note: "The greatest depth of each contact, from the contact table, is drawn at the time of its peak force.",
  },
  {
    id: "torque",
    title: "Drive torque",
    unit: "N m",
    open: true,
    sampled: true,
    items: (run) => run.drives,
    values: column("drive_torque"),
  },
  {
    id: "acceleration",
    title: "Angular acceleration",
    unit: "rad/s²",
    open: true,
    sampled: true,
    items: (run) => moving(run, "angular_acceleration"),
    values: column("angular_acceleration"),
  },
  {
    id: "rate",
    state: true,
    title: "Angular velocity",
    unit: "rad/s",
    open: false,
    items: (run) => run.bodies,
    values: column("angular_velocity"),
  },
  {
    id: "point-speed",
    state: true,
    title: "Speed of point",
    unit: "m/s",
    open: true,
    floor: 0,
    items: (run) => run.points,
    values: magnitude("point_velocity"),
  },
  {
    id: "point-acceleration",
    title: "Acceleration of point",
    unit: "m/s²",
    open: false,
    sampled: true,
    floor: 0,
    items: (run) => run.points,
    values: magnitude("point_acceleration"),
  },
  {
    id: "energy",
    state: true,
    title: "Energies and works",
    unit: "J",
    open: true,
    alone: true,
    first: ["kinetic", "potential", "dissipated"],
    items: (run) => ENERGIES.filter(([, dataset]) => isUsed(run.column(dataset))).map(([name]) => name),
    values: (run, item) => run.column(ENERGIES.find(([name]) => name === item)?.[1]),
  },
  {
    id: "residual",
    state: true,
    title: "Residual of the energy balance",
    unit: "J",
    open: false,
    items: (run) => (isUsed(run.column("energy_residual")) ? ["residual"] : []),
    values: (run) => run.column("energy_residual"),
  },
];

function eccentricity(run, item) {
  const depth = run.column("penetration", item);
  const play = run.play(run.clearances.indexOf(item));
  if (depth && play !== null) return depth.map((value) => value + play);
  const [x, y] = [run.column("clearance_x", item), run.column("clearance_y", item)];
  return x && y ? x.map((value, row) => Math.hypot(value, y[row])) : null;
}

/** Bodies of which a column is not zero throughout; all, where it is for each. */
function moving(run, dataset) {
  const bodies = run.bodies.filter((body) => isUsed(run.column(dataset, body)));
  return bodies.length ? bodies : run.bodies;
}

function isUsed(values) {
  return values !== null && values.some((value) => value !== 0);
}

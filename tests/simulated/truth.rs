//! Tables computed in high precision, `tests/data/truth`, and how far a run agrees with them.

use super::root;
use freeplay::mechanism::Observation;

/// A table of numbers with named columns.
pub struct Table {
    names: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads `tests/data/truth/NAME.csv`. Columns of words come as NaN.
    pub fn read(name: &str) -> Table {
        let path = root().join("tests/data/truth").join(format!("{name}.csv"));
        let text = std::fs::read_to_string(path).unwrap();
        let mut lines = text.lines();
        let words = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let names = words(lines.next().unwrap());
        let number = |word: &String| word.parse().unwrap_or(f64::NAN);
        let rows = lines.map(|line| words(line).iter().map(number).collect()).collect();
        Table { names, rows }
    }

    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.rows.iter().map(|values| Row { names: &self.names, values })
    }

    /// The row of a time (s).
    pub fn at(&self, time: f64) -> Row<'_> {
        self.rows().find(|row| row.of("time") == time).expect("the table has the time")
    }
}

/// One row of a table.
#[derive(Clone, Copy)]
pub struct Row<'a> {
    names: &'a [String],
    values: &'a [f64],
}

impl Row<'_> {
    /// The value in a column.
    pub fn of(&self, column: &str) -> f64 {
        self.values[self.names.iter().position(|name| name == column).expect("the table has it")]
    }
}

/// Typical sizes of the paper's four-bar: angles (rad), angular rates (rad/s), clearance vectors (m), velocities of mass
/// centres (m/s).
const SCALES: [f64; 4] = [1.0, 523.6, 1e-3, 15.7];

/// The state of the paper's four-bar at one sample, over its typical sizes.
pub fn scaled(sample: &Observation) -> Vec<f64> {
    let bodies = sample.bodies[1..].iter().flat_map(|body| {
        let [x, y] = body.velocity;
        [body.angle / SCALES[0], body.angular_velocity / SCALES[1], x / SCALES[3], y / SCALES[3]]
    });
    let clearances = sample.clearances.iter().flat_map(|clearance| clearance.offset);
    bodies.chain(clearances.map(|offset| offset / SCALES[2])).collect()
}

/// The same, from a row of a table; `clearances` are the names of the joints with clearance.
pub fn scaled_truth(row: Row<'_>, clearances: &[&str]) -> Vec<f64> {
    let bodies = ["coupler", "follower"].into_iter().flat_map(|body| {
        let of = |column: &str, scale: f64| row.of(&format!("{body}_{column}")) / scale;
        [of("angle", SCALES[0]), of("omega", SCALES[1]), of("vx", SCALES[3]), of("vy", SCALES[3])]
    });
    let clearances = clearances
        .iter()
        .flat_map(|name| ["x", "y"].map(|axis| row.of(&format!("{name}_clearance_{axis}"))));
    bodies.chain(clearances.map(|offset| offset / SCALES[2])).collect()
}

/// Number of digits to which two scaled states agree: −log10 of their largest difference.
pub fn digits(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let off = a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    -off.log10()
}

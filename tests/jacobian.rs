//! The hand-written Jacobian of whole mechanisms. Known in advance: every column of it, from dual
//! numbers, which differentiate the residual exactly.

mod simulated;

use freeplay::clearance::{Contact, Mode};
use freeplay::contact::{Damping, elastic, viscous};
use freeplay::dae::{Dae, State, System};
use freeplay::friction;
use freeplay::mechanism::Mechanism;
use freeplay::model::Model;
use freeplay::parameter::Kind;
use freeplay::plane::Vector;
use freeplay::scalar::{Dual64, Scalar};
use nalgebra::DMatrix;
use simulated::{case, root};
use std::path::PathBuf;

/// Agreement asked for, relative to the largest entry of a column.
const AGREEMENT: f64 = 1e-12;

/// Numbers between −1 and 1, the same each time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Time, unknowns, rates and the factor c_j of one trial.
struct Trial {
    t: f64,
    y: Vec<f64>,
    yp: Vec<f64>,
    cj: f64,
}

impl Trial {
    /// A state near a mechanism's start: journals off by a few clearances, everything moving.
    fn new(mechanism: &Mechanism<f64>, numbers: &mut Numbers) -> Trial {
        let start = mechanism.start();
        let n = mechanism.coordinates();
        let mut y = Vec::new();
        y.extend(start.q.iter().map(|q| q + 3e-3 * numbers.next()));
        y.extend(start.v.iter().map(|v| v + 10.0 * numbers.next()));
        let bristles = mechanism.inner_scales();
        y.extend(bristles.iter().map(|size| 2.0 * size * numbers.next()));
        y.extend((0..mechanism.multipliers()).map(|_| 1e3 * numbers.next()));
        let mut yp: Vec<f64> = y[n..2 * n].iter().map(|v| v + numbers.next()).collect();
        yp.extend((0..n).map(|_| 1e4 * numbers.next()));
        yp.extend(bristles.iter().map(|_| numbers.next()));
        yp.extend((0..mechanism.multipliers()).map(|_| numbers.next()));
        Trial { t: 0.01 * numbers.next().abs(), y, yp, cj: 10_f64.powf(3.0 + 4.0 * numbers.next()) }
    }
}

/// Every way in which a clearance can be: flight, and contact in each branch of friction, at a fast and a
/// slow impact, with the law pulling or not.
fn modes<S: Scalar>(mechanism: &Mechanism<S>, clearance: usize) -> Vec<Mode<S>> {
    let law = &mechanism.model().clearances()[clearance];
    let mut modes = vec![Mode::Flight];
    for slip in [-1.0, -5e-3, 0.0, 5e-3, 1.0] {
        for (rate, pulling) in [(2.0, false), (1e-4, false), (0.5, true)] {
            let contact = law.begin(S::zero(), S::from_f64(rate), S::from_f64(slip), S::zero());
            modes.push(Mode::Contact(Contact { pulling, ..contact }));
        }
    }
    modes
}

/// The Jacobian as the mechanism gives it.
fn by_hand(mechanism: &mut Mechanism<f64>, trial: &Trial) -> DMatrix<f64> {
    let size = trial.y.len();
    let mut jacobian = DMatrix::zeros(size, size);
    mechanism.jacobian(trial.t, &trial.y, &trial.yp, trial.cj, &mut jacobian).unwrap();
    jacobian
}

/// The same, column by column: ε in y, and c_j ε in ẏ.
fn by_dual_numbers(mechanism: &mut Mechanism<Dual64>, trial: &Trial) -> DMatrix<f64> {
    let size = trial.y.len();
    let mut jacobian = DMatrix::zeros(size, size);
    let mut residual = vec![Dual64::from_re(0.0); size];
    for column in 0..size {
        let along = |x: &[f64], slope: f64| -> Vec<Dual64> {
            let slope_of = |k: usize| if k == column { slope } else { 0.0 };
            x.iter().enumerate().map(|(k, x)| Dual64::new(*x, slope_of(k))).collect()
        };
        let (y, yp) = (along(&trial.y, 1.0), along(&trial.yp, trial.cj));
        mechanism.index_one_residual(Dual64::from_re(trial.t), &y, &yp, &mut residual);
        for (row, residual) in residual.iter().enumerate() {
            jacobian[(row, column)] = residual.eps;
        }
    }
    jacobian
}

fn assert_agreement(what: &str, found: &DMatrix<f64>, exact: &DMatrix<f64>) {
    for (column, (found, exact)) in found.column_iter().zip(exact.column_iter()).enumerate() {
        let allowed = AGREEMENT * exact.amax();
        let off = (found - exact).amax();
        assert!(off <= allowed, "{what}, column {column}: off by {off:e}, allowed {allowed:e}");
    }
}

/// Trials of a mechanism in all its modes; says in how many of them journals touched.
fn assert_jacobian(path: &str, set: &[&str]) -> usize {
    let description = case(path, set).description;
    let mut real = Mechanism::<f64>::new(Model::new(&description).unwrap()).unwrap();
    let mut dual = Mechanism::<Dual64>::new(Model::new(&description).unwrap()).unwrap();
    if real.coordinates() == 0 {
        return 0;
    }
    let clearances = real.modes().len();
    let choices: Vec<_> = (0..clearances).map(|k| (modes(&real, k), modes(&dual, k))).collect();
    let rounds = choices.first().map_or(1, |(modes, _)| modes.len());
    let mut numbers = Numbers(2026);
    let mut touched = 0;
    for round in 0..4 * rounds {
        for (k, (of_real, of_dual)) in choices.iter().enumerate() {
            // a stride of its own for each clearance, so that all meet all others
            let choice = (round * (2 * k + 1) + k) % of_real.len();
            real.set_mode(k, of_real[choice]);
            dual.set_mode(k, of_dual[choice]);
        }
        let trial = Trial::new(&real, &mut numbers);
        let mut residual = vec![0.0; trial.y.len()];
        // a piece of a law far beyond its edges may grow beyond all numbers
        if real.residual(trial.t, &trial.y, &trial.yp, &mut residual).is_err() {
            continue;
        }
        let (found, exact) = (by_hand(&mut real, &trial), by_dual_numbers(&mut dual, &trial));
        assert_agreement(&format!("{path} {set:?}, trial {round}"), &found, &exact);
        real.residual(trial.t, &trial.y, &trial.yp, &mut residual).unwrap();
        touched += (0..clearances)
            .filter(|k| real.contact_rates(*k).is_some_and(|rates| rates.force != 0.0))
            .count();
    }
    touched
}

/// The cases of a folder, by their paths in the project.
fn cases_in(folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap();
    let paths = entries.map(|entry| PathBuf::from(entry.unwrap().file_name()));
    let tomls = paths.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    tomls.map(|path| format!("{folder}/{}", path.display())).collect()
}

#[test]
fn every_column_is_that_of_dual_numbers_in_every_mode_of_every_case() {
    let folders = ["cases", "tests/cases", "tests/kinds", "src/cli/new"];
    let cases = folders.map(cases_in).concat();
    assert!(cases.len() >= 28, "{cases:?}");
    for path in cases {
        let touched = assert_jacobian(&path, &[]);
        let clearances =
            !case(&path, &[]).description.joints.iter().all(|joint| joint.clearance.is_none());
        assert!(touched >= 10 || !clearances, "{path}: {touched} contacts with a force");
    }
}

/// The table that the example of a law has for a key.
fn table_of<'a>(kind: &'a Kind, key: &str) -> &'a str {
    let opening = format!("\n{key} = ");
    let (_, table) = kind.example.split_once(&opening).expect("an example with a table");
    table.trim()
}

#[test]
fn every_column_is_that_of_dual_numbers_with_every_law() {
    let weights = Damping::ALL.iter().map(|(word, law)| {
        let restitution = if law.about().restitution { "restitution = 0.7, " } else { "" };
        ("normal", format!("{{ law = \"{word}\", {restitution}stiffness = 1e10 }}"))
    });
    let of = |key: &'static str, kinds: &'static [&Kind]| {
        kinds.iter().map(move |kind| (key, table_of(kind, key).to_owned()))
    };
    let laws = weights
        .chain(of("normal", elastic::KINDS))
        .chain(of("normal", viscous::KINDS))
        .chain(of("friction", friction::KINDS));
    for (key, table) in laws {
        let set = format!("joints.A.clearance.{key}={table}");
        let touched = assert_jacobian("cases/four-bar-a-friction.toml", &[&set]);
        assert!(touched >= 10, "{table}: {touched} contacts with a force");
    }
}

#[test]
fn a_wrong_column_would_be_noticed() {
    let exact = DMatrix::from_row_slice(2, 2, &[1.0, 1e6, -3.0, 2.0]);
    let mut wrong = exact.clone();
    wrong[(1, 1)] += 1e-5;
    assert!(std::panic::catch_unwind(|| assert_agreement("", &wrong, &exact)).is_err());
    wrong[(1, 1)] = exact[(1, 1)];
    assert_agreement("", &wrong, &exact);
}

#[test]
fn rates_of_the_offsets_are_the_derivatives_of_the_offsets() {
    let description = case("cases/four-bar-c.toml", &[]).description;
    let mut real = Mechanism::<f64>::new(Model::new(&description).unwrap()).unwrap();
    let mut dual = Mechanism::<Dual64>::new(Model::new(&description).unwrap()).unwrap();
    let (n, count) = (real.coordinates(), real.offsets());
    assert_eq!(count, 3);
    let mut numbers = Numbers(2026);
    for _ in 0..20 {
        let Trial { t, y, .. } = Trial::new(&real, &mut numbers);
        let (q, v) = (&y[..n], &y[n..2 * n]);
        let along: Vec<Dual64> = q.iter().zip(v).map(|(q, v)| Dual64::new(*q, *v)).collect();
        let rest = vec![Dual64::from_re(0.0); n];
        let state = State { time: Dual64::new(t, 1.0), q: &along, v: &rest, z: &[], carried: None };
        let mut offsets = vec![Vector::zero(); count];
        dual.offsets_at(state, &mut offsets);
        real.evaluate(State { time: t, q, v, z: &[], carried: None }).unwrap();
        let mut rates = vec![Vector::zero(); count];
        real.offset_rates(&mut rates);
        for (offset, rate) in offsets.iter().zip(&rates) {
            let off = (offset.x.eps - rate.x).abs().max((offset.y.eps - rate.y).abs());
            assert!(off < 1e-13 * 30.0, "off by {off:e} m/s");
        }
    }
}

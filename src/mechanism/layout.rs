//! Which bodies have unknowns, and which joints are equations.
//!
//! A body whose motion the drives prescribe completely has no unknowns: its motion is a known
//! function of time. Every other body has three coordinates (paper, eq. 16 counts them less the
//! constraints).

use crate::joint::{AngleDrive, Constraint, Derived, MOST_BODIES, Pair, Relation, Travel};
use crate::linear::Symmetric;
use crate::model::{Complaint, GROUND, KeyPath, Model, Owner};
use crate::plane::{Pose, Vector};
use crate::scalar::Scalar;

/// What a body is to the equations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Never moves.
    Ground,
    /// Moves as the drives prescribe.
    Driven,
    /// Has unknowns, from this place in q and v on.
    Free(usize),
}

/// A body that a drive prescribes completely.
#[derive(Debug, Clone, Copy)]
pub(super) struct DrivenBody {
    pub body: usize,
    /// The body it turns on, itself driven or the ground.
    pub base: usize,
    pub drive: usize,
    pub joint: usize,
    /// Whether the driven body is the second of its joint.
    pub second: bool,
    /// Whether it has an angular acceleration.
    pub accelerates: bool,
}

/// A constraint and the place of its rows among the multipliers.
#[derive(Debug, Clone)]
pub(super) struct Row<S> {
    pub constraint: Constraint<S>,
    pub first: usize,
    pub owner: Owner,
}

/// A body with unknowns that two constraint rows share: it couples their multipliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coupling<S> {
    pub row: usize,
    /// At most `row`.
    pub column: usize,
    /// Whether the body is the first (0), second (1) or third (2) of each row's constraint.
    pub sides: [usize; 2],
    /// Its place in v.
    pub at: usize,
    /// Where the entry that it adds to stands in Φ_q M⁻¹ Φ_qᵀ.
    pub entry: usize,
    /// What its translation adds to the entry (1/kg), wherever it stands; zero where that is not a
    /// constant.
    pub translation: S,
}

impl<S: Scalar> Row<S> {
    /// Places of its rows among the multipliers.
    #[inline(always)]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.constraint.rows()
    }
}

/// The unknowns and equations of a model.
#[derive(Debug, Clone)]
pub(super) struct Layout<S> {
    /// By body.
    pub roles: Vec<Role>,
    /// Each after its base.
    pub driven: Vec<DrivenBody>,
    pub constraints: Vec<Row<S>>,
    /// Of rows whose coefficients at ẋ and ẏ are constants.
    pub couplings: Vec<Coupling<S>>,
    /// Of the other rows.
    pub uneven_couplings: Vec<Coupling<S>>,
    /// Φ_q M⁻¹ Φ_qᵀ, with the pattern that these have.
    pub matrix: Symmetric<S>,
    /// Number n of coordinates.
    pub coordinates: usize,
    /// Number m of constraint rows.
    pub rows: usize,
}

impl<S: Scalar> Layout<S> {
    /// Sorts the bodies and joints of a model.
    ///
    /// # Errors
    /// Joints or drives between bodies whose motion is prescribed already.
    pub fn new(model: &Model<S>) -> Result<Self, Vec<Complaint>> {
        let bodies = model.masses().len();
        let driven = driven_bodies(model);
        let mut roles = vec![Role::Ground; bodies];
        let mut coordinates = 0;
        for (body, role) in roles.iter_mut().enumerate().skip(1) {
            *role = match driven.iter().any(|driven| driven.body == body) {
                true => Role::Driven,
                false => {
                    coordinates += 3;
                    Role::Free(coordinates - 3)
                }
            };
        }
        let mut constraints = Vec::new();
        let mut complaints = Vec::new();
        let mut rows = 0;
        for (constraint, owner) in equations(model, &driven) {
            if constraint.bodies().iter().all(|body| !matches!(roles[*body], Role::Free(_))) {
                complaints.push(prescribed_twice(model, owner));
            }
            let first = rows;
            rows += constraint.rows();
            constraints.push(Row { constraint, first, owner });
        }
        if complaints.is_empty() && rows > coordinates {
            complaints.push(Complaint {
                key: KeyPath::new(["joints"]),
                message: format!(
                    "hold the mechanism {} times too often: {coordinates} coordinates, {rows} \
                     constraints; remove a joint or a drive, or give a joint clearance",
                    rows - coordinates
                ),
            });
        }
        match complaints.is_empty() {
            true => {
                let (mut couplings, mut uneven_couplings) =
                    couplings(&constraints, &roles, model.masses());
                let both = || couplings.iter().chain(&uneven_couplings);
                let matrix = Symmetric::new(rows, both().map(|both| (both.row, both.column)));
                for both in couplings.iter_mut().chain(&mut uneven_couplings) {
                    both.entry = matrix.place(both.row, both.column);
                }
                Ok(Layout {
                    roles,
                    driven,
                    constraints,
                    couplings,
                    uneven_couplings,
                    matrix,
                    coordinates,
                    rows,
                })
            }
            false => Err(complaints),
        }
    }

    /// The joint or drive that a constraint row belongs to.
    pub fn owner(&self, row: usize) -> Owner {
        let found = self.constraints.iter().rev().find(|constraint| constraint.first <= row);
        found.map_or(Owner::Joint(0), |found| found.owner)
    }
}

/// Which rows share which bodies, lower triangle: those with constant coefficients at ẋ and ẏ, and
/// the others.
fn couplings<S: Scalar>(
    constraints: &[Row<S>],
    roles: &[Role],
    masses: &[S],
) -> (Vec<Coupling<S>>, Vec<Coupling<S>>) {
    let poses = vec![Pose::fixed(); roles.len()];
    let mut sides_of = vec![Vec::new(); roles.len()];
    let mut all = Vec::new();
    for row in constraints {
        let mut slopes = vec![[[S::zero(); 3]; MOST_BODIES]; row.constraint.rows()];
        if row.constraint.moves_evenly() {
            row.constraint.reach(&poses, &mut [Vector::zero(); 2], &mut slopes);
        }
        for (side, body) in row.constraint.bodies().into_iter().enumerate() {
            for (r, blocks) in slopes.iter().enumerate() {
                let along = Vector::new(blocks[side][0], blocks[side][1]);
                let (row, evenly) = (row.first + r, row.constraint.moves_evenly());
                all.push((body, row, side, along, evenly));
                sides_of[body].push((row, side, along, evenly));
            }
        }
    }
    let (mut even, mut uneven) = (Vec::new(), Vec::new());
    for (body, row, side, along, evenly) in all {
        let Role::Free(at) = roles[body] else { continue };
        let shares = sides_of[body].iter().filter(|(column, ..)| *column <= row);
        for &(column, other, across, also) in shares {
            let list = if evenly && also { &mut even } else { &mut uneven };
            let translation = along.dot(across) / masses[body];
            let sides = [side, other];
            list.push(Coupling { row, column, sides, at, entry: 0, translation });
        }
    }
    (even, uneven)
}

fn prescribed_twice<S: Scalar>(model: &Model<S>, owner: Owner) -> Complaint {
    Complaint {
        key: owner.key(model.names()),
        message: "joins two bodies whose motion the drives prescribe already; \
                  remove it, or give it clearance"
            .into(),
    }
}

/// Bodies that turn on the ground or on a driven body, by a drive on an ideal revolute joint.
fn driven_bodies<S: Scalar>(model: &Model<S>) -> Vec<DrivenBody> {
    let mut found: Vec<DrivenBody> = Vec::new();
    loop {
        let known = |body: usize, found: &[DrivenBody]| {
            body == GROUND || found.iter().any(|driven| driven.body == body)
        };
        let next = model.drives().iter().enumerate().find_map(|(drive, law)| {
            let joint = &model.joints()[law.joint];
            let (i, j) = (joint.ends.pair.i, joint.ends.pair.j);
            let turns =
                matches!(joint.relation, Relation::Revolute(_)) && joint.clearance.is_none();
            if !turns || known(i, &found) == known(j, &found) {
                return None;
            }
            let second = known(i, &found);
            let (base, body) = if second { (i, j) } else { (j, i) };
            let accelerates = law.course.accelerates()
                || found.iter().any(|driven| driven.body == base && driven.accelerates);
            Some(DrivenBody { body, base, drive, joint: law.joint, second, accelerates })
        });
        match next {
            Some(driven) => found.push(driven),
            None => return found,
        }
    }
}

/// Every ideal joint and drive that eliminates no body.
fn equations<S: Scalar>(model: &Model<S>, driven: &[DrivenBody]) -> Vec<(Constraint<S>, Owner)> {
    let joints = model.joints().iter().enumerate().filter(|(index, joint)| {
        joint.clearance.is_none() && driven.iter().all(|driven| driven.joint != *index)
    });
    let drives = (model.drives().iter().enumerate())
        .filter(|(index, _)| driven.iter().all(|driven| driven.drive != *index));
    let driving = |(index, drive): (usize, &crate::model::Drive<S>)| {
        let joint = &model.joints()[drive.joint];
        let (course, Pair { i, j, .. }) = (drive.course.clone(), joint.ends.pair);
        let constraint = match joint.relation {
            Relation::Prismatic(slide) => {
                Constraint::Derived(Derived::travel(Travel { slide, course }, &joint.ends))
            }
            _ => Constraint::Drive(AngleDrive { i, j, course }),
        };
        (constraint, Owner::Drive(index))
    };
    joints
        .map(|(index, joint)| (Constraint::joint(joint.relation, &joint.ends), Owner::Joint(index)))
        .chain(drives.map(driving))
        .collect()
}

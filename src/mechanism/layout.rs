//! Which bodies have unknowns, and which joints are equations.
//!
//! A body whose motion the drives prescribe completely has no unknowns: its motion is a known
//! function of time. Every other body has three coordinates (paper, eq. 16 counts them less the
//! constraints).

use crate::joint::{AngleDrive, Constraint, Derived, Pair, Relation, Travel};
use crate::linear::Symmetric;
use crate::model::{Complaint, GROUND, Model, Owner};
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
    /// Number of its rows.
    pub rows: usize,
    pub owner: Owner,
}

/// A body with unknowns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct FreeBody<S> {
    pub body: usize,
    /// Its place in q and v.
    pub at: usize,
    /// One over its mass (1/kg).
    pub mass: S,
    /// One over its inertia (1/(kg m²)).
    pub inertia: S,
}

/// A body with unknowns that two revolute joints share, or twice the same: it couples their
/// multipliers, two by two, by
/// ```text
/// ± [ 1/m + a_y b_y/I   − a_y b_x/I     ]
///   [ − a_x b_y/I         1/m + a_x b_x/I ]
/// ```
/// with the arms a and b of both on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hinge<S> {
    /// Their constraints; the second is at most the first.
    pub constraints: [usize; 2],
    /// Whether the body is the first (0) or the second (1) of each.
    pub sides: [usize; 2],
    /// ±1/m and ±1/I.
    pub mobility: [S; 2],
    /// Where the entries of the first row stand in Φ_q M⁻¹ Φ_qᵀ, and those of the second. Of a joint
    /// with itself the second of the first row is above the diagonal, and not wanted.
    pub entries: [[usize; 2]; 2],
}

/// A body with unknowns that two constraint rows of other kinds share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coupling {
    pub row: usize,
    /// At most `row`.
    pub column: usize,
    /// Whether the body is the first (0), second (1) or third (2) of each row's constraint.
    pub sides: [usize; 2],
    /// Its place in v.
    pub at: usize,
    /// Where the entry that it adds to stands in Φ_q M⁻¹ Φ_qᵀ.
    pub entry: usize,
}

impl<S: Scalar> Row<S> {
    /// Places of its rows among the multipliers.
    #[inline(always)]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.rows
    }
}

/// The unknowns and equations of a model.
#[derive(Debug, Clone)]
pub(super) struct Layout<S> {
    /// By body.
    pub roles: Vec<Role>,
    /// Each after its base.
    pub driven: Vec<DrivenBody>,
    pub free: Vec<FreeBody<S>>,
    pub constraints: Vec<Row<S>>,
    /// Of revolute joints with each other.
    pub hinges: Vec<Hinge<S>>,
    /// Of all other constraints.
    pub couplings: Vec<Coupling>,
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
            let (first, own) = (rows, constraint.rows());
            rows += own;
            constraints.push(Row { constraint, first, rows: own, owner });
        }
        if !complaints.is_empty() {
            return Err(complaints);
        }
        let free = roles.iter().enumerate().filter_map(|(body, role)| match role {
            Role::Free(at) => Some(FreeBody {
                body,
                at: *at,
                mass: S::one() / model.masses()[body],
                inertia: S::one() / model.inertias()[body],
            }),
            _ => None,
        });
        let mut layout = Layout {
            free: free.collect(),
            hinges: Vec::new(),
            couplings: Vec::new(),
            roles,
            driven,
            constraints,
            matrix: Symmetric::new(0, []),
            coordinates,
            rows,
        };
        layout.couple(model, false);
        Ok(layout)
    }

    /// Lets the mass–constraint matrix have all entries.
    pub fn fill(&mut self, model: &Model<S>) {
        self.couple(model, true);
    }

    /// Finds the pattern of the mass–constraint matrix, or fills it, and what adds to which entry.
    fn couple(&mut self, model: &Model<S>, full: bool) {
        let shared = shared(&self.constraints, &self.roles);
        let rows = self.rows;
        let matrix = match full {
            true => Symmetric::new(rows, (0..rows * rows).map(|k| (k / rows, k % rows))),
            false => Symmetric::new(rows, shared.iter().flat_map(Shared::entries)),
        };
        let hinges = shared.iter().filter_map(|shared| shared.hinge(model, &matrix)).collect();
        let couplings = shared.iter().filter(|shared| !shared.are_revolute());
        let couplings = couplings.flat_map(|shared| shared.couplings(&matrix)).collect();
        (self.hinges, self.couplings, self.matrix) = (hinges, couplings, matrix);
    }

    /// The joint or drive that a constraint row belongs to.
    pub fn owner(&self, row: usize) -> Owner {
        let found = self.constraints.iter().rev().find(|constraint| constraint.first <= row);
        found.map_or(Owner::Joint(0), |found| found.owner)
    }
}

/// A body with unknowns that two constraints share, or twice the same.
struct Shared<'a, S> {
    body: usize,
    at: usize,
    /// Their numbers; the second is at most the first.
    numbers: [usize; 2],
    constraints: [&'a Row<S>; 2],
    sides: [usize; 2],
}

/// Which constraints share which bodies.
fn shared<'a, S: Scalar>(constraints: &'a [Row<S>], roles: &[Role]) -> Vec<Shared<'a, S>> {
    let mut on = vec![Vec::new(); roles.len()];
    for (number, row) in constraints.iter().enumerate() {
        for (side, body) in row.constraint.bodies().into_iter().enumerate() {
            on[body].push((number, side));
        }
    }
    let mut all = Vec::new();
    for (number, row) in constraints.iter().enumerate() {
        for (side, body) in row.constraint.bodies().into_iter().enumerate() {
            let Role::Free(at) = roles[body] else { continue };
            for &(other, across) in on[body].iter().filter(|(other, _)| *other <= number) {
                let (numbers, constraints) = ([number, other], [row, &constraints[other]]);
                all.push(Shared { body, at, numbers, constraints, sides: [side, across] });
            }
        }
    }
    all
}

impl<S: Scalar> Shared<'_, S> {
    /// The entries of the lower triangle that it adds to, by row and column.
    fn entries(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let [rows, columns] = self.constraints.map(Row::range);
        rows.flat_map(move |row| columns.clone().map(move |column| (row, column)))
            .filter(|(row, column)| column <= row)
    }

    fn are_revolute(&self) -> bool {
        self.constraints.iter().all(|row| matches!(row.constraint, Constraint::Revolute(_)))
    }

    /// The coupling of revolute joints.
    fn hinge(&self, model: &Model<S>, matrix: &Symmetric<S>) -> Option<Hinge<S>> {
        if !self.are_revolute() {
            return None;
        }
        let [of, with] = self.constraints.map(|row| row.first);
        let place = |row: usize, column: usize| matrix.place(row.max(column), row.min(column));
        let entries = [0, 1].map(|r| [0, 1].map(|c| place(of + r, with + c)));
        let sign = if self.sides[0] == self.sides[1] { S::one() } else { -S::one() };
        let mobility = [model.masses()[self.body], model.inertias()[self.body]];
        let mobility = mobility.map(|inertia| sign / inertia);
        Some(Hinge { constraints: self.numbers, sides: self.sides, mobility, entries })
    }

    /// The couplings of the rows of other constraints.
    fn couplings(&self, matrix: &Symmetric<S>) -> impl Iterator<Item = Coupling> {
        let (sides, at) = (self.sides, self.at);
        self.entries().map(move |(row, column)| {
            let entry = matrix.place(row, column);
            Coupling { row, column, sides, at, entry }
        })
    }
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
            let turns = matches!(joint.relation, Relation::Revolute(_)) && !joint.is_loose();
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
        !joint.is_loose() && driven.iter().all(|driven| driven.joint != *index)
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

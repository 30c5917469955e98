//! Which bodies have unknowns, and which joints are equations.
//!
//! A body whose motion the drives prescribe completely has no unknowns: its motion is a known
//! function of time. Every other body has three coordinates (paper, eq. 16 counts them less the
//! constraints).

use crate::joint::{Constraint, Revolute};
use crate::model::{Complaint, GROUND, KeyPath, Model};
use crate::plane::Vector;
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
}

/// Where a constraint comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Origin {
    Joint(usize),
    Drive(usize),
}

/// A constraint and the place of its rows among the multipliers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<S> {
    pub constraint: Constraint<S>,
    pub first: usize,
    pub origin: Origin,
}

/// A body with unknowns that two constraint rows share: it couples their multipliers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Coupling<S> {
    pub row: usize,
    /// At most `row`.
    pub column: usize,
    /// Whether the body is the first (0) or the second (1) of each row's constraint.
    pub sides: [usize; 2],
    /// Its place in v.
    pub at: usize,
    /// What its translation adds to the entry (1/kg), wherever it stands.
    pub translation: S,
}

/// The unknowns and equations of a model.
#[derive(Debug, Clone)]
pub(super) struct Layout<S> {
    /// By body.
    pub roles: Vec<Role>,
    /// Each after its base.
    pub driven: Vec<DrivenBody>,
    pub constraints: Vec<Row<S>>,
    pub couplings: Vec<Coupling<S>>,
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
        for (constraint, origin) in equations(model, &driven) {
            if constraint.bodies().iter().all(|body| !matches!(roles[*body], Role::Free(_))) {
                complaints.push(prescribed_twice(model, origin));
            }
            constraints.push(Row { constraint, first: rows, origin });
            rows += constraint.rows();
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
                let couplings = couplings(&constraints, &roles, model.masses());
                Ok(Layout { roles, driven, constraints, couplings, coordinates, rows })
            }
            false => Err(complaints),
        }
    }

    /// The key of the joint or drive that a constraint row belongs to.
    pub fn key(&self, model: &Model<S>, row: usize) -> KeyPath {
        let owner = self.constraints.iter().rev().find(|constraint| constraint.first <= row);
        owner.map_or(KeyPath::new(["joints"]), |owner| key(model, owner.origin))
    }
}

/// Which rows share which bodies, lower triangle.
fn couplings<S: Scalar>(constraints: &[Row<S>], roles: &[Role], masses: &[S]) -> Vec<Coupling<S>> {
    let mut all = Vec::new();
    for row in constraints {
        for (side, body) in row.constraint.bodies().into_iter().enumerate() {
            for r in 0..row.constraint.rows() {
                // the coefficients at ẋ and ẏ do not depend on the arms
                let block = row.constraint.jacobian(r, &[Vector::zero(); 2])[side];
                all.push((row.first + r, side, body, Vector::new(block[0], block[1])));
            }
        }
    }
    let mut found = Vec::new();
    for &(row, side, body, along) in &all {
        let Role::Free(at) = roles[body] else { continue };
        for &(column, other, _, across) in all.iter().filter(|(c, _, b, _)| *c <= row && *b == body)
        {
            let translation = along.dot(across) / masses[body];
            found.push(Coupling { row, column, sides: [side, other], at, translation });
        }
    }
    found
}

/// The key of a joint or a drive.
pub(super) fn key<S: Scalar>(model: &Model<S>, origin: Origin) -> KeyPath {
    match origin {
        Origin::Joint(joint) => KeyPath::new(["joints", &model.names().joints[joint]]),
        Origin::Drive(drive) => KeyPath::new(["drives", &model.names().drives[drive]]),
    }
}

fn prescribed_twice<S: Scalar>(model: &Model<S>, origin: Origin) -> Complaint {
    Complaint {
        key: key(model, origin),
        message: "joins two bodies whose motion the drives prescribe already; \
                  remove it, or give it clearance"
            .into(),
    }
}

/// Bodies that turn on the ground or on a driven body, by a drive on an ideal joint.
fn driven_bodies<S: Scalar>(model: &Model<S>) -> Vec<DrivenBody> {
    let mut found: Vec<DrivenBody> = Vec::new();
    loop {
        let known = |body: usize, found: &[DrivenBody]| {
            body == GROUND || found.iter().any(|driven| driven.body == body)
        };
        let next = model.drives().iter().enumerate().find_map(|(drive, law)| {
            let joint = &model.joints()[law.joint];
            let (i, j) = (joint.pair.i, joint.pair.j);
            if joint.clearance.is_some() || known(i, &found) == known(j, &found) {
                return None;
            }
            let second = known(i, &found);
            let (base, body) = if second { (i, j) } else { (j, i) };
            Some(DrivenBody { body, base, drive, joint: law.joint, second })
        });
        match next {
            Some(driven) => found.push(driven),
            None => return found,
        }
    }
}

/// Every ideal joint and drive that eliminates no body.
fn equations<S: Scalar>(model: &Model<S>, driven: &[DrivenBody]) -> Vec<(Constraint<S>, Origin)> {
    let joints = model.joints().iter().enumerate().filter(|(index, joint)| {
        joint.clearance.is_none() && driven.iter().all(|driven| driven.joint != *index)
    });
    let drives = (model.drives().iter().enumerate())
        .filter(|(index, _)| driven.iter().all(|driven| driven.drive != *index));
    joints
        .map(|(index, joint)| {
            (Constraint::Revolute(Revolute { pair: joint.pair }), Origin::Joint(index))
        })
        .chain(drives.map(|(index, drive)| (Constraint::Drive(drive.law), Origin::Drive(index))))
        .collect()
}

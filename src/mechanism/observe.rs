//! What is told of a mechanism: positions to energies, in double precision.

use super::layout::Role;
use super::{
    BodyObservation, ClearanceObservation, EnergyObservation, JointObservation, Mechanism,
    Observation, PointObservation, Touch,
};
use crate::clearance::Mode;
use crate::model::{Joint, Owner, Point};
use crate::plane::{Vector, Wrench};
use crate::scalar::Scalar;

impl<S: Scalar> Mechanism<S> {
    /// Everything at the state last evaluated. `time` (s) is the sample's own, `integrals` (J)
    /// are those that an engine carried to it.
    pub fn observe(&self, time: f64, integrals: &[S]) -> Observation {
        Observation {
            time,
            bodies: (1..self.layout.roles.len()).map(|body| self.observe_body(body)).collect(),
            clearances: (0..self.modes.len()).map(|k| self.observe_clearance(k)).collect(),
            joints: (0..self.model.joints().len()).map(|k| self.observe_joint(k)).collect(),
            drive_torques: (0..self.model.drives().len())
                .map(|drive| self.drive_torque(drive).to_f64())
                .collect(),
            points: self.model.points().iter().map(|point| self.observe_point(point)).collect(),
            memories: self.now.z.iter().map(|z| z.to_f64()).collect(),
            energy: self.observe_energy(integrals),
            beyond: self.beyond(),
        }
    }

    /// What the state is beyond its doubles, in an arithmetic that knows more.
    fn beyond(&self) -> Vec<f64> {
        let mut beyond = Vec::new();
        if !S::GOES_BEYOND {
            return beyond;
        }
        for (pose, motion) in self.now.poses.iter().zip(&self.now.motions).skip(1) {
            let (at, going) = (pose.position + self.model.origin(), motion.linear);
            let state = [at.x, at.y, pose.angle, going.x, going.y, motion.angular];
            beyond.extend(state.map(S::beyond));
        }
        for (k, clearance) in self.model.clearances().iter().enumerate() {
            let offset = self.now.gap(k, clearance).offset;
            beyond.extend([offset.x, offset.y].map(S::beyond));
        }
        beyond
    }

    fn observe_body(&self, body: usize) -> BodyObservation {
        let (pose, motion) = (&self.now.poses[body], &self.now.motions[body]);
        let acceleration = &self.now.accelerations[body];
        BodyObservation {
            position: doubles(pose.position + self.model.origin()),
            angle: pose.angle.to_f64(),
            velocity: doubles(motion.linear),
            angular_velocity: motion.angular.to_f64(),
            acceleration: doubles(acceleration.linear),
            angular_acceleration: acceleration.angular.to_f64(),
        }
    }

    /// ```text
    /// p = r + A s,   ṗ = ṙ + ω A s⊥,   p̈ = r̈ + α A s⊥ − ω² A s
    /// ```
    fn observe_point(&self, point: &Point<S>) -> PointObservation {
        let (pose, motion) = (&self.now.poses[point.body], &self.now.motions[point.body]);
        let (arm, turn) = (pose.rotate(point.at), motion.angular);
        let inward = arm * -(turn * turn);
        let acceleration = self.now.accelerations[point.body].at(arm) + inward;
        PointObservation {
            position: doubles(pose.position + arm + self.model.origin()),
            velocity: doubles(motion.at(arm)),
            acceleration: doubles(acceleration),
        }
    }

    fn observe_clearance(&self, k: usize) -> ClearanceObservation {
        let law = &self.model.clearances()[k];
        let gap = self.now.gap(k, law);
        let (rate, slip) = self.gap_rates(k);
        let force = self.now.touches[k].as_ref().map(|touch| touch.force);
        ClearanceObservation {
            offset: doubles(self.offset(k)),
            eccentricity: gap.eccentricity.to_f64(),
            penetration: gap.depth.to_f64(),
            penetration_rate: rate.to_f64(),
            slip_velocity: slip.to_f64(),
            normal_force: force.map_or(0.0, |force| force.normal.value.to_f64()),
            tangential_force: force.map_or(0.0, |force| force.tangential.to_f64()),
            in_contact: matches!(self.modes[k], Mode::Contact(_)),
        }
    }

    fn observe_joint(&self, index: usize) -> JointObservation {
        let joint = &self.model.joints()[index];
        if joint.is_loose() {
            return self.observe_contacts(joint);
        }
        let driven = self.layout.driven.iter().position(|driven| driven.joint == index);
        let wrench = match driven {
            Some(place) => {
                let force = self.now.driving[place].0;
                let force = if self.layout.driven[place].second { force } else { -force };
                Wrench { force, moment: S::zero() }
            }
            None => {
                let at = self.layout.constraints.iter();
                let at = at.zip(&self.now.arms).find(|(row, _)| row.owner == Owner::Joint(index));
                at.map_or(Wrench::none(), |(row, arms)| {
                    let (slopes, lambda) = (&self.now.jacobian, &self.now.lambda);
                    row.constraint.on_second(arms, &slopes[row.range()], &lambda[row.range()])
                })
            }
        };
        JointObservation { force: doubles(wrench.force), moment: wrench.moment.to_f64() }
    }

    /// Force and moment of the contacts of a joint on its second body, at the joint's point there.
    fn observe_contacts(&self, joint: &Joint<S>) -> JointObservation {
        let pair = &joint.ends.pair;
        let at = self.now.poses[pair.j].rotate(pair.s_j);
        let mut sum = Wrench::none();
        for k in joint.clearances.clone() {
            let Some(Touch { gap, force, .. }) = &self.now.touches[k] else { continue };
            let moment = self.model.clearances()[k].journal_radius * force.tangential;
            let turned = (gap.arm_j - at).cross(force.on_journal);
            sum += Wrench { force: force.on_journal, moment: moment + turned };
        }
        JointObservation { force: doubles(sum.force), moment: sum.moment.to_f64() }
    }

    fn observe_energy(&self, integrals: &[S]) -> EnergyObservation {
        let drive_work = integrals[self.ledger.drives()];
        let in_clearances = &integrals[self.ledger.clearances()];
        let dissipated = in_clearances.iter().fold(S::zero(), |sum, d| sum + *d);
        let (load_work, dissipated) = match self.ledger.loads() {
            Some([work, by_loads]) => (integrals[work], dissipated + integrals[by_loads]),
            None => (S::zero(), dissipated),
        };
        let (kinetic, potential, elastic) =
            (self.kinetic_energy(), self.potential_energy(), self.elastic_energy());
        let put_in = drive_work + load_work;
        let residual = kinetic + potential + elastic + dissipated - put_in - self.start_energy;
        EnergyObservation {
            kinetic: kinetic.to_f64(),
            potential: potential.to_f64(),
            elastic: elastic.to_f64(),
            dissipated: dissipated.to_f64(),
            drive_work: drive_work.to_f64(),
            load_work: load_work.to_f64(),
            residual: residual.to_f64(),
        }
    }

    /// Kinetic, potential and elastic energy (J) at the state last evaluated.
    pub(super) fn stored_energy(&self) -> S {
        self.kinetic_energy() + self.potential_energy() + self.elastic_energy()
    }

    fn kinetic_energy(&self) -> S {
        let half = S::from_f64(0.5);
        let mut sum = S::zero();
        for (body, role) in self.layout.roles.iter().enumerate() {
            if *role == Role::Ground {
                continue;
            }
            let motion = &self.now.motions[body];
            sum += half * self.model.masses()[body] * motion.linear.dot(motion.linear)
                + half * self.model.inertias()[body] * motion.angular * motion.angular;
        }
        sum
    }

    fn potential_energy(&self) -> S {
        let loads = self.model.loads().iter();
        loads.fold(S::zero(), |sum, load| {
            sum + load.potential_energy(self.model.masses(), &self.now.poses)
        })
    }

    fn elastic_energy(&self) -> S {
        let touches = self.now.touches.iter().zip(self.model.clearances());
        touches.fold(S::zero(), |sum, (touch, law)| match touch {
            Some(touch) => sum + law.normal.energy(touch.gap.depth),
            None => sum,
        })
    }
}

fn doubles<S: Scalar>(v: Vector<S>) -> [f64; 2] {
    [v.x.to_f64(), v.y.to_f64()]
}

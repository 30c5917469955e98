//! The energy balance of a run.

use super::Error;
use super::contacts::At;
use crate::mechanism::EnergyObservation;
use crate::record::{Dimension, ResultFile};

/// Samples that are read at once.
const BLOCK: usize = 65_536;

/// Energies and works at the end of a run (J), and what the balance is off by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyBalance {
    /// Time (s) of the last sample, of which these are.
    pub time: f64,
    /// Kinetic, potential and elastic energy gained since the first sample.
    pub stored: f64,
    /// Dissipated by contact damping, friction and dampers since then.
    pub dissipated: f64,
    /// Work of the drives since then.
    pub drive_work: f64,
    /// Work of the applied forces and torques since then.
    pub load_work: f64,
    /// What the balance since the start of the run is off by at the end.
    pub residual: f64,
    /// Largest amount that the balance was off by at a sample.
    pub largest_residual: At,
    /// The largest kinetic energy at a sample.
    pub largest_kinetic: f64,
}

impl EnergyBalance {
    /// Of a file; `None` without samples.
    ///
    /// # Errors
    /// What reading the file meets.
    pub fn of(file: &ResultFile) -> Result<Option<Self>, Error> {
        let samples = file.length(Dimension::Time);
        let mut tally = Tally::default();
        for begin in (0..samples).step_by(BLOCK) {
            let rows = begin..samples.min(begin + BLOCK);
            let column = |name| -> Result<Vec<f64>, Error> {
                Ok(file.table_rows(file.dataset(name)?, rows.clone())?.values)
            };
            let times = column("time")?;
            let (kinetic, potential) = (column("energy_kinetic")?, column("energy_potential")?);
            let (elastic, dissipated) = (column("energy_elastic")?, column("energy_dissipated")?);
            let (drive_work, load_work) = (column("drive_work")?, column("load_work")?);
            let residual = column("energy_residual")?;
            for (k, &time) in times.iter().enumerate() {
                let energy = EnergyObservation {
                    kinetic: kinetic[k],
                    potential: potential[k],
                    elastic: elastic[k],
                    dissipated: dissipated[k],
                    drive_work: drive_work[k],
                    load_work: load_work[k],
                    residual: residual[k],
                };
                tally.take(time, energy);
            }
        }
        Ok(tally.balance())
    }

    /// Of samples in the order of time, each with its time (s); `None` without any.
    pub fn of_samples(samples: impl IntoIterator<Item = (f64, EnergyObservation)>) -> Option<Self> {
        let mut tally = Tally::default();
        samples.into_iter().for_each(|(time, energy)| tally.take(time, energy));
        tally.balance()
    }
}

/// What the balance needs of the samples so far.
#[derive(Default)]
struct Tally {
    first: Option<EnergyObservation>,
    last: Option<(f64, EnergyObservation)>,
    largest_residual: Option<At>,
    largest_kinetic: Option<f64>,
}

impl Tally {
    /// Takes in the next sample.
    fn take(&mut self, time: f64, energy: EnergyObservation) {
        let off = At { value: energy.residual.abs(), time };
        let known = self.largest_residual;
        if off.value.is_finite() && known.is_none_or(|known| off.value > known.value) {
            self.largest_residual = Some(off);
        }
        if energy.kinetic.is_finite() {
            let known = self.largest_kinetic.unwrap_or(f64::NAN);
            self.largest_kinetic = Some(known.max(energy.kinetic));
        }
        self.first.get_or_insert(energy);
        self.last = Some((time, energy));
    }

    /// The balance; `None` without samples.
    fn balance(self) -> Option<EnergyBalance> {
        let (first, (time, end)) = self.first.zip(self.last)?;
        let stored = (end.kinetic - first.kinetic)
            + (end.potential - first.potential)
            + (end.elastic - first.elastic);
        Some(EnergyBalance {
            time,
            stored,
            dissipated: end.dissipated - first.dissipated,
            drive_work: end.drive_work - first.drive_work,
            load_work: end.load_work - first.load_work,
            residual: end.residual,
            largest_residual: self.largest_residual.unwrap_or(At { value: f64::NAN, time }),
            largest_kinetic: self.largest_kinetic.unwrap_or(f64::NAN),
        })
    }
}

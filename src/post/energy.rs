//! The energy balance of a run.

use super::Error;
use super::contacts::At;
use crate::mechanism::EnergyObservation;
use crate::record::ResultFile;

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
        let times = file.times()?;
        let column = |name| file.column(name);
        let (kinetic, potential) = (column("energy_kinetic")?, column("energy_potential")?);
        let (elastic, dissipated) = (column("energy_elastic")?, column("energy_dissipated")?);
        let (drive_work, load_work) = (column("drive_work")?, column("load_work")?);
        let residual = column("energy_residual")?;
        let samples = times.iter().enumerate().map(|(k, &time)| {
            let energy = EnergyObservation {
                kinetic: kinetic[k],
                potential: potential[k],
                elastic: elastic[k],
                dissipated: dissipated[k],
                drive_work: drive_work[k],
                load_work: load_work[k],
                residual: residual[k],
            };
            (time, energy)
        });
        Ok(Self::of_samples(samples))
    }

    /// Of samples in the order of time, each with its time (s); `None` without any.
    pub fn of_samples(samples: impl IntoIterator<Item = (f64, EnergyObservation)>) -> Option<Self> {
        let mut samples = samples.into_iter().peekable();
        let (_, first) = *samples.peek()?;
        let (mut last, mut largest, mut kinetic) = (None, None::<At>, f64::NAN);
        for (time, energy) in samples {
            let off = At { value: energy.residual.abs(), time };
            if off.value.is_finite() && largest.is_none_or(|known| off.value > known.value) {
                largest = Some(off);
            }
            if energy.kinetic.is_finite() {
                kinetic = kinetic.max(energy.kinetic);
            }
            last = Some((time, energy));
        }
        let (time, end) = last?;
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
            largest_residual: largest.unwrap_or(At { value: f64::NAN, time }),
            largest_kinetic: kinetic,
        })
    }
}

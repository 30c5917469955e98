//! The energy balance of a run.

use super::Error;
use super::contacts::At;
use crate::record::ResultFile;

/// Energies and works at the end of a run (J), and what the balance is off by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnergyBalance {
    /// Time (s) of the last sample, of which these are.
    pub time: f64,
    /// Kinetic, potential and elastic energy gained since the start.
    pub stored: f64,
    /// Dissipated by contact damping, friction and dampers.
    pub dissipated: f64,
    /// Work of the drives.
    pub drive_work: f64,
    /// Work of the applied forces and torques.
    pub load_work: f64,
    /// What the balance is off by at the end.
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
        let Some(&time) = times.last() else { return Ok(None) };
        let last = |values: &[f64]| values.last().copied().unwrap_or(f64::NAN);
        let kinetic = file.column("energy_kinetic")?;
        let mut stored = last(&kinetic) - kinetic[0];
        for name in ["energy_potential", "energy_elastic"] {
            let energy = file.column(name)?;
            stored += last(&energy) - energy[0];
        }
        let residuals = file.column("energy_residual")?;
        let pairs = times.iter().zip(&residuals);
        let largest = pairs
            .map(|(time, residual)| At { value: residual.abs(), time: *time })
            .filter(|at| at.value.is_finite())
            .reduce(|largest, other| if other.value > largest.value { other } else { largest });
        let numbers = kinetic.iter().copied().filter(|energy| energy.is_finite());
        Ok(Some(EnergyBalance {
            time,
            stored,
            dissipated: last(&file.column("energy_dissipated")?),
            drive_work: last(&file.column("drive_work")?),
            load_work: last(&file.column("load_work")?),
            residual: last(&residuals),
            largest_residual: largest.unwrap_or(At { value: f64::NAN, time }),
            largest_kinetic: numbers.fold(f64::NAN, f64::max),
        }))
    }
}

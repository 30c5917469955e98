//! Histories of a joint with clearance, with the events and extremes that lie between samples.

use super::Error;
use super::decimate::Point;
use super::runs::Run;
use crate::record::Dimension;
use crate::run::{Contact, EventKind};

/// State of a clearance at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Moment {
    /// Time (s).
    pub time: f64,
    /// Penetration (m), negative in flight.
    pub depth: f64,
    /// Rate of the penetration (m/s).
    pub rate: f64,
    /// Normal force (N).
    pub force: f64,
}

/// Joints with clearance that a run has, with their indices.
pub(super) fn clearance(run: &Run, name: &str) -> Option<usize> {
    run.index(Dimension::Clearance, name)
}

/// Normal force (N) over the horizontal axis: samples, zero at both ends of each contact, and every
/// local maximum.
pub(super) fn normal_force(run: &Run, clearance: usize) -> Result<Vec<Point>, Error> {
    let forces = run.samples("normal_force")?.column(clearance);
    let mut points: Vec<Point> =
        run.times.iter().copied().zip(forces).map(|(t, f)| [t, f]).collect();
    let contacts = || contacts(run, clearance);
    points.extend(contacts().flat_map(|contact| [[contact.begin, 0.0], [contact.end, 0.0]]));
    points.extend(contacts().map(|contact| [contact.peak_time, contact.peak_force]));
    let peaks = run.peaks.iter().filter(|peak| peak.clearance == clearance);
    points.extend(peaks.map(|peak| [peak.time, peak.force]));
    points.retain(|[time, _]| run.shows(*time));
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    Ok(points.into_iter().map(|[time, force]| [run.place(time), force]).collect())
}

/// The contacts of a clearance.
pub(super) fn contacts(run: &Run, clearance: usize) -> impl Iterator<Item = &Contact> {
    run.contacts.iter().filter(move |contact| contact.clearance == clearance)
}

/// The states of a clearance at all samples and at both ends of each contact, in order of time.
pub(super) fn moments(run: &Run, clearance: usize) -> Result<Vec<Moment>, Error> {
    let [depths, rates, forces] = ["penetration", "penetration_rate", "normal_force"]
        .map(|dataset| run.samples(dataset).map(|samples| samples.column(clearance)));
    let (depths, rates, forces) = (depths?, rates?, forces?);
    let mut moments: Vec<Moment> = run
        .times
        .iter()
        .enumerate()
        .map(|(k, time)| Moment { time: *time, depth: depths[k], rate: rates[k], force: forces[k] })
        .collect();
    let ends = run.events.iter().filter(|event| {
        event.clearance == clearance
            && matches!(event.kind, EventKind::ContactBegins | EventKind::ContactEnds)
    });
    moments.extend(ends.filter(|event| run.shows(event.time)).map(|event| Moment {
        time: event.time,
        depth: 0.0,
        rate: event.rate,
        force: 0.0,
    }));
    moments.sort_by(|a, b| a.time.total_cmp(&b.time));
    Ok(moments)
}

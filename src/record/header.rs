//! What a writer must know before a run, and what it is told at the end.

use super::Attribute;
use super::schema::{Dimension, Values};
use crate::dae::Count;
use std::time::{SystemTime, UNIX_EPOCH};

/// What is known of a run before it begins. Lists follow the order of the case file, as those of
/// an [`Observation`](crate::mechanism::Observation) do.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Header {
    /// Name of the case: attribute `case_name`.
    pub name: String,
    /// Title of the case: attribute `title`.
    pub title: String,
    /// The case file's text as run: attribute `case_toml`, and its SHA-256 in `case_sha256`.
    pub case_text: String,
    /// Names of all bodies.
    pub bodies: Vec<String>,
    /// Names of all joints.
    pub joints: Vec<String>,
    /// Names of the joints with clearance.
    pub clearances: Vec<String>,
    /// Names of the drives.
    pub drives: Vec<String>,
    /// Names of the points that are observed.
    pub points: Vec<String>,
    /// Names of the inner states.
    pub memories: Vec<String>,
    /// Version of SUNDIALS: attribute `sundials_version`.
    pub sundials_version: String,
    /// More attributes of the root, with their names: tolerances, decisions.
    pub attributes: Vec<(String, Attribute)>,
    /// When the run began: attribute `started_utc`; [`utc`] writes it.
    pub started_utc: String,
    /// How many samples there will be, or somewhat more; `None` where the run may be made longer.
    pub samples: Option<u64>,
}

/// Rows of a block at most and, but for wide ones, at least.
const ROWS: std::ops::RangeInclusive<usize> = 64..=4096;
/// Bytes that a block's widest table may have.
const WIDEST: usize = 1 << 22;

impl Header {
    /// Rows of a block: of a chunk of the file and of what is written at once. Not many more than there
    /// will be, for a chunk is compressed and kept as a whole.
    pub(super) fn block_rows(&self) -> usize {
        let samples = self.samples.and_then(|samples| usize::try_from(samples).ok());
        let rows = samples.unwrap_or(usize::MAX).clamp(*ROWS.start(), *ROWS.end());
        let width = self.bodies.len().max(self.joints.len()).max(self.points.len()).max(1)
            * size_of::<f64>();
        rows.min(WIDEST / width).max(1)
    }
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Ending {
    /// Whether it came to its end.
    pub outcome: Outcome,
    /// What the engine counted: attributes `solver_<name>`.
    pub counts: Vec<Count>,
    /// How often each decision was called on: attributes `ruling_<name>_count`.
    pub rulings: Vec<Count>,
    /// When the run ended: attribute `finished_utc`; [`utc`] writes it.
    pub finished_utc: String,
    /// Datasets that are known only now.
    pub series: Vec<Series>,
    /// Attributes of the root that are known only now, with their names.
    pub attributes: Vec<(String, Attribute)>,
}

/// A dataset along a dimension that grows, known as a whole at the run's end: what a certificate
/// says of each sample, for example.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Name.
    pub name: &'static str,
    /// Attribute `units`.
    pub unit: &'static str,
    /// Attribute `long_name`.
    pub long_name: &'static str,
    /// How the values are stored.
    pub stored: Values,
    /// The dimension.
    pub along: Dimension,
    /// A value for each place along it.
    pub values: Vec<f64>,
}

/// Whether a run came to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// To the end of its duration: `run_status` is `complete`.
    Complete,
    /// To a checkpoint, from where it goes on in another file: `run_status` is `running`.
    Running,
    /// Failed or interrupted: `run_status` is `failed`.
    Failed {
        /// Why: attribute `run_failure`.
        reason: String,
    },
}

/// A time as `2026-03-01T12:00:00Z`; times before 1970 are taken as its beginning.
pub fn utc(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (mut days, second) = (seconds / 86_400, seconds % 86_400);
    let mut year = 1970;
    while days >= days_of_year(year) {
        days -= days_of_year(year);
        year += 1;
    }
    let february = days_of_year(year) - 337;
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{:02}T{hour:02}:{minute:02}:{second:02}Z", days + 1)
}

/// Days of a year of the Gregorian calendar.
fn days_of_year(year: u64) -> u64 {
    let leap = year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    if leap { 366 } else { 365 }
}

#[cfg(test)]
mod tests {
    use super::utc;
    use std::time::{Duration, UNIX_EPOCH};

    #[test]
    fn times_are_those_of_the_gregorian_calendar() {
        // `date -u -d @SECONDS +%FT%TZ`
        for (seconds, expected) in [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (951_868_800, "2000-03-01T00:00:00Z"),
            (1_767_225_599, "2025-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ] {
            assert_eq!(utc(UNIX_EPOCH + Duration::from_secs(seconds)), expected);
        }
    }
}

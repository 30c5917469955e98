//! What happened in each joint with clearance: contacts, flights, permanent contact.

use super::Revolutions;
use crate::run::Contact;

/// A value and its time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct At {
    /// The value.
    pub value: f64,
    /// Its time (s).
    pub time: f64,
}

/// A stretch of flight or contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// Begin (s).
    pub begin: f64,
    /// End (s): that of the run where it had not ended by then.
    pub end: f64,
    /// Whether it lasted to the end of the run.
    pub open: bool,
}

impl Stretch {
    /// How long it lasted (s).
    pub fn length(&self) -> f64 {
        self.end - self.begin
    }
}

/// The contacts of one joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Contacts {
    /// Name of the joint.
    pub joint: String,
    /// How many began.
    pub count: usize,
    /// Time in contact (s).
    pub duration: f64,
    /// Share of the run's time in contact; `None` if the run has no length.
    pub share: Option<f64>,
    /// The longest contact.
    pub longest_contact: Option<Stretch>,
    /// The longest flight.
    pub longest_flight: Option<Stretch>,
    /// The deepest penetration (m).
    pub deepest: Option<At>,
    /// The fastest impact (m/s).
    pub fastest: Option<At>,
    /// Dissipated by damping and friction (J).
    pub dissipated: f64,
    /// Phases of permanent contact: contacts that last a revolution of the drive or longer;
    /// without a drive, half of the run or longer.
    pub permanent: Vec<Stretch>,
    /// The same by revolution; empty without revolutions.
    pub revolutions: Vec<RevolutionContacts>,
}

/// The contacts of one joint in one revolution.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct RevolutionContacts {
    /// How many began.
    pub count: usize,
    /// Share of its time in contact.
    pub share: f64,
    /// Fastest impact that began in it (m/s).
    pub fastest: Option<At>,
}

impl Contacts {
    /// The contacts of the clearance of this index and name in a part of a run, up to its end (s). Of a
    /// contact that began before the part its time in the part counts, and its peak if that lies there;
    /// its impact and what it dissipated do not. Numbers of revolutions are those of all the run's.
    pub fn of(
        (clearance, joint): (usize, &str),
        contacts: &[Contact],
        [begin, end]: [f64; 2],
        parts: Option<Revolutions>,
    ) -> Self {
        let whole = || contacts.iter().filter(|contact| contact.clearance == clearance);
        let all: Vec<Stretch> = whole().map(|contact| stretch(contact, end)).collect();
        let within = all.iter().filter(|stretch| stretch.end > begin || stretch.begin >= begin);
        let stretches: Vec<Stretch> =
            within.map(|s| Stretch { begin: s.begin.max(begin), ..*s }).collect();
        let its = || whole().filter(|contact| contact.begin >= begin);
        let duration: f64 = stretches.iter().map(Stretch::length).sum();
        let length = end - begin;
        let permanent = parts.map_or(length / 2.0, |parts| parts.period() * (1.0 - 1e-9));
        Contacts {
            joint: joint.to_owned(),
            count: its().count(),
            duration,
            share: (length > 0.0).then(|| duration / length),
            longest_contact: longest(stretches.iter().copied()),
            longest_flight: longest(flights(&stretches, [begin, end]).into_iter()),
            deepest: largest(
                whole()
                    .map(|c| At { value: c.peak_penetration, time: c.peak_penetration_time })
                    .filter(|deepest| deepest.time >= begin),
            ),
            fastest: largest(its().map(impact)),
            dissipated: its().map(|contact| contact.dissipated).filter(|x| x.is_finite()).sum(),
            permanent: (stretches.iter().copied())
                .filter(|stretch| length > 0.0 && stretch.length() >= permanent)
                .collect(),
            revolutions: parts.map_or(Vec::new(), |parts| {
                let its: Vec<&Contact> = whole().collect();
                (0..parts.count()).map(|k| revolution(k, parts, &its, &all)).collect()
            }),
        }
    }
}

fn stretch(contact: &Contact, end: f64) -> Stretch {
    let open = contact.end.is_nan();
    Stretch { begin: contact.begin, end: if open { end } else { contact.end }, open }
}

fn impact(contact: &Contact) -> At {
    At { value: contact.impact_rate, time: contact.begin }
}

/// What lies between the contacts of a joint, which stand in the order of time.
fn flights(contacts: &[Stretch], [begin, end]: [f64; 2]) -> Vec<Stretch> {
    let begins = std::iter::once(begin).chain(contacts.iter().map(|contact| contact.end));
    let ends = contacts.iter().map(|contact| (contact.begin, false)).chain([(end, true)]);
    begins
        .zip(ends)
        .map(|(begin, (end, open))| Stretch { begin, end, open })
        .filter(|flight| flight.length() > 0.0)
        .collect()
}

fn longest(stretches: impl Iterator<Item = Stretch>) -> Option<Stretch> {
    stretches
        .reduce(|longest, other| if other.length() > longest.length() { other } else { longest })
}

/// The largest value that is a number; the first of equal ones.
fn largest(values: impl Iterator<Item = At>) -> Option<At> {
    let numbers = values.filter(|at| at.value.is_finite());
    numbers.reduce(|largest, other| if other.value > largest.value { other } else { largest })
}

/// `contacts` and their `stretches` stand in the order of time, and do not overlap.
fn revolution(
    k: usize,
    parts: Revolutions,
    contacts: &[&Contact],
    stretches: &[Stretch],
) -> RevolutionContacts {
    let [begin, end] = parts.bounds(k);
    let before = |k: usize| contacts.partition_point(|contact| parts.of(contact.begin) < k);
    let begun = &contacts[before(k)..before(k + 1)];
    let inside = |stretch: &Stretch| (stretch.end.min(end) - stretch.begin.max(begin)).max(0.0);
    let first = stretches.partition_point(|stretch| stretch.end < begin);
    let reaching = stretches[first..].iter().take_while(|stretch| stretch.begin <= end);
    RevolutionContacts {
        count: begun.len(),
        share: reaching.map(inside).fold(0.0, |sum, part| sum + part) / (end - begin),
        fastest: largest(begun.iter().map(|contact| impact(contact))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contact(clearance: usize, begin: f64, end: f64) -> Contact {
        Contact {
            clearance,
            begin,
            end,
            impact_rate: begin + 1.0,
            peak_penetration: 1e-6,
            peak_penetration_time: begin + 0.1,
            peak_force: 1.0,
            peak_time: begin,
            dissipated: 0.25,
        }
    }

    /// Contacts of two joints in two revolutions of 1 s.
    fn of(clearance: usize, drive: bool) -> Contacts {
        let parts = Revolutions::new(std::f64::consts::TAU, 2.0, 10).filter(|_| drive);
        let contacts = [
            contact(0, 0.25, 0.5),
            contact(1, 0.3, 0.35),
            contact(0, 0.75, 1.0),
            contact(1, 0.5, f64::NAN),
        ];
        Contacts::of((clearance, "A"), &contacts, [0.0, 2.0], parts)
    }

    #[test]
    fn contacts_and_flights_fill_the_run() {
        let contacts = of(0, true);
        assert_eq!((contacts.count, contacts.duration, contacts.share), (2, 0.5, Some(0.25)));
        let flight = contacts.longest_flight.unwrap();
        assert_eq!((flight.begin, flight.end, flight.open), (1.0, 2.0, true));
        assert_eq!(contacts.longest_contact.unwrap().length(), 0.25);
        assert_eq!(contacts.fastest, Some(At { value: 1.75, time: 0.75 }));
        assert_eq!(contacts.dissipated, 0.5);
        assert!(contacts.permanent.is_empty());
        let counts = contacts.revolutions.iter().map(|part| (part.count, part.share));
        assert_eq!(counts.collect::<Vec<_>>(), [(2, 0.5), (0, 0.0)]);
    }

    #[test]
    fn of_a_part_what_began_before_it_counts_by_its_time_there() {
        let contacts = [contact(0, 0.25, 0.5), contact(0, 0.75, 1.25), contact(0, 1.5, 1.75)];
        let part = Contacts::of((0, "A"), &contacts, [1.0, 2.0], None);
        assert_eq!((part.count, part.duration, part.share), (1, 0.5, Some(0.5)));
        let flight = part.longest_flight.unwrap();
        assert_eq!((flight.begin, flight.end), (1.25, 1.5));
        // the peak of the second lay at 0.85
        assert_eq!(part.deepest.unwrap().time, 1.6);
        assert_eq!((part.fastest.unwrap().time, part.dissipated), (1.5, 0.25));
    }

    #[test]
    fn a_contact_that_lasts_a_revolution_is_permanent_and_runs_to_the_end() {
        for drive in [true, false] {
            let contacts = of(1, drive);
            assert_eq!(contacts.permanent, [Stretch { begin: 0.5, end: 2.0, open: true }]);
            assert_eq!(contacts.longest_flight.unwrap().length(), 0.3);
            assert_eq!(contacts.revolutions.is_empty(), !drive);
        }
    }

    #[test]
    fn a_joint_that_never_touches_flies_all_the_time() {
        let contacts = Contacts::of((0, "A"), &[], [0.0, 2.0], None);
        assert_eq!((contacts.count, contacts.share), (0, Some(0.0)));
        assert_eq!(contacts.longest_flight.unwrap().length(), 2.0);
        assert_eq!((contacts.longest_contact, contacts.deepest), (None, None));
    }

    #[test]
    fn a_run_without_length_has_no_shares() {
        let contacts = Contacts::of((0, "A"), &[contact(0, 0.0, f64::NAN)], [0.0, 0.0], None);
        assert_eq!((contacts.share, contacts.longest_flight), (None, None));
        assert!(contacts.permanent.is_empty());
    }
}

//! Events of IDA's steps.
//!
//! IDA's own search for roots compares signs at the ends of a step, and is not used. A step may be
//! long: in free flight the unknowns are polynomials in time, which BDF follows exactly over many
//! turns of a body. A function that is zero at a restart it does not watch at all. So each step is
//! proven to hold no event ([`guard`]), or its first event is found on IDA's interpolant, and
//! bracketed as closely as IDA would. The right end of the bracket is the event's state: it has been
//! crossed, and nothing is polished. Where the search has to look into a step that turns far, it
//! goes by panels of a radian.

use super::{Error, Ida, ROUNDINGS_AT_END, take};
use crate::dae::{Course, Dae, Direction};
use crate::engine::guard::{self, Found, Look};

/// A panel turns no further than this (rad).
const PANEL_TURN: f64 = 1.0;
const MOST_PANELS: f64 = 1e5;
/// What a state may be off the constraints by, in units of the tolerance.
const DRIFT: f64 = 10.0;
/// Looks that halve a bracket to its final width, and as many that guess.
const MOST_HALVINGS: usize = 128;

/// What is known of the event functions at the ends of the latest step.
#[derive(Debug)]
pub(super) struct Events {
    /// Where the step began, by function, with the sign that makes it rise to its event.
    begin: Vec<Course>,
    /// Where it ended.
    end: Vec<Course>,
    /// Functions beyond zero: they have to fall first.
    passed: Vec<bool>,
    /// How they were watched since the last restart.
    directions: Vec<Direction>,
    /// When each function rises in the step (s).
    rises: Vec<Option<f64>>,
    /// Looks at event functions within steps.
    pub(super) looks: u64,
    /// Searches that no bound settled.
    pub(super) unproven: u64,
}

impl Events {
    pub(super) fn new(functions: usize) -> Events {
        Events {
            begin: vec![Course::NONE; functions],
            end: vec![Course::NONE; functions],
            passed: vec![false; functions],
            directions: vec![Direction::Off; functions],
            rises: vec![None; functions],
            looks: 0,
            unproven: 0,
        }
    }

    /// The step's end is where the next one begins.
    pub(super) fn go_on(&mut self) {
        std::mem::swap(&mut self.begin, &mut self.end);
    }
}

impl<Y: Dae> Ida<Y> {
    /// Takes in the event functions at a restart, where the system stands evaluated and `fired` is
    /// still that of the step before. A function that has fired and is watched as before is beyond
    /// its zero; one that has not fired, and rises from zero, is an event.
    pub(super) fn arm(&mut self) {
        for k in 0..self.events.begin.len() {
            let direction = self.solver.system_ref().watches()[k].direction;
            let same = std::mem::replace(&mut self.events.directions[k], direction) == direction;
            let Some(mut course) = self.rising_course(k) else { continue };
            let done = self.fired[k] && same && course.value > 0.0;
            let beyond = course.value > course.noise;
            self.events.passed[k] = done || (beyond && course.rate <= 0.0);
            if !beyond {
                course.value = course.value.min(0.0);
            }
            self.events.begin[k] = course;
        }
    }

    /// Course of a function at the state last evaluated, with the sign that makes it rise to its
    /// event; `None` if it is not watched.
    #[inline(always)]
    fn rising_course(&self, k: usize) -> Option<Course> {
        let system = self.solver.system_ref();
        match system.watches()[k].direction {
            Direction::Off => None,
            Direction::Rising => Some(system.course(k)),
            Direction::Falling => Some(system.course(k).reversed()),
        }
    }

    /// The first event within the latest step, at whose end the system stands evaluated: its time
    /// (s), and in `fired` its functions.
    pub(super) fn find_event(&mut self) -> Result<Option<f64>, Error> {
        let (from, to) = (self.began.time, self.now.time);
        let mut doubtful = false;
        for k in 0..self.events.end.len() {
            self.events.rises[k] = None;
            let Some(course) = self.rising_course(k) else { continue };
            self.events.end[k] = course;
            let [begin, end] = self.ends(k);
            let settled = !self.events.passed[k] && guard::stays_below(begin, end);
            // so near to zero the drift off the constraints may decide
            let settled =
                settled && course.value < -DRIFT * self.options.relative_tolerance * course.grain;
            if !settled {
                self.events.rises[k] = Some(to);
                doubtful = true;
            }
        }
        if !doubtful {
            return Ok(None);
        }
        self.look_at_end(to)?;
        let panels = self.panels(from, to);
        let mut first: Option<f64> = None;
        for k in 0..self.events.end.len() {
            if self.events.rises[k].is_some() {
                let rise = self.rise(k, panels)?;
                self.events.rises[k] = rise;
                first = first.into_iter().chain(rise).reduce(f64::min);
            }
        }
        self.evaluate()?;
        let Some(first) = first else { return Ok(None) };
        let together = first + self.resolution();
        for (fired, rise) in self.fired.iter_mut().zip(&self.events.rises) {
            *fired = rise.is_some_and(|rise| rise <= together);
        }
        Ok(Some(first))
    }

    /// The doubtful functions at the step's end (s), on the constraints.
    fn look_at_end(&mut self, to: f64) -> Result<(), Error> {
        if self.solver.system_ref().multipliers() == 0 {
            return Ok(());
        }
        for k in 0..self.events.end.len() {
            if self.events.rises[k].is_some() {
                self.events.end[k] = self.look(k, to)?.course;
            }
        }
        Ok(())
    }

    /// Width (s) of the bracket in which IDA would leave a root.
    fn resolution(&self) -> f64 {
        let (from, to) = (self.began.time, self.now.time);
        ROUNDINGS_AT_END * f64::EPSILON * (to.abs() + (to - from))
    }

    fn ends(&self, k: usize) -> [Look; 2] {
        let look = |at, courses: &[Course]| Look { at, course: courses[k] };
        [look(self.began.time, &self.events.begin), look(self.now.time, &self.events.end)]
    }

    /// Number of panels into which a step is parted.
    fn panels(&self, from: f64, to: f64) -> u64 {
        let system = self.solver.system_ref();
        let mut rates = vec![0.0; system.turns()];
        let mut fastest = 0.0;
        for at in [&self.began, &self.now] {
            system.turn_rates(at.time, &at.v, &mut rates);
            fastest = rates.iter().fold(fastest, |most: f64, rate| most.max(rate.abs()));
        }
        ((to - from) * fastest / PANEL_TURN).ceil().clamp(1.0, MOST_PANELS) as u64
    }

    /// When function `k` rises through zero first in the step (s).
    fn rise(&mut self, k: usize, panels: u64) -> Result<Option<f64>, Error> {
        let [mut begin, end] = self.ends(k);
        if self.events.passed[k] {
            let Some([_, fallen]) = self.search(k, true, [begin, end], panels)? else {
                return Ok(None);
            };
            self.events.passed[k] = false;
            begin = fallen;
        }
        match self.search(k, false, [begin, end], panels)? {
            Some(bracket) => self.close_in(k, bracket).map(Some),
            None => Ok(None),
        }
    }

    /// A bracket of the first rise of function `k` between two places, or of its first fall;
    /// panel by panel.
    fn search(
        &mut self,
        k: usize,
        falls: bool,
        ends: [Look; 2],
        panels: u64,
    ) -> Result<Option<[Look; 2]>, Error> {
        let turned = |look: Look| match falls {
            true => Look { course: look.course.reversed(), ..look },
            false => look,
        };
        let (start, length) = (ends[0].at, ends[1].at - ends[0].at);
        let mut from = turned(ends[0]);
        for panel in 1..=panels {
            let to = match panel == panels {
                true => turned(ends[1]),
                false => turned(self.look(k, start + length * (panel as f64 / panels as f64))?),
            };
            match guard::first_rise(from, to, |at| self.look(k, at).map(turned))? {
                Found::Nothing => {}
                Found::Unproven => self.events.unproven += 1,
                Found::Rise(low, high) => return Ok(Some([turned(low), turned(high)])),
            }
            from = to;
        }
        Ok(None)
    }

    /// What function `k` is at a time (s) within the step: on the constraints, where samples are
    /// taken, so that none of them sees an event before it happens.
    fn look(&mut self, k: usize, time: f64) -> Result<Look, Error> {
        self.events.looks += 1;
        take(time, self.solver.interpolate(time)?, &mut self.between);
        let (system, at) = (self.solver.system(), &mut self.between);
        let evaluated =
            (system.project(time, &mut at.q, &mut at.v)).and_then(|_| system.evaluate(at.state()));
        evaluated.map_err(|source| Error::System { time, source })?;
        Ok(Look { at: time, course: self.rising_course(k).unwrap_or(Course::NONE) })
    }

    /// The right end (s) of a narrow bracket: there the function has crossed.
    fn close_in(&mut self, k: usize, [mut low, mut high]: [Look; 2]) -> Result<f64, Error> {
        // below the noise a function counts as zero
        let level = low.course.value.max(0.0);
        let width = self.resolution();
        for halving in 0..2 * MOST_HALVINGS {
            if high.at - low.at <= width {
                break;
            }
            let (below, above) = (level - low.course.value, high.course.value - level);
            let share = match halving % 2 == 0 {
                true => (below / (below + above)).clamp(0.001, 0.999),
                false => 0.5,
            };
            let middle = low.at + share * (high.at - low.at);
            if !(low.at < middle && middle < high.at) {
                break;
            }
            let look = self.look(k, middle)?;
            match look.course.value > level {
                true => high = look,
                false => low = look,
            }
        }
        Ok(high.at)
    }
}

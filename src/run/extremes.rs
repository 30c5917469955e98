//! Extremes of forces, torques and accelerations, found while the run goes on.
//!
//! At the end of each step the measures are taken. Where a step leads near a record, the course of
//! the measure over its last stations (a cubic, and what it differs by from the parabola) tells
//! whether a summit inside the step may beat it; then the step is looked into, at the summit of the
//! parabola through the best three places until what is left to gain no longer counts. Where
//! a step is long for the motion that it covers, stations are put inside it first: sketches, which
//! are believed to a hundredth, or looks.
//!
//! Nothing reaches over a restart, where the curves have kinks. A revolution ends at a station of
//! its own, which counts for both.

use super::recorder::{Extremum, Revolution};
use crate::mechanism::{Measure, Measures};
use crate::scalar::bits;
use serde::{Deserialize, Serialize};

/// What the search for an extreme may leave out, of the measure's largest magnitude in its revolution.
pub const LEFT_OUT: f64 = 1e-8;
/// The same of the largest magnitude of all measures of the unit, or of another that a length makes
/// of it: what is rounding beside it.
const ROUNDING: f64 = 1e-12;
/// What a sketch over the phase of [`SKETCHABLE`] may be off by, of the span from the smallest to
/// the largest; over a shorter one less, by the third power.
const SKETCHED: f64 = 1e-2;
/// Phase (rad) of a step up to which a quintic through its ends is a sketch.
pub(super) const SKETCHABLE: f64 = 2.5;
/// A step that is so many times as long as the one before may hide a summit between two places as
/// high as each other, of which the one before tells nothing.
const STRETCHED: f64 = 4.0;
/// Looks that one summit may take.
const MOST_LOOKS: usize = 12;
/// A measure goes on in its direction where it changes over a step by more than this many times
/// what its slope changes by over half of it; more where the step is long for the motion.
const CLEARLY: f64 = 1.25;
/// Fastest harmonic of a motion that is reckoned with in a measure of it: forces grow with higher
/// powers of a penetration, and their magnitudes turn twice in a turn.
const HARMONIC: f64 = 2.0;
/// Stations nearer to each other than this part of the step tell nothing of slopes.
const NEAR: f64 = 2e-2;
/// Stations nearer to each other than this part of the panel are the same.
const SAME: f64 = 1e-6;
/// Stations before the present step that are remembered.
const MEMORY: usize = 3;
/// A revolution that has not begun by more than this part of one has not begun.
const BEGUN: f64 = 1e-9;

/// Measures that are compared at once.
const LANES: usize = 4;

/// The larger of two numbers, whichever if one is none: a single instruction.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, likewise.
#[inline(always)]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Measures, as many at once as are compared.
#[inline(always)]
fn lanes(values: &[f64]) -> std::slice::Iter<'_, [f64; LANES]> {
    values.as_chunks().0.iter()
}

/// How a tracker asks for measures within the last step.
pub(super) trait Look {
    /// What can go wrong.
    type Error;

    /// The measures near a time (s) within the step, true to the run; returns where. `exactly`
    /// asks for the time itself.
    fn look(&mut self, time: f64, exactly: bool, values: &mut [f64]) -> Result<f64, Self::Error>;

    /// The measures at a time (s) within the step, roughly.
    fn sketch(&mut self, time: f64, values: &mut [f64]) -> Result<(), Self::Error>;
}

/// Stations that a step wants inside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Parts {
    /// Parts of the step between them.
    pub count: u32,
    /// Whether sketches will do.
    pub sketched: bool,
    /// Phase (rad) of the fastest motion in the step.
    pub phase: f64,
}

impl Parts {
    /// What sketches may be off by, of the span from the smallest to the largest; `None` where
    /// they show nothing.
    fn doubt(&self) -> Option<f64> {
        self.sketched.then(|| SKETCHED * (self.phase / SKETCHABLE).powi(3))
    }
}

/// All measures at one time.
#[derive(Debug, Clone)]
struct Station {
    /// Time (s).
    time: f64,
    values: Vec<f64>,
    exact: bool,
}

impl Station {
    /// What stands in the place of a station that is being used.
    fn nowhere() -> Self {
        Station { time: f64::NAN, values: Vec::new(), exact: false }
    }
}

/// What is kept of the present revolution at a checkpoint.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Records {
    number: u64,
    #[serde(with = "bits")]
    begin: f64,
    largest: Vec<Extremum>,
    smallest: Vec<Extremum>,
}

impl Records {
    /// Whether they are as many as these measures have.
    pub fn fit(&self, measures: &Measures) -> bool {
        self.largest.len() == measures.len() && self.smallest.len() == measures.signed()
    }
}

/// Keeps the extremes of the present revolution.
#[derive(Debug)]
pub(super) struct Tracker {
    row: Revolution,
    /// Time that a revolution takes (s); infinite without any.
    period: f64,
    /// Where the present revolution ends (s).
    boundary: f64,
    /// Number of the present revolution.
    number: u64,
    /// What a value must pass to beat the record, by place.
    high: Vec<f64>,
    low: Vec<f64>,
    /// From the smallest to the largest, and no less than the largest magnitude.
    spans: Vec<f64>,
    /// Which unit each measure has, and the largest magnitude of each.
    units: Vec<usize>,
    magnitudes: [f64; UNITS],
    /// What makes an angular acceleration of a linear one, and a force of a torque (m).
    length: f64,
    /// The last stations, and room for the next: see [`Tracker::past`].
    ring: [Station; MEMORY + 1],
    /// Where in the ring the newest is.
    newest: usize,
    /// How many stations belong to the smooth stretch that the run is in.
    known: usize,
    /// Looks that others have had into the step.
    looks: Vec<Station>,
    /// Stations of the step, where it is looked into.
    course: Vec<Station>,
    /// What has been seen inside the present panel, by sketches and by looks.
    sketches: Vec<Station>,
    glances: Vec<Station>,
    spare: Vec<Station>,
    finished: Vec<Revolution>,
}

impl Tracker {
    /// A tracker for revolutions of this time (s), or for none, of a mechanism of this length (m).
    pub fn new(measures: Measures, period: Option<f64>, length: f64) -> Self {
        let period = period.unwrap_or(f64::INFINITY);
        let none = Extremum { value: f64::NAN, time: f64::NAN };
        // what is beyond the measures never comes near to anything
        let count = measures.len().next_multiple_of(LANES);
        let station = Station { time: f64::NAN, values: vec![0.0; count], exact: true };
        Tracker {
            row: Revolution {
                begin: 0.0,
                end: 0.0,
                measures,
                largest: vec![none; measures.len()],
                smallest: vec![none; measures.signed()],
            },
            period,
            boundary: period,
            number: 0,
            high: vec![f64::INFINITY; count],
            low: vec![f64::NEG_INFINITY; count],
            spans: vec![0.0; count],
            units: units(&measures),
            magnitudes: [0.0; UNITS],
            length,
            ring: std::array::from_fn(|_| station.clone()),
            newest: 0,
            known: 0,
            looks: Vec::new(),
            course: Vec::new(),
            sketches: Vec::new(),
            glances: Vec::new(),
            spare: Vec::new(),
            finished: Vec::new(),
        }
    }

    /// What is kept of it, where the last step ended.
    pub fn hold(&mut self) -> Records {
        self.take_last();
        let Revolution { begin, largest, smallest, .. } = self.row.clone();
        Records { number: self.number, begin, largest, smallest }
    }

    /// Goes on with what was held; a restart comes next.
    pub fn take_up(&mut self, records: &Records) {
        let Records { number, begin, largest, smallest } = records.clone();
        (self.number, self.boundary) = (number, self.boundary_of(number));
        self.row = Revolution { begin, largest, smallest, ..self.row.clone() };
        // once for the largest magnitudes, once more with them
        for place in (0..self.row.largest.len()).chain(0..self.row.largest.len()) {
            self.raise(place);
        }
    }

    /// A station behind the last step, the newest (0) where it began.
    #[inline]
    fn past(&self, k: usize) -> &Station {
        &self.ring[(self.newest + MEMORY + 1 - k) % (MEMORY + 1)]
    }

    /// The end of the last step.
    #[inline]
    fn end(&self) -> &Station {
        &self.ring[(self.newest + 1) % (MEMORY + 1)]
    }

    /// A restart at a time (s): `measure` fills in what the measures are there.
    pub fn restart(&mut self, time: f64, measure: impl FnOnce(&mut [f64])) {
        if self.known > 0 {
            self.take_last();
        }
        self.spare.append(&mut self.looks);
        self.known = 1;
        let here = &mut self.ring[self.newest];
        here.time = time;
        measure(&mut here.values);
        let values = std::mem::take(&mut self.ring[self.newest].values);
        self.ring[(self.newest + MEMORY) % (MEMORY + 1)].values.copy_from_slice(&values);
        if self.row.largest.first().is_some_and(|first| first.time.is_nan()) {
            self.begin_row(time, &values);
        }
        self.ring[self.newest].values = values;
        self.take_last();
    }

    /// Waits for a restart: what lies between is looked at by nobody.
    pub fn rest(&mut self) {
        self.known = 0;
    }

    /// Takes the end of the last step as a candidate for records.
    fn take_last(&mut self) {
        let values = std::mem::take(&mut self.ring[self.newest].values);
        self.take(self.ring[self.newest].time, &values);
        self.ring[self.newest].values = values;
    }

    /// The last step has ended at a time (s).
    #[inline]
    pub fn arrive(&mut self, time: f64, measure: impl FnOnce(&mut [f64])) {
        let end = &mut self.ring[(self.newest + 1) % (MEMORY + 1)];
        end.time = time;
        measure(&mut end.values);
    }

    /// Somebody has looked into the last step, near a time (s).
    pub fn looked(&mut self, time: f64, measure: impl FnOnce(&mut [f64])) {
        let mut station = self.station(time, true);
        measure(&mut station.values);
        let last = self.looks.last().map(|last| last.time);
        let near = NEAR * (self.end().time - self.past(0).time);
        let before = last.is_some_and(|last| (last - time).abs() < near);
        let replaced = if before { self.looks.pop() } else { None };
        self.spare.extend(replaced);
        self.looks.push(station);
    }

    /// Whether there was a restart to begin from.
    pub fn has_begun(&self) -> bool {
        self.known > 0
    }

    /// Whether the last step led anywhere.
    #[inline]
    pub fn has_moved(&self) -> bool {
        self.end().time > self.past(0).time
    }

    /// Whether the last step can have beaten no record, ended no revolution, where no motion in it
    /// is faster than this pace, squared (rad²/s²).
    #[inline]
    pub fn is_quiet(&self, pace_squared: f64) -> bool {
        self.looks.is_empty() && self.end().time < self.boundary && !self.comes_near(pace_squared)
    }

    /// Whether the stations before the last step tell nothing of what may be hidden in it.
    #[inline]
    fn is_blind(&self) -> bool {
        let [a, b, c] = [self.past(1).time, self.past(0).time, self.end().time];
        self.known == 1 || c - b > STRETCHED * (b - a)
    }

    /// Whether any measure comes so near to a record that a summit beside the last stations may
    /// beat it: it rises above them by less than they differ, as long as steps resolve the motion,
    /// or where that says nothing by what a harmonic of its phase may.
    /// One that clearly goes on in its direction has no summit here, and is a record only where it
    /// turns, or where the run does: of a harmonic of phase φ the parabola through the stations
    /// has the slope at the end wrong by φ² (1 + 1/g) (2 + 1/g) / 12 of what it changes by over half
    /// of the step, where the step is g times as long as the one before.
    #[inline]
    fn comes_near(&self, pace_squared: f64) -> bool {
        let [a, b, c] = [self.past(1), self.past(0), self.end()];
        let step = c.time - b.time;
        let square = HARMONIC * HARMONIC * pace_squared * step * step;
        // after a restart nothing is known of how a measure bends: none is said to go on
        let growth = step / (b.time - a.time);
        let (growth, weight) = match self.known {
            1 => (0.0, f64::INFINITY),
            _ => {
                let shape = (1.0 + 1.0 / growth) * (2.0 + 1.0 / growth) / 12.0;
                (growth, (CLEARLY + square * shape) * growth / (1.0 + growth))
            }
        };
        let bow = if self.is_blind() { 0.125 * square } else { 0.0 };
        let mut least = [0.0; LANES];
        for (((a, b), c), ((high, low), span)) in (lanes(&a.values).zip(lanes(&b.values)))
            .zip(lanes(&c.values))
            .zip(lanes(&self.high).zip(lanes(&self.low)).zip(lanes(&self.spans)))
        {
            for k in 0..LANES {
                let (now, before) = (c[k] - b[k], b[k] - a[k]);
                let bend = weight * ((now - growth * before).abs() + f64::MIN_POSITIVE);
                let reach = larger(now.abs(), before.abs()) + bow * span[k];
                let below = high[k] - larger(c[k], b[k]) - reach;
                let above = smaller(c[k], b[k]) - reach - low[k];
                // not near, or clearly going on
                let quiet = larger(smaller(below, above), now.abs() - bend);
                least[k] = smaller(quiet, least[k]);
            }
        }
        least.iter().any(|least| *least < 0.0)
    }

    /// Makes the end of the last step the begin of the next.
    #[inline]
    pub fn go_on(&mut self) {
        self.newest = (self.newest + 1) % (MEMORY + 1);
        self.known = (self.known + 1).min(MEMORY);
    }

    /// Looks into the last step for what beats the records, and goes on.
    ///
    /// # Errors
    /// What the looks meet.
    pub fn examine<L: Look>(&mut self, mut parts: Parts, look: &mut L) -> Result<(), L::Error> {
        if parts.count == 1 && self.is_blind() {
            parts.count = 2;
        }
        let first = self.gather(parts, look)?;
        for k in first..self.course.len() {
            if self.course[k].exact {
                let station = std::mem::replace(&mut self.course[k], Station::nowhere());
                self.take(station.time, &station.values);
                self.course[k] = station;
            }
            if k == first {
                continue;
            }
            self.search(k, parts.doubt(), look)?;
            if self.course[k].time == self.boundary && k + 1 < self.course.len() {
                let station = self.course[k].clone();
                self.turn_over(station.time, &station.values);
            }
        }
        let mut course = std::mem::take(&mut self.course);
        self.spare.append(&mut course);
        self.course = course;
        self.go_on();
        Ok(())
    }

    /// Puts the stations of the step in the order of time, those before it first; returns the
    /// place of its begin.
    fn gather<L: Look>(&mut self, parts: Parts, look: &mut L) -> Result<usize, L::Error> {
        let (begin, end) = (self.past(0).time, self.end().time);
        let near = NEAR * (end - begin) / f64::from(parts.count);
        let mut inside: Vec<Station> = Vec::new();
        while end - self.boundary > BEGUN * self.period {
            if self.boundary <= begin {
                // the step before has passed it by rounding
                let values = self.past(0).values.clone();
                self.turn_over(self.boundary, &values);
                continue;
            }
            let mut station = self.station(self.boundary, true);
            look.look(self.boundary, true, &mut station.values)?;
            inside.push(station);
            self.boundary += self.period;
        }
        let passed = inside.len();
        self.boundary = self.boundary_of(self.number);
        let mut looks = std::mem::take(&mut self.looks);
        for station in looks.drain(..) {
            let apart = |other: f64| (station.time - other).abs() > near;
            let alone = inside.iter().all(|other| apart(other.time));
            if passed > 0 || (alone && apart(begin) && apart(end)) {
                inside.push(station);
            } else {
                self.take(station.time, &station.values);
                self.spare.push(station);
            }
        }
        self.looks = looks;
        for part in 1..parts.count {
            let time = begin + (end - begin) * (f64::from(part) / f64::from(parts.count));
            if inside.iter().any(|other| (time - other.time).abs() <= near) {
                continue;
            }
            let mut station = self.station(time, !parts.sketched);
            if parts.sketched {
                look.sketch(time, &mut station.values)?;
            } else {
                station.time = look.look(time, false, &mut station.values)?;
            }
            inside.push(station);
        }
        inside.sort_by(|a, b| a.time.total_cmp(&b.time));
        let first = self.known - 1;
        for k in (0..self.known).rev() {
            let mut station = self.station(self.past(k).time, true);
            station.values.copy_from_slice(&self.past(k).values);
            self.course.push(station);
        }
        self.course.extend(inside);
        let mut last = self.station(end, true);
        last.values.copy_from_slice(&self.end().values);
        self.course.push(last);
        Ok(first)
    }

    /// End (s) of a revolution.
    fn boundary_of(&self, number: u64) -> f64 {
        (number + 1) as f64 * self.period
    }

    /// Looks for summits between station `k` of the course and the one before. Sketches may be off
    /// by a part of the span of each measure.
    fn search<L: Look>(
        &mut self,
        k: usize,
        sketches: Option<f64>,
        look: &mut L,
    ) -> Result<(), L::Error> {
        let nodes = nodes_around(k, self.course.len());
        let exact = nodes.list[..nodes.count].iter().all(|node| self.course[*node].exact);
        self.spare.append(&mut self.sketches);
        self.spare.append(&mut self.glances);
        for place in 0..self.row.largest.len() {
            let mut span = [f64::INFINITY, f64::NEG_INFINITY];
            for node in &nodes.list[..nodes.count] {
                let value = self.course[*node].values[place];
                span = [span[0].min(value), span[1].max(value)];
            }
            let sketch = sketches.map(|part| part * self.spans[place]);
            let doubt = if exact { 0.0 } else { sketch.unwrap_or(0.0) };
            let reach = span[1] - span[0] + doubt;
            for sign in [1.0, -1.0] {
                let (top, bar) = match sign > 0.0 {
                    true => (span[1], self.high[place]),
                    false => (-span[0], -self.low[place]),
                };
                if !(top + reach > bar) {
                    continue;
                }
                let panel = self.panel(&nodes, place, sign, doubt);
                if let Some(guess) = panel.summit_above(bar) {
                    self.climb(panel, guess, (place, sign), sketch, look)?;
                }
            }
        }
        Ok(())
    }

    /// The panel between the first two nodes, seen for one measure.
    fn panel(&self, nodes: &Nodes, place: usize, sign: f64, doubt: f64) -> Panel {
        let mut panel = Panel { count: nodes.count, doubt, ..Panel::default() };
        for (at, &node) in nodes.list[..nodes.count].iter().enumerate() {
            let station = &self.course[node];
            panel.times[at] = station.time;
            panel.values[at] = sign * station.values[place];
        }
        panel.ends_exact = nodes.list[..2].iter().all(|node| self.course[*node].exact);
        panel
    }

    /// What a measure must pass to beat its record, seen with a sign.
    fn bar(&self, place: usize, sign: f64) -> f64 {
        if sign > 0.0 { self.high[place] } else { -self.low[place] }
    }

    /// Looks at a summit that may be inside a panel, beginning at a guess (s): at that of the sketch
    /// first, if sketches show it to this accuracy.
    fn climb<L: Look>(
        &mut self,
        panel: Panel,
        guess: f64,
        (place, sign): (usize, f64),
        sketch: Option<f64>,
        look: &mut L,
    ) -> Result<(), L::Error> {
        let width = panel.times[1] - panel.times[0];
        let (mut aim, mut expected) = (guess, panel.at(guess));
        if let Some(doubt) = sketch {
            let sketched = self.sketch(&panel, guess, (place, sign), look)?;
            let Some(summit) = sketched.best else { return Ok(()) };
            let bar = self.bar(place, sign);
            if summit.1 + doubt < bar || self.is_known_below(bar, &panel, &sketched, (place, sign))
            {
                return Ok(());
            }
            (aim, expected) = summit;
        }
        let bar = self.bar(place, sign);
        let known = panel.with(&self.glances, (place, sign), aim);
        if known.is_some_and(|mut known| known.next(width, bar).is_none()) {
            return Ok(());
        }
        let mut bracket = panel.bracket(expected);
        bracket.take(self.look(aim, (place, sign), look)?);
        if sketch.is_some() && !bracket.may_pass(self.bar(place, sign)) {
            return Ok(());
        }
        if !panel.ends_exact {
            bracket.left = self.look(panel.times[0], (place, sign), look)?;
            bracket.right = self.look(panel.times[1], (place, sign), look)?;
        }
        for _ in 1..MOST_LOOKS {
            let Some(next) = bracket.next(width, self.bar(place, sign)) else { break };
            bracket.take(self.look(next, (place, sign), look)?);
        }
        Ok(())
    }

    /// Places about the summit that sketches show in a panel, beginning at a guess (s).
    fn sketch<L: Look>(
        &mut self,
        panel: &Panel,
        guess: f64,
        (place, sign): (usize, f64),
        look: &mut L,
    ) -> Result<Bracket, L::Error> {
        let width = panel.times[1] - panel.times[0];
        let slack = LEFT_OUT * self.spans[place];
        let known = panel.with(&self.sketches, (place, sign), guess);
        let mut bracket = known.unwrap_or_else(|| panel.bracket(panel.at(guess)));
        let mut next = match bracket.best {
            Some(_) => bracket.next(width, bracket.top() + slack),
            None => Some(guess),
        };
        for _ in 0..MOST_LOOKS {
            let Some(aim) = next else { break };
            let same = |sketch: &Station| (sketch.time - aim).abs() <= SAME * width;
            let known = self.sketches.iter().position(same);
            let known = match known {
                Some(known) => known,
                None => {
                    let mut station = self.station(aim, false);
                    look.sketch(aim, &mut station.values)?;
                    self.sketches.push(station);
                    self.sketches.len() - 1
                }
            };
            let Station { time, values, .. } = &self.sketches[known];
            bracket.take((*time, sign * values[place]));
            next = bracket.next(width, bracket.top() + slack);
        }
        Ok(bracket)
    }

    /// Whether a look that others have had beside a sketched summit tells that it is below a bar, as a
    /// look of its own would.
    fn is_known_below(
        &self,
        bar: f64,
        panel: &Panel,
        sketched: &Bracket,
        (place, sign): (usize, f64),
    ) -> bool {
        let Some(summit) = sketched.best else { return false };
        let reach = NEAR * (panel.times[1] - panel.times[0]);
        let beside = |glance: &&Station| (glance.time - summit.0).abs() <= reach;
        self.glances.iter().find(beside).is_some_and(|glance| {
            let drawn = parabola(sketched.left, summit, sketched.right, glance.time);
            let mut places = panel.bracket(drawn);
            places.take((glance.time, sign * glance.values[place]));
            !places.may_pass(bar - (summit.1 - drawn).abs())
        })
    }

    /// Looks at a time (s), takes what is there; where (s) it was and what a measure is there,
    /// seen with a sign.
    fn look<L: Look>(
        &mut self,
        time: f64,
        (place, sign): (usize, f64),
        look: &mut L,
    ) -> Result<(f64, f64), L::Error> {
        if let Some(known) = self.glances.iter().find(|glance| glance.time == time) {
            return Ok((time, sign * known.values[place]));
        }
        let mut station = self.station(time, true);
        station.time = look.look(time, false, &mut station.values)?;
        self.take(station.time, &station.values);
        let seen = (station.time, sign * station.values[place]);
        self.glances.push(station);
        Ok(seen)
    }

    /// Takes all measures at a time (s) as candidates for records.
    pub fn take(&mut self, time: f64, values: &[f64]) {
        let signed = self.row.smallest.len();
        for (place, &value) in values[..self.row.largest.len()].iter().enumerate() {
            if value > self.row.largest[place].value {
                self.row.largest[place] = Extremum { value, time };
                self.raise(place);
            }
            if place < signed && value < self.row.smallest[place].value {
                self.row.smallest[place] = Extremum { value, time };
                self.raise(place);
            }
        }
    }

    /// What is rounding of a measure.
    fn rounding(&self, place: usize) -> f64 {
        let unit = self.units[place];
        let [linear, angular, force, torque] = self.magnitudes;
        let by_length = [angular, linear, torque, force][unit];
        let factor = if unit == 0 || unit == 3 { self.length } else { 1.0 / self.length };
        ROUNDING * self.magnitudes[unit].max(factor * by_length)
    }

    /// What counts as beating the records of a measure.
    fn raise(&mut self, place: usize) {
        let largest = self.row.largest[place].value;
        let smallest = self.row.smallest.get(place).map_or(0.0, |smallest| smallest.value);
        let magnitude = largest.abs().max(smallest.abs());
        let unit = self.units[place];
        self.magnitudes[unit] = self.magnitudes[unit].max(magnitude);
        let slack = LEFT_OUT * magnitude + self.rounding(place);
        self.high[place] = largest + slack;
        if place < self.row.smallest.len() {
            self.low[place] = smallest - slack;
        }
        self.spans[place] = (largest - smallest).max(magnitude);
    }

    /// Begins a row with the measures at one time (s).
    fn begin_row(&mut self, time: f64, values: &[f64]) {
        self.row.begin = time;
        self.magnitudes = [0.0; UNITS];
        let count = self.row.largest.len();
        for (place, &value) in values[..count].iter().enumerate() {
            self.row.largest[place] = Extremum { value, time };
            if let Some(smallest) = self.row.smallest.get_mut(place) {
                *smallest = Extremum { value, time };
            }
        }
        for place in 0..count {
            self.raise(place);
        }
    }

    /// Ends the present revolution at a time (s), and begins the next there.
    fn turn_over(&mut self, time: f64, values: &[f64]) {
        self.row.end = time;
        self.finished.push(self.row.clone());
        self.number += 1;
        self.boundary = self.boundary_of(self.number);
        self.begin_row(time, values);
    }

    /// Revolutions that are over.
    pub fn finished(&mut self) -> impl Iterator<Item = Revolution> + '_ {
        self.finished.drain(..)
    }

    /// The revolution that the run ended in, at a time (s); `None` if it had none.
    pub fn last(mut self, end: f64) -> Option<Revolution> {
        self.take_last();
        self.row.end = end;
        let begun = self.row.largest.first().is_some_and(|first| !first.time.is_nan());
        begun.then_some(self.row)
    }

    /// A station to be filled in.
    fn station(&mut self, time: f64, exact: bool) -> Station {
        let count = self.high.len();
        let spare = self.spare.pop();
        let values = spare.map_or_else(|| vec![0.0; count], |station| station.values);
        Station { time, values, exact }
    }
}

/// Units of measures: of linear and angular accelerations, of forces, of torques.
const UNITS: usize = 4;

/// The unit of each measure.
fn units(measures: &Measures) -> Vec<usize> {
    use Measure as M;
    let mut units = vec![0; measures.len()];
    for (measure, unit) in [
        (M::AccelerationX, 0),
        (M::AccelerationY, 0),
        (M::AngularAcceleration, 1),
        (M::NormalForce, 2),
        (M::TangentialForce, 2),
        (M::JointForce, 2),
        (M::DriveTorque, 3),
    ] {
        measures.places(measure).for_each(|place| units[place] = unit);
    }
    units
}

/// Stations of a course about a panel, the ends of the panel first.
#[derive(Debug, Clone, Copy)]
struct Nodes {
    list: [usize; 4],
    count: usize,
}

/// The ends of the panel that ends at station `k`, and the next stations: one on each side, or two
/// before it.
fn nodes_around(k: usize, stations: usize) -> Nodes {
    let mut nodes = Nodes { list: [k - 1, k, 0, 0], count: 2 };
    let before = [k.checked_sub(2), Some(k + 1).filter(|next| *next < stations), k.checked_sub(3)];
    for node in before.into_iter().flatten().take(2) {
        nodes.list[nodes.count] = node;
        nodes.count += 1;
    }
    nodes
}

/// A measure between two stations, and at the stations beside them.
#[derive(Debug, Clone, Copy, Default)]
struct Panel {
    /// Times (s): the ends of the panel first.
    times: [f64; 4],
    values: [f64; 4],
    count: usize,
    ends_exact: bool,
    /// What the values may be off by.
    doubt: f64,
}

impl Panel {
    /// Where (s) a summit may rise above a bar inside the panel, if it may.
    fn summit_above(&self, bar: f64) -> Option<f64> {
        let Panel { times: [left, right, ..], values: [a, b, ..], .. } = *self;
        let width = right - left;
        let [mut rising, mut falling] = self.slopes();
        let middle = [rising, falling];
        let doubt = self.slope_doubt() + 2.0 * self.doubt / width;
        rising += doubt;
        falling -= doubt;
        if !(rising > 0.0 && falling < 0.0) {
            return None;
        }
        // tangents at the ends meet above what a parabola has between them
        let share = rising / (rising - falling);
        let height = a.max(b) + 0.5 * (rising * share).min(-falling * (1.0 - share)) * width;
        if !(height + self.doubt > bar) {
            return None;
        }
        let share = match middle {
            [rising, falling] if rising > 0.0 && falling < 0.0 => {
                // of the cubic that has these slopes and values at the ends
                let bend = 3.0 * (rising + falling) - 6.0 * (b - a) / width;
                let linear = rising - falling + bend;
                let root = (linear * linear - 4.0 * bend * rising).max(0.0).sqrt();
                (2.0 * rising / (linear + root)).clamp(1e-3, 1.0 - 1e-3)
            }
            // only by what the slopes may be off by, and so near an end
            [rising, _] if rising <= 0.0 => 0.05,
            _ => 0.95,
        };
        Some(left + share * width)
    }

    /// The places that a search in it begins with, where this is expected.
    fn bracket(&self, expected: f64) -> Bracket {
        Bracket {
            left: (self.times[0], self.values[0]),
            right: (self.times[1], self.values[1]),
            best: None,
            expected,
            missed: 0.0,
        }
    }

    /// The places about the highest of the stations inside, where it has lower ones on both sides of it
    /// and of a time (s): what others have seen is not looked at again.
    fn with(
        &self,
        stations: &[Station],
        (place, sign): (usize, f64),
        about: f64,
    ) -> Option<Bracket> {
        let [left, right] = [self.times[0], self.times[1]];
        let inside = stations.iter().filter(|station| station.time > left && station.time < right);
        let mut seen: Vec<(f64, f64)> =
            inside.map(|station| (station.time, sign * station.values[place])).collect();
        if seen.is_empty() {
            return None;
        }
        let are_exact = stations[0].exact;
        if self.ends_exact || !are_exact {
            seen.extend([(left, self.values[0]), (right, self.values[1])]);
        }
        seen.sort_by(|a, b| a.0.total_cmp(&b.0));
        // differences over less than that are rounding
        seen.dedup_by(|a, b| a.0 - b.0 <= SAME * (right - left));
        let best = (0..seen.len()).max_by(|a, b| seen[*a].1.total_cmp(&seen[*b].1))?;
        let (before, after) = (seen.get(best.checked_sub(1)?)?, seen.get(best + 1)?);
        let (before, best_place, after) = (*before, seen[best], *after);
        if !(before.0 < about && about < after.0) {
            return None;
        }
        let beyond = best.checked_sub(2).and_then(|far| seen.get(far)).or(seen.get(best + 2));
        let expected = match beyond {
            Some(beyond) => parabola(before, after, *beyond, best_place.0),
            None => self.at(best_place.0),
        };
        let missed = (best_place.1 - expected).abs();
        Some(Bracket { left: before, right: after, best: Some(best_place), expected, missed })
    }

    /// Newton's divided differences.
    fn differences(&self) -> [f64; 4] {
        let mut differences = self.values;
        for order in 1..self.count {
            for k in (order..self.count).rev() {
                differences[k] =
                    (differences[k] - differences[k - 1]) / (self.times[k] - self.times[k - order]);
            }
        }
        differences
    }

    /// Value at a time (s), by the polynomial through all stations.
    fn at(&self, time: f64) -> f64 {
        let d = self.differences();
        let terms = d[..self.count].iter().zip(self.times).rev();
        terms.fold(0.0, |sum, (d, from)| sum * (time - from) + d)
    }

    /// Slopes (per s) at the ends of the panel.
    fn slopes(&self) -> [f64; 2] {
        let d = self.differences();
        let [left, right, third, _] = self.times;
        let width = right - left;
        let bend = if self.count > 2 { d[2] } else { 0.0 };
        let twist = if self.count > 3 { d[3] } else { 0.0 };
        [
            d[1] - width * (bend + twist * (left - third)),
            d[1] + width * (bend + twist * (right - third)),
        ]
    }

    /// What the slopes may be off by (per s): the last term of the polynomial.
    fn slope_doubt(&self) -> f64 {
        let d = self.differences();
        let [left, right, third, _] = self.times;
        let width = right - left;
        match self.count {
            2 => 2.0 * d[1].abs(),
            3 => width * d[2].abs(),
            _ => width * d[3].abs() * (left - third).abs().max((right - third).abs()),
        }
    }
}

/// Places about a summit: time (s) and value.
#[derive(Debug, Clone, Copy)]
struct Bracket {
    left: (f64, f64),
    right: (f64, f64),
    best: Option<(f64, f64)>,
    /// What the next place is expected to have.
    expected: f64,
    /// What the last place was off by from that.
    missed: f64,
}

impl Bracket {
    /// Takes a place inside.
    fn take(&mut self, place: (f64, f64)) {
        self.missed = (place.1 - self.expected).abs();
        let Some(best) = self.best else {
            self.best = Some(place);
            return;
        };
        let (low, high) = if place.1 > best.1 { (best, place) } else { (place, best) };
        if low.0 < high.0 {
            self.left = low
        } else {
            self.right = low
        }
        self.best = Some(high);
    }

    /// The highest place.
    fn top(&self) -> f64 {
        let best = self.best.map_or(f64::NEG_INFINITY, |best| best.1);
        best.max(self.left.1).max(self.right.1)
    }

    /// Whether the summit may pass a bar, where the one place inside is that of a sketch's summit:
    /// what a sketch that misses so much in height misses beside it is of the second order.
    fn may_pass(&self, bar: f64) -> bool {
        let top = self.top();
        top + self.missed * self.missed / (top - self.left.1.min(self.right.1)) > bar
    }

    /// Where to look next: at the summit of the parabola through the three places, be it beside an
    /// end that is higher yet. `None` where nothing is left to gain above the bar. `width` (s) is
    /// that of the panel.
    fn next(&mut self, width: f64, bar: f64) -> Option<f64> {
        let Bracket { left, right, best, missed, .. } = *self;
        let best = best?;
        if right.0 - left.0 < SAME * width {
            return None;
        }
        let (aim, height) = vertex(left, best, right)?;
        if !(aim > left.0 && aim < right.0) {
            return None;
        }
        // that a parabola came so near to the last place tells how near it comes to the summit:
        // what it misses in height is of the second order
        let doubt = missed * missed / (height - left.1.min(right.1));
        if !(height + doubt > bar) {
            return None;
        }
        // no two places so near to each other that their difference is rounding
        let near = 1e-3 * (right.0 - left.0);
        let towards = if right.0 - best.0 > best.0 - left.0 { near } else { -near };
        let aim = if (aim - best.0).abs() < near { best.0 + towards } else { aim };
        let aim = aim.clamp(left.0 + near, right.0 - near);
        self.expected = parabola(left, best, right, aim);
        Some(aim).filter(|aim| *aim > left.0 && *aim < right.0)
    }
}

/// Newton's form of the parabola through three places: slope (per s) at the second, and half the
/// change of slopes (per s²).
fn shape(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> (f64, f64) {
    let slope = |p: (f64, f64), q: (f64, f64)| (q.1 - p.1) / (q.0 - p.0);
    let bend = (slope(b, c) - slope(a, b)) / (c.0 - a.0);
    (slope(a, b) + bend * (b.0 - a.0), bend)
}

/// Summit of the parabola through three places; `None` where it has none.
fn vertex(a: (f64, f64), b: (f64, f64), c: (f64, f64)) -> Option<(f64, f64)> {
    let (slope, bend) = shape(a, b, c);
    if !(bend < 0.0) {
        return None;
    }
    let shift = -slope / (2.0 * bend);
    Some((b.0 + shift, b.1 + 0.5 * slope * shift))
}

/// Value at a time (s) of the parabola through three places.
fn parabola(a: (f64, f64), b: (f64, f64), c: (f64, f64), time: f64) -> f64 {
    let (slope, bend) = shape(a, b, c);
    let shift = time - b.0;
    b.1 + shift * (slope + bend * shift)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;
    use std::f64::consts::{PI, TAU};

    /// A curve that is known everywhere, how often it was looked at, and what sketches are off by.
    struct Curve<F>(F, usize, f64);

    impl<F: Fn(f64) -> f64> Look for Curve<F> {
        type Error = Infallible;

        fn look(&mut self, time: f64, _: bool, values: &mut [f64]) -> Result<f64, Infallible> {
            self.1 += 1;
            values[0] = (self.0)(time);
            Ok(time)
        }

        fn sketch(&mut self, time: f64, values: &mut [f64]) -> Result<(), Infallible> {
            values[0] = (self.0)(time) * (1.0 + self.2 * (1e3 * time).sin());
            Ok(())
        }
    }

    /// Follows the torque of a drive, which is a curve, over these times; the extremes by
    /// revolution, and the number of looks.
    fn follow(
        curve: impl Fn(f64) -> f64,
        times: &[f64],
        period: Option<f64>,
        parts: Parts,
    ) -> (Vec<Revolution>, usize) {
        follow_at(0.0, curve, times, period, parts)
    }

    /// The same of a motion whose fastest pace (rad/s) is known.
    fn follow_at(
        pace: f64,
        curve: impl Fn(f64) -> f64,
        times: &[f64],
        period: Option<f64>,
        parts: Parts,
    ) -> (Vec<Revolution>, usize) {
        let measures = Measures { drives: 1, ..Measures::default() };
        let mut tracker = Tracker::new(measures, period, 1.0);
        tracker.restart(times[0], |values| values[0] = curve(times[0]));
        let wiggle = if pace > 0.0 { 0.0 } else { 1e-3 };
        let mut look = Curve(&curve, 0, wiggle);
        let mut rows = Vec::new();
        for &time in &times[1..] {
            tracker.arrive(time, |values| values[0] = curve(time));
            if parts.count == 1 && tracker.is_quiet(pace * pace) {
                tracker.go_on();
            } else {
                let Ok(()) = tracker.examine(parts, &mut look);
                rows.extend(tracker.finished());
            }
        }
        rows.extend(tracker.last(times[times.len() - 1]));
        (rows, look.1)
    }

    const WHOLE: Parts = Parts { count: 1, sketched: false, phase: 0.0 };

    /// Steps of this length from 0 to an end, the first of them tiny as after a restart.
    fn steps(length: f64, end: f64) -> Vec<f64> {
        let mut times = vec![0.0];
        let mut step = 1e-3 * length;
        while times[times.len() - 1] < end {
            times.push((times[times.len() - 1] + step).min(end));
            step = (2.0 * step).min(length);
        }
        times
    }

    #[test]
    fn the_summits_of_a_wave_are_found_with_few_looks() {
        let wave = |t: f64| 3.0 * (t - 1.0).sin() + 1.0;
        for length in [0.02, 0.1, 0.4] {
            let (rows, looks) = follow(wave, &steps(length, 8.0), None, WHOLE);
            let [row] = &rows[..] else { panic!("{} rows", rows.len()) };
            for (found, value) in [(row.largest[0], 4.0), (row.smallest[0], -2.0)] {
                let off = (found.value - value).abs();
                assert!(off < 4.0 * LEFT_OUT, "{length}: {found:?} is off by {off:e}");
                assert_eq!(wave(found.time), found.value);
            }
            assert!(looks < 30, "{length}: {looks} looks");
        }
    }

    #[test]
    fn a_measure_that_rises_all_the_time_is_looked_at_only_after_a_restart() {
        let (rows, looks) = follow(|t| t.exp(), &steps(0.05, 2.0), None, WHOLE);
        assert_eq!(rows[0].largest[0], Extremum { value: 2_f64.exp(), time: 2.0 });
        assert_eq!(rows[0].smallest[0], Extremum { value: 1.0, time: 0.0 });
        assert!(looks <= 2, "{looks} looks");
    }

    #[test]
    fn revolutions_share_the_moment_between_them() {
        let times = steps(0.3, 3.0 * TAU + 1.0);
        let (rows, _) = follow(|t| t + 3.0 * t.cos(), &times, Some(TAU), WHOLE);
        assert_eq!(rows.len(), 4);
        for (k, pair) in rows.windows(2).enumerate() {
            let boundary = (k + 1) as f64 * TAU;
            assert_eq!((pair[0].end, pair[1].begin), (boundary, boundary));
            let last = Extremum { value: boundary + 3.0, time: boundary };
            assert_eq!(pair[0].largest[0], last);
            assert!(pair[1].largest[0].value > last.value);
        }
        assert_eq!(rows[3].end, 3.0 * TAU + 1.0);
    }

    #[test]
    fn a_run_that_ends_with_a_revolution_begins_no_other() {
        let times = steps(0.3, 2.0 * TAU);
        let (rows, _) = follow(f64::sin, &times, Some(TAU), WHOLE);
        assert_eq!(rows.len(), 2);
        let almost = Some(TAU * (1.0 - 1e-12));
        assert_eq!(follow(f64::sin, &times, almost, WHOLE).0.len(), 2);
    }

    #[test]
    fn a_step_over_many_turns_ends_each_of_them() {
        let parts = Parts { count: 400, sketched: false, phase: 200.0 };
        let (rows, _) = follow(|t| (5.0 * t).sin(), &[0.0, 10.5 * TAU], Some(TAU), parts);
        assert_eq!(rows.len(), 11);
        for row in &rows {
            assert!((row.largest[0].value - 1.0).abs() < 2.0 * LEFT_OUT, "{row:?}");
            assert!((row.smallest[0].value + 1.0).abs() < 2.0 * LEFT_OUT, "{row:?}");
        }
    }

    #[test]
    fn a_bump_inside_a_step_is_found_from_a_sketch() {
        let bump = |t: f64| (PI * t).sin().powi(3);
        let parts = Parts { count: 5, sketched: true, phase: 2.5 };
        let (rows, _) = follow(bump, &[0.0, 1.0], None, parts);
        assert!((rows[0].largest[0].value - 1.0).abs() < 2.0 * LEFT_OUT, "{:?}", rows[0]);
    }

    /// Sketches of a short step show a curve as it is.
    const SHORT: Parts = Parts { count: 1, sketched: true, phase: 0.5 };

    #[test]
    fn a_wave_that_turns_just_before_the_end_of_a_long_step_is_seen_to_turn() {
        let wave = |t: f64| (t - 1.0).cos() + 0.1 * (2.0 * (t - 1.0)).cos();
        for k in 0..200 {
            // the step that ends a little behind the summit is half a radian long
            let last = 1.0 + 0.0025 * f64::from(k);
            for before in [0.15, 0.3, 0.45] {
                let times =
                    [last - 1.0 - before, last - 0.5 - before, last - 0.5, last, last + 0.5];
                let (rows, _) = follow_at(1.0, wave, &times, None, SHORT);
                let off = 1.1 - rows[0].largest[0].value;
                assert!(off < 2.0 * LEFT_OUT, "{last} {before}: {off:e}");
            }
        }
    }

    #[test]
    fn a_summit_between_two_places_of_one_height_is_seen_right_after_a_restart() {
        let wave = |t: f64| 3.0 * t.cos() - 1.0;
        for half in [0.02, 0.1, 0.2, 0.25] {
            for times in [vec![-half, half], vec![-half - 1e-3, -half, half]] {
                let (rows, _) = follow_at(1.0, wave, &times, None, SHORT);
                let off = 2.0 - rows[0].largest[0].value;
                assert!(off < 4.0 * LEFT_OUT, "{times:?}: {off:e}");
            }
        }
    }

    #[test]
    fn a_parabola_that_stands_on_its_summit_by_chance_is_not_believed() {
        // no parabola through the ends of a panel and a place beside the summit tells of it
        let curve = |t: f64| t * t * t - 3.0 * t - 0.3 * t * t;
        let summit = (0.6 - (0.36_f64 + 36.0).sqrt()) / 6.0;
        for k in 0..500 {
            let shift = 1e-3 * f64::from(k);
            let times = [-2.4 + shift, -1.8 + shift, -1.2 + shift, -0.6 + shift, shift];
            let (rows, _) = follow(curve, &times, None, WHOLE);
            let off = curve(summit) - rows[0].largest[0].value;
            assert!(off < 8.0 * LEFT_OUT, "{shift}: {off:e}");
        }
    }

    #[test]
    fn rounding_beside_a_large_measure_is_left_alone() {
        // the first body shakes, the second does so by rounding
        let measures = Measures { bodies: 1, ..Measures::default() };
        let mut tracker = Tracker::new(measures, None, 1.0);
        tracker.restart(0.0, |values| values[..3].copy_from_slice(&[1e6, 1e-9, 0.0]));
        for k in 1..1000 {
            let noise = 1e-10 * f64::from(k * 7919 % 1000);
            tracker.arrive(f64::from(k), |values| values[..3].copy_from_slice(&[1e6, noise, 0.0]));
            assert!(tracker.is_quiet(0.0), "{noise}");
            tracker.go_on();
        }
    }

    #[test]
    fn the_slopes_of_a_cubic_are_exact() {
        let cubic = |t: f64| t * (1.0 - t * (2.0 - t));
        let slope = |t: f64| 1.0 - t * (4.0 - 3.0 * t);
        let times = [0.3, 0.5, 0.1, 0.8];
        let panel = Panel { times, values: times.map(cubic), count: 4, ..Panel::default() };
        let found = panel.slopes();
        for (found, time) in found.into_iter().zip(times) {
            assert!((found - slope(time)).abs() < 1e-14, "{found} at {time}");
        }
    }
}

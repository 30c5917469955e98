//! What a study is: its file, read and checked.

use super::Error;
use super::attractor::AttractorPlan;
use super::ensemble::{self, EnsemblePlan};
use super::sampling::{self, Method, Spread};
use crate::case::{self, Case, Changes, Override, Template, unit_of};
use serde::Deserialize;
use serde_spanned::Spanned;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Runs that a study may have.
const MOST_RUNS: f64 = 1e7;
/// Variables that may be sampled.
const MOST_SAMPLED: usize = 1000;
/// Copies that an ensemble has at least.
const FEWEST_COPIES: u64 = 10;
/// Disturbance of a start that a case takes.
const WIDEST: f64 = 0.1;
/// Longest period of a motion that is looked for (revolutions).
const LONGEST_PERIOD: u64 = 1000;
/// Largest study file that is read (bytes), as of case files.
const LARGEST: u64 = 1 << 20;

/// A study, checked as far as it can be without its case being run.
#[derive(Debug)]
pub struct Study {
    /// Where it was written.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Title; may be empty.
    pub title: String,
    /// The case that it is about.
    pub template: Template,
    /// What varies, the slowest first.
    pub variables: Vec<Variable>,
    /// What is kept.
    pub keep: Keep,
    /// The ensemble that each run is made as, if that is asked.
    pub ensemble: Option<EnsemblePlan>,
    /// Number of runs.
    pub runs: u64,
    set: Vec<Override>,
    /// How many points the sampled variables have together, 1 without any.
    samples: u64,
}

/// Something that varies.
#[derive(Debug, Clone)]
pub struct Variable {
    /// Its name, which is that of its column.
    pub name: String,
    /// Its unit; `1` where there is none.
    pub unit: String,
    /// Whether values between two others mean something.
    pub is_number: bool,
    /// Whether its values are spread evenly by their logarithms.
    pub is_log: bool,
    keys: Vec<String>,
    values: Vec<Literal>,
    sampled: bool,
}

/// A value, as TOML has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Literal {
    /// The TOML.
    pub text: String,
    /// The same as a number, if it is one.
    pub number: Option<f64>,
}

/// What is kept of each run.
#[derive(Debug, Clone, PartialEq)]
pub struct Keep {
    /// Paths of numbers of the summary of a run; none: a choice of them.
    pub runs: Option<Vec<String>>,
    /// The same of each revolution.
    pub revolutions: Option<Vec<String>>,
    /// Whole revolutions at the begin of each run that are left out of all that is kept.
    pub discard: u64,
    /// How many Lyapunov exponents are sought; none if zero.
    pub exponents: usize,
    /// When a motion counts as one that repeats itself, if that is asked.
    pub attractor: Option<AttractorPlan>,
    /// Whether each run says how far it is true.
    pub horizon: bool,
    /// Whether result files are kept.
    pub files: bool,
    /// Section points.
    pub section: Option<SectionPlan>,
}

/// When section points are taken, and what of.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionPlan {
    /// The drive whose angle counts; the first if left out.
    pub drive: Option<String>,
    /// Its angle (rad).
    pub angle: f64,
    /// Names of columns; none: the state.
    pub columns: Option<Vec<String>>,
}

/// A study file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    case: Spanned<String>,
    #[serde(default)]
    title: String,
    #[serde(default)]
    set: Vec<Spanned<String>>,
    #[serde(default)]
    vary: Vec<Spanned<WrittenVariable>>,
    samples: Option<Spanned<WrittenSamples>>,
    #[serde(default)]
    span: WrittenSpan,
    #[serde(default)]
    keep: WrittenKeep,
    section: Option<WrittenSection>,
    attractor: Option<Spanned<WrittenAttractor>>,
    ensemble: Option<Spanned<WrittenEnsemble>>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenVariable {
    key: Option<String>,
    keys: Option<Vec<String>>,
    name: Option<String>,
    unit: Option<String>,
    values: Option<Vec<WrittenValue>>,
    from: Option<f64>,
    to: Option<f64>,
    count: Option<u64>,
    #[serde(default)]
    spacing: Spacing,
    uniform: Option<[f64; 2]>,
    log_uniform: Option<[f64; 2]>,
    normal: Option<[f64; 2]>,
}

#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum WrittenValue {
    Switch(bool),
    Whole(i64),
    Real(f64),
    Text(String),
}

#[derive(Debug, Default, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Spacing {
    #[default]
    Linear,
    Log,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenSamples {
    method: Method,
    count: u64,
    #[serde(default)]
    seed: u64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenSpan {
    revolutions: Option<Spanned<f64>>,
    #[serde(default)]
    discard: u64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenKeep {
    runs: Option<Vec<String>>,
    revolutions: Option<Vec<String>>,
    #[serde(default)]
    horizon: bool,
    #[serde(default)]
    exponents: usize,
    #[serde(default)]
    files: bool,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenEnsemble {
    copies: u64,
    spread: f64,
    long: u64,
    #[serde(default)]
    seed: u64,
}

#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct WrittenAttractor {
    tolerance: f64,
    longest: u64,
}

impl Default for WrittenAttractor {
    fn default() -> Self {
        WrittenAttractor { tolerance: 1e-3, longest: 8 }
    }
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenSection {
    drive: Option<String>,
    #[serde(default)]
    angle: f64,
    columns: Option<Vec<String>>,
}

impl Study {
    /// Reads a study file.
    ///
    /// # Errors
    /// The file cannot be read or describes no study, or its case file cannot be read.
    pub fn read(path: &Path) -> Result<Study, Error> {
        let unreadable = |source| Error::Unreadable { path: path.to_owned(), source };
        let length = std::fs::metadata(path).map_err(unreadable)?.len();
        if length > LARGEST {
            return Err(Error::TooLarge { path: path.to_owned(), limit: LARGEST });
        }
        let text = std::fs::read_to_string(path).map_err(unreadable)?;
        Study::from_text(path, &text)
    }

    /// Reads the text of a study; its case is sought beside `path`, and errors tell that.
    ///
    /// # Errors
    /// The text describes no study, or its case file cannot be read.
    pub fn from_text(path: &Path, text: &str) -> Result<Study, Error> {
        let beside = path.parent().unwrap_or(Path::new(""));
        Study::of(path, text, |case| Template::read(&beside.join(case)))
    }

    /// The study that tables tell of, by its text and that of its case.
    pub(super) fn recorded(path: &Path, text: &str, case: &str) -> Result<Study, Error> {
        Study::of(path, text, |path| Template::new(Path::new(path), case))
    }

    fn of(
        path: &Path,
        text: &str,
        template: impl FnOnce(&str) -> Result<Template, case::Error>,
    ) -> Result<Study, Error> {
        let reader = Reader { path, text };
        let written: Written = toml_edit::de::from_str(text).map_err(|error| {
            let message = error.to_string().trim_end().to_owned();
            let hint = match text.contains("[bodies") {
                true => "; a case needs --vary",
                false => "",
            };
            Error::Syntax { path: path.to_owned(), message, hint }
        })?;
        let template = template(written.case.as_ref()).map_err(Error::Case)?;
        let mut set = Vec::new();
        for change in &written.set {
            let change: Result<Override, _> = change.as_ref().parse();
            set.push(
                change
                    .map_err(|error| reader.wrong(&written.set[set.len()].span(), "set", error))?,
            );
        }
        if let Some(revolutions) = &written.span.revolutions {
            let count = *revolutions.as_ref();
            if !(count > 0.0 && count.is_finite()) {
                let message = format!("must be positive, is {count}");
                return Err(reader.wrong(&revolutions.span(), "span.revolutions", message));
            }
            let change = format!("run.revolutions={count:?}").parse();
            set.push(
                change.map_err(|error| {
                    reader.wrong(&revolutions.span(), "span.revolutions", error)
                })?,
            );
        }
        let mut variables = Vec::new();
        let mut spreads = Vec::new();
        for (k, variable) in written.vary.iter().enumerate() {
            let key = format!("vary[{k}]");
            let read = Variable::read(variable.as_ref());
            let (variable, spread) =
                read.map_err(|message| reader.wrong(&variable.span(), &key, message))?;
            spreads.extend(spread.map(|spread| (k, spread)));
            variables.push(variable);
        }
        let mut samples = 1;
        if spreads.len() > MOST_SAMPLED {
            let message =
                format!("{} variables are sampled; at most {MOST_SAMPLED} can be", spreads.len());
            return Err(reader.wrong(&(0..0), "vary", message));
        }
        match (&written.samples, spreads.is_empty()) {
            (Some(plan), false) => {
                let WrittenSamples { method, count, seed } = *plan.as_ref();
                if !(1..=MOST_RUNS as u64).contains(&count) {
                    let message = format!("must be from 1 to {MOST_RUNS:e}, is {count}");
                    return Err(reader.wrong(&plan.span(), "samples.count", message));
                }
                let drawn = sampling::draw(method, count, spreads.len(), seed);
                for ((k, spread), points) in spreads.into_iter().zip(drawn) {
                    let values = points.into_iter().map(|point| Literal::from(spread.at(point)));
                    variables[k].values = values.collect();
                }
                samples = count;
            }
            (Some(plan), true) => {
                let message = "nothing is sampled: no variable has uniform, log_uniform or normal";
                return Err(reader.wrong(&plan.span(), "samples", message));
            }
            (None, false) => {
                let message = "a sampled variable needs [samples] with method, count and seed";
                let (k, _) = spreads[0];
                return Err(reader.wrong(&written.vary[k].span(), &format!("vary[{k}]"), message));
            }
            (None, true) => {}
        }
        let ensemble = written.ensemble.as_ref().map(|written_as| {
            let WrittenEnsemble { copies, spread, long, seed } = *written_as.as_ref();
            let wrong = |key: &str, message: String| reader.wrong(&written_as.span(), key, message);
            let revolutions = written.span.revolutions.as_ref().map(|count| *count.as_ref());
            let Some(revolutions) = revolutions else {
                return Err(wrong("ensemble", "needs span.revolutions".to_owned()));
            };
            if written.samples.is_some() {
                let message = "copies are the samples: an ensemble goes with a grid".to_owned();
                return Err(wrong("ensemble", message));
            }
            if !(FEWEST_COPIES..=MOST_RUNS as u64).contains(&copies) {
                let message = format!("must be from {FEWEST_COPIES} to {MOST_RUNS:e}, is {copies}");
                return Err(wrong("ensemble.copies", message));
            }
            if !(spread > 0.0 && spread <= WIDEST) {
                let message = format!("must be positive and {WIDEST} at most, is {spread}");
                return Err(wrong("ensemble.spread", message));
            }
            if !(long as f64 > revolutions) {
                let message = format!("must be more than span.revolutions, is {long}");
                return Err(wrong("ensemble.long", message));
            }
            Ok(EnsemblePlan { copies, spread, seed, long })
        });
        let ensemble = ensemble.transpose()?;
        if let Some(plan) = &ensemble {
            variables.push(Variable::of_copies(plan));
            samples = plan.copies + 1;
        }
        for k in 1..variables.len() {
            let earlier = variables[..k].iter().find(|other| other.overlaps(&variables[k]));
            if let Some(earlier) = earlier {
                let message = format!("varies what {:?} varies already", earlier.name);
                // that of an ensemble stands in no line
                let span = written.vary.get(k).map_or(0..0, |variable| variable.span());
                return Err(reader.wrong(&span, &format!("vary[{k}]"), message));
            }
        }
        let axes = variables.iter().filter(|variable| !variable.sampled);
        let grid: f64 = axes.map(|variable| variable.values.len() as f64).product();
        let runs = grid * samples as f64;
        if runs > MOST_RUNS {
            let message = format!("comes to {runs:e} runs; at most {MOST_RUNS:e} are made");
            return Err(reader.wrong(&(0..0), "vary", message));
        }
        let WrittenKeep { runs: of_runs, revolutions, horizon, exponents, files } = written.keep;
        let attractor = written.attractor.as_ref().map(|attractor| {
            let WrittenAttractor { tolerance, longest } = *attractor.as_ref();
            let wrong = |key: &str, message: String| reader.wrong(&attractor.span(), key, message);
            if !(tolerance > 0.0 && tolerance.is_finite()) {
                let message = format!("must be positive, is {tolerance}");
                return Err(wrong("attractor.tolerance", message));
            }
            if !(1..=LONGEST_PERIOD).contains(&longest) {
                let message = format!("must be from 1 to {LONGEST_PERIOD}, is {longest}");
                return Err(wrong("attractor.longest", message));
            }
            Ok(AttractorPlan { tolerance, longest })
        });
        let attractor = attractor.transpose()?;
        let section = written.section.map(|section| {
            let WrittenSection { drive, angle, columns } = section;
            SectionPlan { drive, angle, columns }
        });
        let discard = written.span.discard;
        Ok(Study {
            path: path.to_owned(),
            text: text.to_owned(),
            title: written.title,
            template,
            variables,
            keep: Keep {
                runs: of_runs,
                revolutions,
                discard,
                exponents,
                attractor,
                horizon,
                files,
                section,
            },
            ensemble,
            runs: runs as u64,
            set,
            samples,
        })
    }

    /// The values of a run, of each variable one.
    pub fn point(&self, run: u64) -> Vec<&Literal> {
        let (mut grid, sample) = (run / self.samples, run % self.samples);
        let mut values: Vec<&Literal> = (self.variables.iter().rev())
            .map(|variable| match variable.sampled {
                true => &variable.values[sample as usize],
                false => {
                    let count = variable.values.len() as u64;
                    let value = &variable.values[(grid % count) as usize];
                    grid /= count;
                    value
                }
            })
            .collect();
        values.reverse();
        values
    }

    /// Runs that differ by a sample only, which stand side by side: of an ensemble the long run, then its
    /// copies.
    pub fn samples(&self) -> u64 {
        self.samples
    }

    /// What a run changes in the case.
    pub(super) fn changes(&self, run: u64) -> Result<Changes, case::NotAnOverride> {
        let mut set = self.set.clone();
        if let Some(plan) = self.ensemble.filter(|_| run.is_multiple_of(self.samples)) {
            set.push(format!("run.revolutions={}", plan.long).parse()?);
        }
        for (variable, value) in self.variables.iter().zip(self.point(run)) {
            for key in &variable.keys {
                set.push(format!("{key}={}", value.text).parse()?);
            }
        }
        Ok(Changes { set, ideal: false })
    }

    /// The case of a run.
    ///
    /// # Errors
    /// It does not describe a mechanism.
    pub fn case(&self, run: u64) -> Result<Case, Error> {
        let changes = self.changes(run).map_err(|error| Error::Wrong {
            path: self.path.clone(),
            line: None,
            key: "vary".to_owned(),
            message: error.to_string(),
        })?;
        let text = self.template.resolve(&changes);
        text.and_then(|text| self.template.case(text, &changes)).map_err(Error::Case)
    }

    /// What has `freeplay run` make a run by itself: its `--set` options.
    pub fn options(&self, run: u64) -> Vec<String> {
        let changes = self.changes(run).map(|changes| changes.set).unwrap_or_default();
        changes.iter().map(ToString::to_string).collect()
    }
}

/// Says where something is wrong.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Reader<'_> {
    fn wrong(&self, span: &Range<usize>, key: &str, message: impl ToString) -> Error {
        let before = self.text.get(..span.start).unwrap_or_default();
        let line = 1 + before.matches('\n').count();
        Error::Wrong {
            path: self.path.to_owned(),
            line: (!span.is_empty()).then_some(line),
            key: key.to_owned(),
            message: message.to_string(),
        }
    }
}

impl Variable {
    /// A variable as it is written, and what it is drawn from if it is sampled.
    fn read(written: &WrittenVariable) -> Result<(Variable, Option<Spread>), String> {
        let keys = match (&written.key, &written.keys) {
            (Some(key), None) => vec![key.clone()],
            (None, Some(keys)) if !keys.is_empty() => keys.clone(),
            _ => return Err("needs `key`, or several `keys` that are alike".to_owned()),
        };
        for key in &keys {
            let change: Result<Override, _> = format!("{key}=0").parse();
            change.map_err(|error| error.to_string())?;
        }
        let WrittenVariable { from, to, count, uniform, log_uniform, normal, .. } = *written;
        let range = from.is_some() || to.is_some() || count.is_some();
        let listed = written.values.is_some();
        let spreads = [uniform.is_some(), log_uniform.is_some(), normal.is_some()];
        let ways = spreads.iter().filter(|way| **way).count();
        if ways + usize::from(range) + usize::from(listed) != 1 {
            return Err("needs one of `values`; `from`, `to` and `count`; `uniform`, \
                        `log_uniform` or `normal`"
                .to_owned());
        }
        let positive = |name: &str, numbers: [f64; 2]| match numbers.iter().all(|x| *x > 0.0) {
            true => Ok(()),
            false => Err(format!("{name} must be positive to be spread by logarithms")),
        };
        let increasing = |name: &str, [low, high]: [f64; 2]| match low < high {
            true if low.is_finite() && high.is_finite() => Ok(()),
            _ => Err(format!("{name} must be two numbers [low, high], the first less")),
        };
        let mut spread = None;
        let mut values = Vec::new();
        if let Some(listed) = &written.values {
            values = listed.iter().map(Literal::read).collect();
            if values.is_empty() {
                return Err("values is empty".to_owned());
            }
        } else if range {
            let (Some(from), Some(to), Some(count)) = (from, to, count) else {
                return Err("a range needs `from`, `to` and `count`".to_owned());
            };
            if !(2..=MOST_RUNS as u64).contains(&count) {
                return Err(format!("count must be from 2 to {MOST_RUNS:e}, is {count}"));
            }
            if !(from.is_finite() && to.is_finite() && from != to) {
                return Err("from and to must be two different numbers".to_owned());
            }
            if written.spacing == Spacing::Log {
                positive("from and to", [from, to])?;
            }
            values = (0..count)
                .map(|k| Literal::from(between(from, to, k, count, written.spacing)))
                .collect();
        } else if let Some(ends) = uniform {
            increasing("uniform", ends)?;
            spread = Some(Spread::Uniform(ends));
        } else if let Some(ends) = log_uniform {
            increasing("log_uniform", ends)?;
            positive("log_uniform", ends)?;
            spread = Some(Spread::LogUniform(ends));
        } else if let Some([mean, deviation]) = normal {
            if !(mean.is_finite() && deviation > 0.0 && deviation.is_finite()) {
                return Err(
                    "normal must be [mean, standard deviation], the latter positive".to_owned()
                );
            }
            spread = Some(Spread::Normal { mean, deviation });
        }
        let unit = written.unit.clone().or_else(|| unit_of(&keys[0]));
        let variable = Variable {
            name: written.name.clone().unwrap_or_else(|| keys[0].clone()),
            unit: unit.unwrap_or_else(|| "1".to_owned()),
            is_number: spread.is_some() || values.iter().all(|value| value.number.is_some()),
            is_log: written.spacing == Spacing::Log || log_uniform.is_some(),
            keys,
            values,
            sampled: spread.is_some(),
        };
        Ok((variable, spread))
    }

    /// That by which the copies of an ensemble differ; that of the long run is zero.
    fn of_copies(plan: &EnsemblePlan) -> Variable {
        let spread = Spread::Normal { mean: 0.0, deviation: plan.spread };
        let drawn = sampling::draw(Method::Random, plan.copies, 1, plan.seed);
        let points =
            drawn.into_iter().flatten().map(|point| spread.at(point).clamp(-WIDEST, WIDEST));
        Variable {
            name: ensemble::KEY.to_owned(),
            unit: "1".to_owned(),
            is_number: true,
            is_log: false,
            keys: vec![ensemble::KEY.to_owned()],
            values: std::iter::once(0.0).chain(points).map(Literal::from).collect(),
            sampled: true,
        }
    }

    /// Whether copies of an ensemble differ by it.
    pub fn is_of_copies(&self) -> bool {
        self.name == ensemble::KEY
    }

    /// Whether it has the name or a key of another.
    fn overlaps(&self, other: &Variable) -> bool {
        self.name == other.name || self.keys.iter().any(|key| other.keys.contains(key))
    }
}

/// The k-th of `count` values from one to another, to 15 digits.
fn between(from: f64, to: f64, k: u64, count: u64, spacing: Spacing) -> f64 {
    let share = k as f64 / (count - 1) as f64;
    let value = match spacing {
        _ if k == 0 => return from,
        _ if k + 1 == count => return to,
        Spacing::Linear => from + (to - from) * share,
        Spacing::Log => from * (to / from).powf(share),
    };
    // 0.3, and not the double beside it
    format!("{value:.14e}").parse().unwrap_or(value)
}

impl Literal {
    fn read(written: &WrittenValue) -> Literal {
        match written {
            WrittenValue::Switch(switch) => Literal { text: switch.to_string(), number: None },
            WrittenValue::Whole(whole) => {
                Literal { text: whole.to_string(), number: Some(*whole as f64) }
            }
            WrittenValue::Real(real) => Literal::from(*real),
            WrittenValue::Text(text) => {
                Literal { text: toml_edit::Value::from(text).to_string(), number: None }
            }
        }
    }
}

impl From<f64> for Literal {
    fn from(number: f64) -> Literal {
        Literal { text: format!("{number:?}"), number: Some(number) }
    }
}

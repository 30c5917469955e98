//! The tables of a study: a row of each run, of its revolutions and section points, of each failure.

use super::ensemble::{self, EnsemblePlan};
use super::pack::{Identity, Packs, Record};
use super::runner::{Runner, hexadecimal};
use super::{Error, Study};
use crate::export::{Cells, Field, GROUP, Holds, Kind, Table};
use crate::halt;
use crate::record::{Draft, sha256};
use std::path::{Path, PathBuf};

/// Names of the tables.
pub const TABLES: [&str; 4] = ["runs", "revolutions", "sections", "failures"];
/// Name of the table that a study with ensembles has besides.
pub const ENSEMBLE: &str = "ensemble";

/// Writes the tables of a study from its packs; `identities` are those of its runs, in their order.
/// Gives their paths, and how many runs failed.
pub(super) fn write(
    study: &Study,
    runner: &Runner<'_>,
    packs: &Packs,
    identities: &[Identity],
    folder: &Path,
    csv: bool,
) -> Result<(Vec<PathBuf>, u64), Error> {
    let mut open = Vec::new();
    for name in TABLES {
        open.push(Rows::create(name, study, runner, folder, csv)?);
    }
    let mut failures = 0;
    for (run, identity) in identities.iter().enumerate() {
        if halt::is_asked() {
            return Err(Error::Interrupted);
        }
        let Some(record) = packs.get(identity)? else { continue };
        let key = Key { run: run as i32, values: study.point(run as u64), identity };
        failures += u64::from(record.outcome.is_err());
        let [runs, revolutions, sections, failed] = &mut open[..] else { continue };
        match record {
            Record { outcome: Ok(rows), .. } => {
                runs.add(&key, &rows.run, None)?;
                let each = |row: &[f64], table: &mut Rows| table.add(&key, row, None);
                for row in rows.revolutions.chunks_exact(revolutions.width.max(1)) {
                    each(row, revolutions)?;
                }
                for row in rows.sections.chunks_exact(sections.width.max(1)) {
                    each(row, sections)?;
                }
            }
            Record { outcome: Err(why), .. } => failed.add(&key, &[], Some(&why))?,
        }
    }
    if let Some(plan) = &study.ensemble {
        let mut table = Rows::create(ENSEMBLE, study, runner, folder, csv)?;
        let samples = study.samples() as usize;
        for (point, identities) in identities.chunks(samples).enumerate() {
            if halt::is_asked() {
                return Err(Error::Interrupted);
            }
            let run = point * samples;
            let values = study.variables.iter().zip(study.point(run as u64));
            let values = values.filter(|(variable, _)| !variable.is_of_copies());
            let values = values.map(|(_, value)| value).collect();
            let key = Key { run: run as i32, values, identity: &identities[0] };
            for row in ensembles(plan, packs, identities, runner.of_revolutions.len())? {
                table.add(&key, &row, None)?;
            }
        }
        open.push(table);
    }
    let mut paths = Vec::new();
    for table in open {
        paths.extend(table.finish()?);
    }
    Ok((paths, failures))
}

/// Rows of the ensemble at a point of the grid, one for each revolution of the copies: of which the numbers
/// of each kind behind each other.
fn ensembles(
    plan: &EnsemblePlan,
    packs: &Packs,
    identities: &[Identity],
    kinds: usize,
) -> Result<Vec<Vec<f64>>, Error> {
    let width = 3 + kinds;
    let revolutions = |identity: &Identity| -> Result<Vec<f64>, Error> {
        let outcome = packs.get(identity)?.and_then(|record| record.outcome.ok());
        Ok(outcome.map_or(Vec::new(), |rows| rows.revolutions))
    };
    let long = revolutions(&identities[0])?;
    let copies = identities[1..].iter().map(revolutions).collect::<Result<Vec<_>, _>>()?;
    let most = copies.iter().map(|rows| rows.len() / width).max().unwrap_or(0);
    let first = copies.iter().find_map(|rows| rows.first()).copied().unwrap_or(0.0);
    let mut all: Vec<Vec<f64>> = (0..most).map(|k| vec![first + k as f64]).collect();
    for kind in 0..kinds {
        let of = |rows: &[f64], k: usize| {
            rows.get(k * width + 3 + kind).copied().filter(|value| value.is_finite())
        };
        let long: Vec<f64> = (0..long.len() / width).filter_map(|k| of(&long, k)).collect();
        let by_revolution: Vec<Vec<f64>> =
            (0..most).map(|k| copies.iter().filter_map(|rows| of(rows, k)).collect()).collect();
        let told = ensemble::rows(&by_revolution, &long, first as u64, plan.seed);
        all.iter_mut().zip(told).for_each(|(row, told)| row.extend(told));
    }
    Ok(all)
}

/// What stands in front of every row.
struct Key<'a> {
    run: i32,
    values: Vec<&'a super::Literal>,
    identity: &'a Identity,
}

/// A table that is being written.
struct Rows {
    outputs: Vec<(Draft, Table, PathBuf)>,
    columns: Vec<Cells>,
    rows: usize,
    /// Numbers of a row behind its key.
    width: usize,
}

impl Rows {
    fn create(
        name: &str,
        study: &Study,
        runner: &Runner<'_>,
        folder: &Path,
        csv: bool,
    ) -> Result<Self, Error> {
        let fields = fields(name, study, runner);
        let columns = fields.iter().map(|field| match field.holds {
            Holds::Text => Cells::Text(Vec::new()),
            Holds::Index | Holds::Flag => Cells::Whole(Vec::new()),
            Holds::Real | Holds::Repeated => Cells::Real(Vec::new()),
        });
        let columns: Vec<Cells> = columns.collect();
        let copies = study.variables.iter().filter(|variable| variable.is_of_copies()).count();
        let before = 1 + study.variables.len() - if name == ENSEMBLE { copies } else { 0 };
        let width = match name {
            "runs" => runner.of_runs.len(),
            "failures" => 0,
            _ => columns.len() - before,
        };
        let kinds = [(Kind::Parquet, "parquet"), (Kind::Csv, "csv")];
        let mut outputs = Vec::new();
        for (kind, ending) in kinds.into_iter().filter(|(kind, _)| csv || *kind == Kind::Parquet) {
            let path = folder.join(format!("{name}.{ending}"));
            let draft = Draft::create(&path, true).map_err(Error::Output)?;
            let texts = texts(name, study);
            let table = Table::create(kind, draft.temporary(), &fields, texts);
            outputs.push((draft, table.map_err(|error| Error::Table(error.at(&path)))?, path));
        }
        Ok(Rows { outputs, columns, rows: 0, width })
    }

    /// Adds a row: its key, its numbers, a text.
    fn add(&mut self, key: &Key<'_>, numbers: &[f64], text: Option<&str>) -> Result<(), Error> {
        let mut columns = self.columns.iter_mut();
        let mut numbers = numbers.iter();
        let mut values = key.values.iter();
        let mut texts = [Some(hexadecimal(key.identity)), text.map(str::to_owned)].into_iter();
        // run, values of the variables, then what the table has
        if let Some(Cells::Whole(runs)) = columns.next() {
            runs.push(key.run);
        }
        for cells in columns {
            match (cells, values.next()) {
                (Cells::Real(cells), Some(value)) => cells.push(value.number.unwrap_or(f64::NAN)),
                (Cells::Text(cells), Some(value)) => {
                    cells.push(value.text.trim_matches('"').to_owned());
                }
                (Cells::Real(cells), None) => {
                    cells.push(numbers.next().copied().unwrap_or(f64::NAN));
                }
                (Cells::Whole(cells), _) => {
                    cells.push(numbers.next().map_or(-1, |number| *number as i32));
                }
                (Cells::Text(cells), None) => {
                    cells.push(texts.next().flatten().unwrap_or_default())
                }
            }
        }
        self.rows += 1;
        if self.rows == GROUP { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), Error> {
        if self.rows > 0 {
            for (_, table, path) in &mut self.outputs {
                table.write(&self.columns).map_err(|error| Error::Table(error.at(path)))?;
            }
        }
        self.columns.iter_mut().for_each(Cells::clear);
        self.rows = 0;
        Ok(())
    }

    fn finish(mut self) -> Result<Vec<PathBuf>, Error> {
        self.flush()?;
        let mut paths = Vec::new();
        for (draft, table, path) in self.outputs {
            table.finish().map_err(|error| Error::Table(error.at(&path)))?;
            paths.push(draft.publish().map_err(Error::Output)?);
        }
        Ok(paths)
    }
}

/// The columns of a table.
fn fields(name: &str, study: &Study, runner: &Runner<'_>) -> Vec<Field> {
    let field = |name: &str, unit: &str, long_name: &str, holds| Field {
        name: name.to_owned(),
        unit: unit.to_owned(),
        long_name: long_name.to_owned(),
        holds,
    };
    let run = "number of the run, from 0; the last variable goes fastest";
    let mut fields = vec![field("run", "1", run, Holds::Index)];
    let variables = study.variables.iter();
    let variables = variables.filter(|of| name != ENSEMBLE || !of.is_of_copies());
    fields.extend(variables.map(|variable| {
        let holds = if variable.is_number { Holds::Repeated } else { Holds::Text };
        field(&variable.name, &variable.unit, "what varies", holds)
    }));
    let scalars = |scalars: &[super::scalar::Scalar]| -> Vec<Field> {
        let of = |scalar: &super::scalar::Scalar| {
            let long_name = "as in freeplay summary --json";
            field(&scalar.name, &scalar.unit, long_name, Holds::Real)
        };
        scalars.iter().map(of).collect()
    };
    let revolution = "number of the revolution of the first drive, from 0";
    match name {
        "runs" => {
            let sha = "SHA-256 of the text of the case as run";
            fields.push(field("case_sha256", "1", sha, Holds::Text));
            fields.extend(scalars(&runner.of_runs));
        }
        "revolutions" => {
            fields.push(field("revolution", "1", revolution, Holds::Index));
            fields.push(field("begin", "s", "begin of the revolution", Holds::Real));
            fields.push(field("end", "s", "end of the revolution, or of the run", Holds::Real));
            fields.extend(scalars(&runner.of_revolutions));
        }
        ENSEMBLE => {
            fields.push(field("revolution", "1", revolution, Holds::Index));
            for scalar in &runner.of_revolutions {
                fields.extend(ensemble::COLUMNS.iter().map(|(end, about)| {
                    let unit = if ensemble::BARE.contains(end) { "1" } else { &scalar.unit };
                    field(&format!("{}.{end}", scalar.name), unit, about, Holds::Real)
                }));
            }
        }
        "sections" => {
            fields.push(field("revolution", "1", revolution, Holds::Index));
            fields.push(field("time", "s", "when the drive passes the angle", Holds::Real));
            let columns = runner.section.iter().flat_map(|section| &section.columns);
            fields.extend(columns.map(|column| {
                field(
                    &column.name,
                    column.column.dataset.unit,
                    column.column.dataset.long_name,
                    Holds::Real,
                )
            }));
        }
        _ => {
            let sha = "SHA-256 of the text of the case as it would have been run";
            fields.push(field("case_sha256", "1", sha, Holds::Text));
            fields.push(field("reason", "1", "why the run failed", Holds::Text));
        }
    }
    fields
}

/// What the metadata of a table says of the study.
fn texts(name: &str, study: &Study) -> Vec<(String, String)> {
    let mut texts = vec![
        ("source".to_owned(), concat!("freeplay ", env!("CARGO_PKG_VERSION")).to_owned()),
        ("table".to_owned(), name.to_owned()),
    ];
    texts.extend(identity_texts(study));
    texts
}

/// Texts that tell a study from another.
pub(super) fn identity_texts(study: &Study) -> [(String, String); 4] {
    let case = study.template.text();
    [
        ("title".to_owned(), study.title.clone()),
        ("study_toml".to_owned(), study.text.clone()),
        ("case_toml".to_owned(), case.to_owned()),
        ("case_sha256".to_owned(), sha256(case)),
    ]
}

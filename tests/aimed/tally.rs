//! What came of many trials, by family and by kind of fall.

use super::families::{FAMILIES, draw};
use super::judge::{SOLVER, cpu, judge};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

/// Trials from the first on, one after another: a certificate has its own threads.
pub struct Campaign {
    pub trials: u64,
    pub first: u64,
    pub seed: u64,
    /// Where cases that fell are left.
    pub folder: Option<PathBuf>,
}

#[derive(Default)]
pub struct Tally {
    pub trials: usize,
    pub certificates: usize,
    pub judged: usize,
    families: BTreeMap<&'static str, Family>,
    falls: BTreeMap<&'static str, Vec<(u64, String)>>,
}

#[derive(Default)]
struct Family {
    trials: usize,
    certificates: usize,
    judged: usize,
    least: f64,
    seconds: f64,
}

impl Campaign {
    pub fn run(&self) -> Tally {
        let mut tally = Tally::default();
        for number in self.first..self.first + self.trials {
            let aimed = draw(self.seed, number);
            let began = cpu();
            let verdict = judge(&aimed);
            tally.trials += 1;
            tally.certificates += usize::from(verdict.certified);
            tally.judged += verdict.judged;
            let family = tally
                .families
                .entry(aimed.family)
                .or_insert(Family { least: 16.0, ..Family::default() });
            family.trials += 1;
            family.certificates += usize::from(verdict.certified);
            family.judged += verdict.judged;
            family.least = family.least.min(verdict.least);
            family.seconds += cpu() - began;
            for (place, fall) in verdict.falls.into_iter().enumerate() {
                if let Some(folder) = &self.folder {
                    println!("{number} {}, {}: {}", aimed.family, fall.kind, fall.words);
                    let path = folder
                        .join(format!("{number:05}-{place}-{}.toml", fall.kind.replace(' ', "-")));
                    let text =
                        format!("# {}\n{}{SOLVER}", fall.words.replace('\n', " "), aimed.text);
                    std::fs::write(path, text).expect("a folder that can be written");
                }
                tally.falls.entry(fall.kind).or_default().push((number, fall.words));
            }
            if self.folder.is_some() && (number + 1) % 50 == 0 {
                println!("{}", tally.table());
            }
        }
        tally
    }
}

impl Tally {
    /// How many falls of a kind there are.
    pub fn count(&self, kind: &str) -> usize {
        self.falls.get(kind).map_or(0, Vec::len)
    }

    /// The table that a script prints.
    pub fn table(&self) -> String {
        let mut table = format!(
            "{} trials, {} certificates, {} samples, events and peaks held against the truth\n\
             trials  certificates  judged  least digits  CPU (s)\n",
            self.trials, self.certificates, self.judged
        );
        for (name, _) in FAMILIES {
            let Some(family) = self.families.get(name) else { continue };
            let Family { trials, certificates, judged, least, seconds } = family;
            let _ = writeln!(
                table,
                "{trials:6}  {certificates:12}  {judged:6}  {least:12.2}  {seconds:7.0}  {name}"
            );
        }
        for (kind, falls) in &self.falls {
            let _ = writeln!(table, "{:6}  {kind}", falls.len());
            for (number, words) in falls.iter().take(3) {
                let _ = writeln!(table, "        trial {number}, {words}");
            }
        }
        table
    }
}

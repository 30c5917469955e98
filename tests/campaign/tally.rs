//! What fell in a campaign, by kind.

use super::generator::{Drawn, draw};
use super::trial::{Verdict, trial};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// A campaign: how many mechanisms, from which seed, with how many samples a run.
pub struct Campaign {
    pub mechanisms: u64,
    pub seed: u64,
    pub samples: u64,
    /// Where cases that fell are left.
    pub folder: Option<PathBuf>,
    /// Whether each fall is told at once.
    pub told: bool,
}

/// What came of a campaign.
#[derive(Default)]
pub struct Tally {
    pub mechanisms: usize,
    pub refused: usize,
    pub runs: usize,
    pub contacts: usize,
    pub samples: usize,
    pub compared: usize,
    /// Falls by kind, each with the number of its mechanism.
    pub falls: BTreeMap<&'static str, Vec<(u64, String)>>,
}

impl Campaign {
    /// Tries every mechanism, on as many threads as there are cores.
    pub fn run(&self) -> Tally {
        let tally = Mutex::new(Tally::default());
        let next = AtomicU64::new(0);
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get().min(4));
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    loop {
                        let number = next.fetch_add(1, Ordering::Relaxed);
                        if number >= self.mechanisms {
                            break;
                        }
                        let drawn = draw(self.seed, number);
                        let verdict = trial(&drawn, self.samples);
                        self.keep(number, &drawn, verdict, &tally);
                    }
                });
            }
        });
        tally.into_inner().expect("no thread panicked")
    }

    fn keep(&self, number: u64, drawn: &Drawn, verdict: Option<Verdict>, tally: &Mutex<Tally>) {
        let mut tally = tally.lock().expect("no thread panicked");
        let Some(verdict) = verdict else {
            tally.refused += 1;
            return;
        };
        tally.mechanisms += 1;
        tally.runs += verdict.runs;
        tally.contacts += verdict.contacts;
        tally.samples += verdict.samples;
        tally.compared += verdict.compared;
        for (place, fall) in verdict.falls.into_iter().enumerate() {
            if self.told {
                println!("{number} {}, {}: {}", drawn.kind, fall.kind, fall.words);
            }
            if let Some(folder) = &self.folder {
                let kind = fall.kind.replace(' ', "-");
                let path = folder.join(format!("{kind}-{number}-{place}.toml"));
                let set = fall.set.join("\n#   --set ");
                let text = format!("# {}\n#   --set {set}\n{}", fall.words, drawn.text);
                std::fs::write(path, text).expect("a folder that can be written");
            }
            tally.falls.entry(fall.kind).or_default().push((number, fall.words));
        }
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
            "{} mechanisms ({} drawn were none), {} runs, {} contacts, {} samples; {} contacts held \
             to the other engine's\n",
            self.mechanisms, self.refused, self.runs, self.contacts, self.samples, self.compared
        );
        for (kind, falls) in &self.falls {
            let _ = writeln!(table, "{:5}  {kind}", falls.len());
            for (number, words) in falls.iter().take(3) {
                let _ = writeln!(table, "       mechanism {number}, {words}");
            }
        }
        table
    }
}

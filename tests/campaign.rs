//! Random mechanisms against the promise that nothing is missed. Known in advance is that a journal
//! in flight is inside its clearance, that friction follows its law, that the energy balance closes,
//! and that two engines which share no step tell the same contacts while errors are small.
//!
//! `scripts/campaign.sh` runs the whole.

#[path = "campaign/generator.rs"]
mod generator;
#[path = "campaign/tally.rs"]
mod tally;
#[path = "campaign/trial.rs"]
mod trial;

use freeplay::case::{Case, Changes};
use std::path::PathBuf;
use tally::{Campaign, Tally};

const SEED: u64 = 15;

/// The thresholds that a campaign is held to.
fn assert_kept(tally: &Tally) {
    for kind in [
        "in the wall",
        "contact in the air",
        "contact of one engine",
        "time or rate back",
        "friction off its law",
        "slow",
        "hangs",
        "energy at 1e-9",
        "energy at 1e-12",
    ] {
        assert_eq!(tally.count(kind), 0, "{kind}:\n{}", tally.table());
    }
    // draws that no law means anything for are few, and every engine says so at every tolerance
    let refused = tally.count("too deep");
    assert!(refused.is_multiple_of(6) && refused * 20 <= tally.runs, "{}", tally.table());
    let failures = tally.count("fails");
    assert!(failures * 1000 <= tally.runs, "{failures} of {} runs:\n{}", tally.runs, tally.table());
}

/// A number from the environment.
fn asked(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().expect("a number"))
}

/// Where `scripts/campaign.sh` wants cases to be left.
fn folder(name: &str) -> Option<PathBuf> {
    std::env::var(name).ok().map(PathBuf::from)
}

/// A small campaign; the whole one where the environment asks for it.
#[test]
fn random_mechanisms_hold_what_is_promised() {
    let folder = folder("CAMPAIGN_FALLEN");
    let campaign = Campaign {
        mechanisms: asked("CAMPAIGN_MECHANISMS", 200),
        seed: asked("CAMPAIGN_SEED", SEED),
        samples: asked("CAMPAIGN_SAMPLES", 5000),
        told: folder.is_some(),
        folder,
    };
    let tally = campaign.run();
    println!("{}", tally.table());
    assert!(tally.mechanisms > 0 && tally.compared > 10 * tally.mechanisms, "{}", tally.table());
    assert_kept(&tally);
}

/// Cases for certificates, which are dear: `scripts/campaign.sh` holds them against the truth.
#[test]
fn short_cases_are_cases() {
    let temporary = tempfile::tempdir().unwrap();
    let folder = folder("CAMPAIGN_CASES").unwrap_or(temporary.path().to_owned());
    let seed = asked("CAMPAIGN_SEED", SEED);
    let mut written = 0;
    for number in 0..asked("CAMPAIGN_CERTIFICATES", 12) {
        let drawn = generator::draw(seed, number);
        if let Some(text) = trial::short(&drawn, 60) {
            let path = folder.join(format!("{number:04}-{}.toml", drawn.kind.replace(' ', "-")));
            std::fs::write(&path, text).unwrap();
            let read = Case::read(&path, &Changes::default());
            assert!(read.is_ok(), "{}: {:?}", path.display(), read.err());
            written += 1;
        }
    }
    assert!(written > 0);
}

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
    let failures = tally.count("fails");
    assert!(failures * 1000 <= tally.runs, "{failures} of {} runs:\n{}", tally.runs, tally.table());
}

#[test]
fn random_mechanisms_hold_what_is_promised() {
    let campaign =
        Campaign { mechanisms: 60, seed: SEED, samples: 5000, folder: None, told: false };
    let tally = campaign.run();
    assert!(tally.mechanisms >= 50 && tally.compared > 1000, "{}", tally.table());
    assert_kept(&tally);
}

/// A number from the environment.
fn asked(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().expect("a number"))
}

/// Cases for certificates, which are dear.
#[test]
#[ignore = "writes cases for scripts/campaign.sh"]
fn short_cases() {
    let folder = PathBuf::from(std::env::var("CAMPAIGN_FOLDER").expect("CAMPAIGN_FOLDER"));
    let seed = asked("CAMPAIGN_SEED", SEED);
    for number in 0..asked("CAMPAIGN_MECHANISMS", 300) {
        let drawn = generator::draw(seed, number);
        if let Some(text) = trial::short(&drawn, 200) {
            let name = drawn.kind.replace(' ', "-");
            std::fs::write(folder.join(format!("{number:04}-{name}.toml")), text).unwrap();
        }
    }
}

#[test]
#[ignore = "takes an hour: scripts/campaign.sh"]
fn the_whole_campaign() {
    let folder = std::env::var("CAMPAIGN_FOLDER").ok().map(PathBuf::from);
    let campaign = Campaign {
        mechanisms: asked("CAMPAIGN_MECHANISMS", 2000),
        seed: asked("CAMPAIGN_SEED", SEED),
        samples: asked("CAMPAIGN_SAMPLES", 20_000),
        folder,
        told: true,
    };
    let tally = campaign.run();
    println!("{}", tally.table());
    assert_kept(&tally);
}

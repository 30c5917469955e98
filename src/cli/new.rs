//! `freeplay new KIND`

mod four_bars;

use super::{Failure, signals};
use crate::record::{self, Draft};
use clap::ValueEnum;
use std::borrow::Cow;
use std::path::PathBuf;

/// Arguments of `new`.
#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// What the case describes.
    #[arg(value_enum)]
    kind: Kind,
    /// How many four-bars `four-bars` has.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=9999))]
    count: u16,
    /// Case file to write; default: the kind's name with .toml, in this folder.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replace the file if it exists.
    #[arg(long)]
    force: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Kind {
    /// Crank-rocker, clearance between crank and coupler.
    FourBar,
    /// Slider-crank, clearance at the wrist pin.
    SliderCrank,
    /// Watt's six-bar, clearance and friction in two joints.
    SixBar,
    /// A rod on a loose pin.
    Pendulum,
    /// Two rods with a loose elbow.
    DoublePendulum,
    /// A shaft that falls in its bearing.
    JournalInBearing,
    /// A crank's pin in the slot of a yoke.
    ScotchYoke,
    /// A crank turns a slotted lever, which pushes a ram.
    QuickReturn,
    /// Two cranks with a motor each, and rods that meet.
    FiveBar,
    /// 3-RRR manipulator, clearance in the joints of its platform.
    ThreeRrr,
    /// Crank-rocker turned by a motor with a speed controller, clearance between crank and coupler.
    SpeedController,
    /// Sun, planet, and a ring on a torsion spring.
    PlanetaryGear,
    /// Crank press with a flywheel and a torque drive, clearance at the wrist pin.
    Press,
    /// A block that tumbles in a guide with play.
    BlockInGuide,
    /// Slider-crank, play between slider and guide.
    SliderCrankGuide,
    /// Four-bars in a row, `--count` of them; ideal joints.
    FourBars,
}

impl Kind {
    /// Name of the file, and what is in it.
    fn file(self, count: u16) -> (&'static str, Cow<'static, str>) {
        let (name, text) = match self {
            Kind::FourBar => ("four-bar.toml", include_str!("new/four-bar.toml")),
            Kind::SliderCrank => {
                ("slider-crank.toml", include_str!("../../cases/slider-crank.toml"))
            }
            Kind::BlockInGuide => {
                ("block-in-guide.toml", include_str!("../../cases/block-in-guide.toml"))
            }
            Kind::SliderCrankGuide => {
                ("slider-crank-guide.toml", include_str!("../../cases/slider-crank-guide.toml"))
            }
            Kind::SixBar => ("six-bar.toml", include_str!("new/six-bar.toml")),
            Kind::Pendulum => ("pendulum.toml", include_str!("new/pendulum.toml")),
            Kind::DoublePendulum => {
                ("double-pendulum.toml", include_str!("new/double-pendulum.toml"))
            }
            Kind::JournalInBearing => {
                ("journal-in-bearing.toml", include_str!("new/journal-in-bearing.toml"))
            }
            Kind::ScotchYoke => ("scotch-yoke.toml", include_str!("../../cases/scotch-yoke.toml")),
            Kind::QuickReturn => {
                ("quick-return.toml", include_str!("../../cases/quick-return.toml"))
            }
            Kind::FiveBar => ("five-bar.toml", include_str!("../../cases/five-bar.toml")),
            Kind::ThreeRrr => ("three-rrr.toml", include_str!("../../cases/three-rrr.toml")),
            Kind::SpeedController => {
                ("speed-controller.toml", include_str!("../../cases/speed-controller.toml"))
            }
            Kind::PlanetaryGear => {
                ("planetary-gear.toml", include_str!("../../cases/planetary-gear.toml"))
            }
            Kind::Press => ("press.toml", include_str!("../../cases/press.toml")),
            Kind::FourBars => return ("four-bars.toml", four_bars::four_bars(count).into()),
        };
        (name, text.into())
    }
}

/// Writes a commented case file to start from.
pub(super) fn new(arguments: &Arguments) -> Result<(), Failure> {
    signals::end_at_once()?;
    let (name, text) = arguments.kind.file(arguments.count);
    let path = arguments.output.clone().unwrap_or_else(|| name.into());
    let write = || -> Result<(), record::Error> {
        Draft::create(&path, arguments.force)?.publish_bytes(text.as_bytes())
    };
    write().map_err(Failure::output)?;
    let path = path.display();
    super::print(format_args!(
        "{path}: change it to yours; freeplay check {path} tells what it describes\n"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Case, Changes};
    use crate::simulate::Simulation;
    use std::path::Path;

    #[test]
    fn every_kind_is_a_case_that_names_itself_and_can_be_assembled() {
        for kind in Kind::value_variants() {
            let (name, text) = kind.file(3);
            let case = Case::from_text(Path::new(name), &text, &Changes::default());
            let case = case.unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(
                Some(name.strip_suffix(".toml").unwrap()),
                kind.to_possible_value().map(|value| value.get_name().to_owned()).as_deref()
            );
            assert!(!case.title.is_empty() && !text.contains("\nname"), "{name}");
            Simulation::new(&case).unwrap_or_else(|error| panic!("{name}: {error}"));
        }
    }
}

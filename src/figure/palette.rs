//! Colours and line widths.
//!
//! Okabe and Ito's colours, which the colour-blind tell apart ("Color Universal Design", 2008);
//! curves that share a panel differ in width or dashes too, so that they part in grey print.

use super::svg::Stroke;

/// Black.
pub(super) const BLACK: &str = "#000";
/// Blue.
pub(super) const BLUE: &str = "#0072b2";
/// Vermillion.
pub(super) const VERMILLION: &str = "#d55e00";
/// Bluish green.
pub(super) const GREEN: &str = "#009e73";
/// Orange.
pub(super) const ORANGE: &str = "#e69f00";
/// Reddish purple.
pub(super) const PURPLE: &str = "#cc79a7";
/// Sky blue.
pub(super) const SKY: &str = "#56b4e9";
/// Grey of lines that only guide the eye.
pub(super) const GREY: &str = "#999";

/// Ground behind what lies beyond the horizon of a run.
pub(super) const BEYOND: &str = "#e6e6e6";
/// Paths and points there.
pub(super) const BEYOND_PATH: &str = "#bdbdbd";

/// Ground of a band about a curve.
pub(super) const BAND: &str = "#c6ddec";
/// Colours of heat maps, from low to high: viridis (van der Walt, Smith 2015), whose lightness grows
/// evenly, so that it is read in grey print.
pub(super) const HEAT: [&str; 16] = [
    "#440154", "#481a6c", "#472f7d", "#414487", "#39568c", "#31688e", "#2a788e", "#23888e",
    "#1f988b", "#22a884", "#35b779", "#54c568", "#7ad151", "#a5db36", "#d2e21b", "#fde725",
];

/// Frames and ticks.
pub(super) const FRAME: Stroke = Stroke::solid(BLACK, 0.5);
/// Lines that only guide the eye.
pub(super) const GUIDE: Stroke = Stroke::solid(GREY, 0.4);
/// Where an axis goes from linear to logarithmic.
pub(super) const BEND: Stroke = Stroke::dashed(GREY, 0.5);
/// The curve of a run.
pub(super) const RUN: Stroke = Stroke::solid(BLUE, 0.7);
/// Curves of runs that share a panel, the first on top.
pub(super) const OVERLAID: [Stroke; 6] = [
    Stroke::solid(BLUE, 0.7),
    Stroke::solid(VERMILLION, 1.1),
    Stroke::solid(GREEN, 0.6),
    Stroke::solid(ORANGE, 1.4),
    Stroke::dashed(PURPLE, 0.8),
    Stroke::dashed(SKY, 1.2),
];
/// The ideal mechanism.
pub(super) const IDEAL: Stroke = Stroke::dashed(BLACK, 0.9);

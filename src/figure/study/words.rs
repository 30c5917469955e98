//! What columns of a study are called on an axis.

use crate::figure::text::Text;

/// A number of a summary, by its path.
pub(super) fn of_number(path: &str) -> Text {
    let path = path.strip_suffix(".value").unwrap_or(path);
    if let Some(rest) = path.strip_prefix("clearances.") {
        let Some((joint, what)) = rest.rsplit_once('.') else { return Text::roman(path) };
        return Text::roman(match what {
            "contacts" => format!("Contacts in {joint}"),
            "share_in_contact" => format!("Share of time in contact, {joint}"),
            what => format!("{} in {joint}", capital(what)),
        });
    }
    if let Some(number) = path.strip_prefix("lyapunov.") {
        return match number {
            "sum" => Text::roman("Sum of all exponents (e-folds per revolution)"),
            "sum.half_width" => Text::roman("Half interval of the sum of all exponents"),
            "kaplan_yorke" => Text::roman("Kaplan–Yorke dimension"),
            "kaplan_yorke.half_width" => Text::roman("Half interval of the Kaplan–Yorke dimension"),
            number => match number.strip_suffix(".half_width") {
                Some(number) => Text::roman(format!("Half interval of exponent {number}")),
                None => Text::roman(format!("Exponent {number} (e-folds per revolution)")),
            },
        };
    }
    if let Some(what) = path.strip_prefix("attractor.") {
        return Text::roman(match what.strip_prefix("always_in_contact.") {
            Some(joint) => format!("{joint} always in contact"),
            None if what == "revolutions" => "Period (revolutions)".to_owned(),
            None => "Distance after a period".to_owned(),
        });
    }
    let Some(rest) = path.strip_prefix("columns.") else {
        return Text::roman(capital(&path.replace('.', ", ")));
    };
    for (end, before, behind) in [
        (".ratio.largest", "Largest", " over the ideal one"),
        (".ratio.smallest", "Smallest", " over the ideal one"),
        (".largest", "Largest", ""),
        (".smallest", "Smallest", ""),
    ] {
        if let Some((quantity, item)) =
            rest.strip_suffix(end).and_then(|column| column.split_once('.'))
        {
            let (quantity, of) = match quantity {
                "joint_force" => ("force", "in"),
                "normal_force" | "tangential_force" => (quantity, "in"),
                "drive_torque" => ("torque", "of"),
                other => (other, "of"),
            };
            let quantity = quantity.replace('_', " ");
            return Text::roman(format!("{before} {quantity} {of} {item}{behind}"));
        }
    }
    Text::roman(rest)
}

/// A variable, by its name, which may be a key of the case.
pub(super) fn of_variable(name: &str) -> Text {
    let keys: Vec<&str> = name.split('.').collect();
    Text::roman(match keys[..] {
        ["joints", joint, "clearance", "radial"] => format!("Radial clearance of {joint}"),
        ["drives", drive, "speed_rpm"] => format!("Speed of {drive}"),
        [_, item, key] => format!("{} of {item}", capital(key)),
        _ => capital(name),
    })
}

/// A variable in the middle of a sentence.
pub(super) fn in_a_sentence(name: &str) -> String {
    let words = of_variable(name).plain();
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_lowercase().chain(letters).collect())
}

/// A column of a sample: `clearance_x.A`.
pub(super) fn of_column(name: &str) -> Text {
    match name.split_once('.') {
        Some((dataset @ ("clearance_x" | "clearance_y"), joint)) => {
            let letter = &dataset["clearance_".len()..];
            Text::roman("Δ").and_italic(letter).and(format!(" in {joint}"))
        }
        Some((dataset, item)) => Text::roman(format!("{} of {item}", capital(dataset))),
        None => Text::roman(capital(name)),
    }
}

fn capital(words: &str) -> String {
    let words = words.replace('_', " ");
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_have_words_for_their_axes() {
        for (path, words) in [
            ("columns.joint_force.A.largest.value", "Largest force in A"),
            ("columns.drive_torque.crank.smallest.value", "Smallest torque of crank"),
            ("columns.joint_force.A.ratio.largest", "Largest force in A over the ideal one"),
            ("clearances.A.contacts", "Contacts in A"),
            ("clearances.A.largest_penetration.value", "Largest penetration in A"),
            ("energy.energy_residual", "Energy, energy residual"),
            ("lyapunov.1.value", "Exponent 1 (e-folds per revolution)"),
            ("lyapunov.kaplan_yorke.value", "Kaplan–Yorke dimension"),
            ("attractor.revolutions", "Period (revolutions)"),
            ("attractor.always_in_contact.A", "A always in contact"),
        ] {
            assert_eq!(of_number(path).plain(), words);
        }
        assert_eq!(of_variable("joints.A.clearance.radial").plain(), "Radial clearance of A");
        assert_eq!(of_variable("bodies.coupler.mass").plain(), "Mass of coupler");
        assert_eq!(in_a_sentence("joints.A.clearance.radial"), "radial clearance of A");
        assert_eq!(of_column("clearance_x.A").plain(), "Δx in A");
    }
}

//! Whether two results are of the same mechanism.

use super::quantity::Parts;
use crate::case::Case;
use toml_edit::{DocumentMut, Item, TableLike, Value};

/// Keys of a case that say how it is run, not what it is. Where it starts is part of the motion:
/// rough starts that differ lead to the same one, others show in the first sample.
const NOT_THE_MECHANISM: [&str; 6] = ["name", "title", "observe", "run", "solver", "start"];

/// Says where two mechanisms differ; `None` if they are one.
pub fn difference(theirs: (&Parts, &Case), reference: (&Parts, &Case)) -> Option<String> {
    let names = [
        ("bodies", &theirs.0.0.bodies, &reference.0.0.bodies),
        ("joints", &theirs.0.0.joints, &reference.0.0.joints),
        ("clearances", &theirs.0.0.clearances, &reference.0.0.clearances),
        ("drives", &theirs.0.0.drives, &reference.0.0.drives),
    ];
    let list = |names: &[String]| if names.is_empty() { "none".into() } else { names.join(", ") };
    if let Some((what, a, b)) = names.into_iter().find(|(_, a, b)| a != b) {
        return Some(format!("{what} are {} and {}", list(a), list(b)));
    }
    let (a, b) = (theirs.1, reference.1);
    let same = |a: &Case, b: &Case| {
        let (start, observed) = (b.description.start.clone(), b.description.observed.clone());
        crate::model::Description { start, observed, ..a.description.clone() } == b.description
    };
    if same(a, b) {
        return None;
    }
    let (a, b) = (keys(&a.text), keys(&b.text));
    let find = |keys: &[(String, String)], key: &str| {
        keys.iter().find(|(known, _)| known == key).map(|(_, value)| value.clone())
    };
    let all = a.iter().chain(&b).map(|(key, _)| key);
    for key in all {
        let given = |keys| find(keys, key).unwrap_or_else(|| "left out".to_owned());
        if find(&a, key) != find(&b, key) {
            return Some(format!("{key} is {} and {}", given(&a), given(&b)));
        }
    }
    None
}

/// The keys of a case that describe its mechanism, by their paths, numbers in their shortest form.
fn keys(text: &str) -> Vec<(String, String)> {
    let mut keys = Vec::new();
    // a case that has been read parses
    if let Ok(document) = text.parse::<DocumentMut>() {
        let table = document.as_table();
        let described = table.iter().filter(|(key, _)| !NOT_THE_MECHANISM.contains(key));
        described.for_each(|(key, item)| flatten(key, item, &mut keys));
    }
    keys
}

fn flatten(path: &str, item: &Item, keys: &mut Vec<(String, String)>) {
    match (item.as_table_like(), item.as_value()) {
        (Some(table), _) => flatten_table(path, table, keys),
        (None, Some(value)) => keys.push((path.to_owned(), shortest(value))),
        (None, None) => {}
    }
}

fn flatten_table(path: &str, table: &dyn TableLike, keys: &mut Vec<(String, String)>) {
    for (key, item) in table.iter() {
        flatten(&format!("{path}.{key}"), item, keys);
    }
}

/// A value without its spelling: numbers in their shortest form.
fn shortest(value: &Value) -> String {
    match value {
        Value::Integer(number) => format!("{:?}", *number.value() as f64),
        Value::Float(number) => format!("{:?}", number.value()),
        Value::String(text) => text.value().clone(),
        Value::Array(values) => {
            let values: Vec<String> = values.iter().map(shortest).collect();
            format!("[{}]", values.join(", "))
        }
        other => other.to_string().trim().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::quantity::tests::four_bar;
    use super::*;
    use crate::case::Changes;
    use std::path::Path;

    fn case(set: &[&str]) -> Case {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("cases/four-bar-a.toml");
        let set = set.iter().map(|set| set.parse().unwrap()).collect();
        Case::read(&path, &Changes { set, ideal: false }).unwrap()
    }

    fn difference_of(theirs: &[&str], reference: &[&str]) -> Option<String> {
        let parts = four_bar();
        difference((&parts, &case(theirs)), (&parts, &case(reference)))
    }

    #[test]
    fn other_engines_tolerances_samplings_and_spellings_are_the_same_mechanism() {
        for theirs in [
            vec![],
            vec!["solver.relative_tolerance=1e-9", "run.duration=0.01", "name=other"],
            vec!["start.coupler.angle=0.71"],
            vec!["bodies.coupler.mass=0.07370", "drives.crank.speed_rpm=5000"],
        ] {
            assert_eq!(difference_of(&theirs, &[]), None, "{theirs:?}");
        }
    }

    #[test]
    fn a_key_that_differs_is_named_with_both_values() {
        let told = difference_of(&["joints.A.clearance.radial=0.00015"], &[]).unwrap();
        assert_eq!(told, "joints.A.clearance.radial is 0.00015 and 0.001");
        let told = difference_of(&[], &["joints.A.clearance.tension=cut"]).unwrap();
        assert_eq!(told, "joints.A.clearance.tension is left out and cut");
    }

    #[test]
    fn parts_with_other_names_are_another_mechanism() {
        let mut parts = four_bar();
        parts.0.clearances = vec!["B".into()];
        let told = difference((&four_bar(), &case(&[])), (&parts, &case(&[]))).unwrap();
        assert_eq!(told, "clearances are A and B");
    }
}

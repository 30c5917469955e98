//! Whatever is read, a case or an error comes of it.

use super::*;
use proptest::prelude::*;

fn read_bytes(bytes: &[u8]) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.toml");
    fs::write(&path, bytes).unwrap();
    if let Err(error) = Case::read(&path, &Changes::default()) {
        assert!(!error.to_string().is_empty());
    }
}

/// A piece of text that a case may hold, sensible or not.
fn piece() -> impl Strategy<Value = String> {
    const KNOWN: &[&str] = &[
        "[",
        "]",
        "{}",
        "=",
        ".",
        ",",
        "\"",
        "\n",
        "#",
        "nan",
        "inf",
        "-1",
        "1e-400",
        "0x7f",
        "true",
        "\r\n",
        "é",
        "\u{feff}",
        "ground",
        "crank.A",
        "[[bodies]]\n",
        "'''",
    ];
    prop_oneof![prop::sample::select(KNOWN).prop_map(str::to_owned), ".{0,3}"]
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read_bytes(&bytes);
    }

    #[test]
    fn a_mutated_case_never_panics(
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..30usize, piece()), 1..4)
    ) {
        let mut text: Vec<char> = FOUR_BAR_A.chars().collect();
        for (at, removed, piece) in edits {
            let at = at.index(text.len());
            let end = (at + removed).min(text.len());
            text.splice(at..end, piece.chars());
        }
        let text: String = text.into_iter().collect();
        if let Err(error) = read(&text) {
            prop_assert!(error.to_string().lines().count() > 1);
        }
    }

    #[test]
    fn any_key_can_be_set_and_the_text_as_run_says_the_same(
        key in prop::sample::select(vec![
            "name", "title", "ground", "ground.points", "ground.points.C", "bodies", "bodies.rod",
            "bodies.crank.mass", "joints", "joints.A", "joints.A.clearance", "joints.B.clearance.radial",
            "joints.A.clearance.normal.law", "drives.crank.angle", "loads.g.kind", "start.crank.angle",
            "run", "run.sampling", "solver.norm", "new", "new.table.key", "\"odd key\".x",
        ]),
        value in prop::sample::select(vec![
            "1", "0.5", "word", "[0, 1]", "{}", "{a = 1}", "\"\"\"two\nlines\"\"\"", "true", "inf",
        ]),
        dotted in any::<bool>(),
        ideal in any::<bool>(),
    ) {
        let text = if dotted {
            FOUR_BAR_A.replace("[bodies.crank]\nmass ", "[bodies]\ncrank.mass ").replace(
                "inertia = 1.82e-4 ", "crank.inertia = 1.82e-4 ",
            )
        } else {
            FOUR_BAR_A.to_owned()
        };
        let text = if dotted { text.replacen("\npoints  = { A0 = [-", "\ncrank.points = { A0 = [-", 1) } else { text };
        let changes = changes(&[&format!("{key}={value}")], ideal);
        match Case::from_text(Path::new("x.toml"), &text, &changes) {
            Ok(case) => {
                let again = read(&case.text).unwrap();
                prop_assert_eq!(again.description, case.description);
                prop_assert_eq!(again.plan, case.plan);
            }
            Err(Error::NotAMechanism { .. }) => {}
            Err(other) => prop_assert!(false, "{}", other),
        }
    }
}

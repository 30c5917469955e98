//! What a user starts with: cases to change, completions for a shell, manual pages.

mod written;

use std::path::Path;
use std::process::Command;
use written::{freeplay, output};

/// Kinds of case that `freeplay new` writes, as its help lists them.
fn kinds() -> Vec<String> {
    let help = String::from_utf8(freeplay(&["new", "--help"]).stdout).unwrap();
    let kinds = help.lines().filter_map(|line| line.trim_start().strip_prefix("- "));
    let kinds: Vec<String> =
        kinds.map(|line| line.split(':').next().unwrap_or_default().to_owned()).collect();
    assert!(kinds.len() >= 5, "{help}");
    kinds
}

/// The program in a folder: exit code and what it says.
fn at(folder: &Path, arguments: &[&str]) -> (i32, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    let said = output(command.args(arguments).current_dir(folder));
    let words = [said.stdout, said.stderr].concat();
    (said.status.code().unwrap(), String::from_utf8(words).unwrap())
}

#[test]
fn every_new_case_checks_and_runs() {
    let folder = tempfile::tempdir().unwrap();
    for kind in kinds() {
        let case = format!("{kind}.toml");
        for arguments in [&["new", &kind][..], &["check", &case], &["run", &case]] {
            let (code, said) = at(folder.path(), arguments);
            assert_eq!(code, 0, "{arguments:?}: {said}");
        }
        let (_, summary) = at(folder.path(), &["summary", &format!("{kind}.h5")]);
        let text = std::fs::read_to_string(folder.path().join(&case)).unwrap();
        let loose = text.lines().any(|line| {
            line.starts_with("[joints.") && line.split('#').next().unwrap().contains(".clearance]")
        });
        let told = if loose { "contacts" } else { "no joint has clearance" };
        assert!(summary.contains("\ncomplete, ") && summary.contains(told), "{kind}: {summary}");
    }
}

#[test]
fn a_new_case_is_named_like_its_file_and_replaces_none() {
    let folder = tempfile::tempdir().unwrap();
    let new = ["new", "four-bar", "-o", "mine.toml"];
    let (code, said) = at(folder.path(), &new);
    assert_eq!((code, said.starts_with("mine.toml: ")), (0, true), "{said}");
    let (_, said) = at(folder.path(), &["check", "mine.toml"]);
    assert!(said.starts_with("mine: "), "{said}");

    std::fs::write(folder.path().join("mine.toml"), "changed").unwrap();
    assert_eq!(at(folder.path(), &new).0, 3);
    let kept = std::fs::read_to_string(folder.path().join("mine.toml")).unwrap();
    assert_eq!(kept, "changed");
    assert_eq!(at(folder.path(), &[&new[..], &["--force"]].concat()).0, 0);
}

#[test]
fn completions_know_the_commands_and_every_shell_takes_its_own() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let (code, script) = at(folder.path(), &["completions", shell]);
        assert_eq!(code, 0, "{script}");
        for word in ["certify", "require-digits"] {
            assert!(script.contains(word), "{shell} does not know {word}");
        }
    }
    let (_, script) = at(folder.path(), &["completions", "bash"]);
    assert!(script.contains("journal-in-bearing"));
    let ask = format!(
        "{script}\nCOMP_WORDS=(freeplay cer) COMP_CWORD=1\n\
         _freeplay freeplay cer freeplay\necho \"${{COMPREPLY[@]}}\""
    );
    let said = output(Command::new("bash").args(["-c", &ask]));
    assert_eq!(String::from_utf8(said.stdout).unwrap(), "certify\n");
}

#[test]
fn there_is_a_manual_page_of_the_program_and_of_each_command() {
    let folder = tempfile::tempdir().unwrap();
    let (code, said) = at(folder.path(), &["man", "-o", "man1"]);
    assert_eq!(code, 0, "{said}");
    let page = |name: &str| {
        let text = std::fs::read_to_string(folder.path().join("man1").join(name));
        text.unwrap_or_else(|error| panic!("{name}: {error}"))
    };
    assert!(page("freeplay.1").contains("freeplay\\-certify(1)"));
    for (command, option) in [("run", "tangent"), ("new", "output"), ("compare", "until")] {
        let page = page(&format!("freeplay-{command}.1"));
        assert!(page.contains(&format!(".TH freeplay-{command} 1")), "{page}");
        assert!(page.contains(&format!("\\fBfreeplay {command}\\fR")), "{page}");
        assert!(page.contains(&format!("\\-\\-{option}")), "{page}");
    }
    assert_eq!(at(folder.path(), &["man", "-o", "man1"]).0, 3, "pages stay");
    assert_eq!(at(folder.path(), &["man", "-o", "man1", "--force"]).0, 0);
}

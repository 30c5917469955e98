//! What the documents say of the program is so: commands and options, datasets with their
//! dimensions, links, versions; and every command of the tutorial runs.

mod written;

use clap::CommandFactory;
use freeplay::case::{Case, Changes};
use freeplay::cli::CommandLine;
use freeplay::contact::{Damping, rebound};
use freeplay::record::{DATASETS, Dimension};
use serde_json::Value;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::process::Command;
use written::{python, root, said_by};

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The documents that users read.
fn documents() -> Vec<PathBuf> {
    let docs = std::fs::read_dir(root().join("docs")).unwrap();
    let docs = docs.map(|entry| entry.unwrap().path());
    let more = ["README.md", "DESIGN.md", "CHANGELOG.md", "python/README.md"];
    let more = more.into_iter().map(|name| root().join(name));
    docs.chain(more).filter(|path| path.extension().is_some_and(|end| end == "md")).collect()
}

/// What stands between backquotes.
fn quoted(text: &str) -> Vec<&str> {
    text.split('`').skip(1).step_by(2).collect()
}

#[test]
fn format_md_tells_every_command_with_its_options() {
    let text = read("docs/format.md");
    let commands = text.split("\n## ").find(|part| part.starts_with("Commands")).unwrap();
    let mut missing = Vec::new();
    let program = CommandLine::command();
    for command in program.get_subcommands() {
        let name = command.get_name();
        let row = commands.lines().find(|line| {
            line.starts_with("| `freeplay ") && line.split([' ', '`']).any(|word| word == name)
        });
        let Some(row) = row else {
            missing.push(format!("a row | `freeplay {name}` | … | … |"));
            continue;
        };
        let told: Vec<&str> =
            quoted(row).into_iter().filter(|word| word.starts_with("--")).collect();
        let has: Vec<String> = command
            .get_arguments()
            .filter(|argument| argument.get_id() != "help" && !argument.is_hide_set())
            .filter_map(|argument| Some(format!("--{}", argument.get_long()?)))
            .collect();
        missing.extend(
            has.iter()
                .filter(|option| !told.contains(&option.as_str()))
                .map(|option| format!("{option} in the row of `freeplay {name}`")),
        );
        for option in told {
            assert!(has.iter().any(|known| known == option), "freeplay {name} has no {option}");
        }
    }
    assert!(missing.is_empty(), "docs/format.md lacks {missing:#?}");
}

/// Dimensions of each dataset that a table of docs/format.md has.
fn documented_datasets() -> HashMap<String, String> {
    let text = read("docs/format.md");
    let part = text.split("\n## ").find(|part| part.starts_with("Result file")).unwrap();
    let rows = part.lines().filter(|line| line.starts_with("| `"));
    let mut datasets = HashMap::new();
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        for name in quoted(cells[1]) {
            let earlier = datasets.insert(name.to_owned(), cells[2].to_owned());
            assert_eq!(earlier, None, "docs/format.md has {name} twice");
        }
    }
    datasets
}

#[test]
fn format_md_tells_every_dataset_with_its_dimensions() {
    let told = documented_datasets();
    for dataset in &DATASETS {
        let across = dataset.items().map_or(String::new(), |items| format!(", {}", items.name()));
        let dimensions = format!("{}{across}", dataset.rows().name());
        let found = told.get(dataset.name).map(String::as_str);
        assert_eq!(found, Some(dimensions.as_str()), "{} in docs/format.md", dataset.name);
    }
    let text = read("docs/format.md");
    for dimension in Dimension::ALL {
        assert!(quoted(&text).contains(&dimension.name()), "{}", dimension.name());
    }
}

#[test]
fn laws_md_tells_every_law_and_what_it_rebounds_at() {
    let text = read("docs/laws.md");
    for (word, law) in Damping::ALL {
        let row = text.lines().find(|line| line.starts_with(&format!("| `{word}` |")));
        let row = row.unwrap_or_else(|| panic!("docs/laws.md has no row of {word}"));
        assert!(row.contains(law.about().formula), "{word}: {row}");
        for e in [0.9, 0.5, 0.3] {
            let rebound = format!("{:.6}", rebound(law.weight(e)));
            assert!(row.contains(&rebound), "{word} at {e}: {rebound} in {row}");
        }
    }
    let sources = read("docs/bibliography.md");
    for (key, kinds) in [
        ("elastic", freeplay::contact::elastic::KINDS),
        ("law", freeplay::contact::viscous::KINDS),
        ("law", freeplay::friction::KINDS),
    ] {
        for kind in kinds {
            assert!(text.contains(&format!("| `{}` |", kind.word)), "{}", kind.word);
            let cited = format!("| `{key} = \"{}\"` |", kind.word);
            assert!(sources.contains(&cited), "docs/bibliography.md has no row {cited}");
        }
    }
}

/// Some datasets are known at the end of a run only, and stand in no table of the program.
#[test]
fn format_md_tells_the_datasets_of_certificates_and_tangents() {
    let told = documented_datasets();
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run.h5");
    let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    command.args(["run", "cases/four-bar-a.toml", "--tangent", "--set", "run.duration=1e-3", "-o"]);
    command.arg(&run).args(["--set", "observe.points=[\"coupler.B\"]"]);
    let bristles = "{law=\"dahl\", coefficient=0.1, stiffness=1e4}";
    command.args(["--set", &format!("joints.A.clearance.friction={bristles}")]);
    said_by(command.current_dir(root()));
    let mut expected: Vec<String> = told.keys().cloned().collect();
    expected.sort();
    let certified = folder.path().join("certified.h5");
    let mut command = Command::new(env!("CARGO_BIN_EXE_freeplay"));
    command.args(["certify", "cases/four-bar-a.toml", "--until", "1e-3", "-o"]);
    said_by(command.arg(&certified).current_dir(root()));
    for file in [run, certified] {
        for name in hdf5::File::open(&file).unwrap().member_names().unwrap() {
            let scale = Dimension::ALL.into_iter().any(|dimension| dimension.name() == name);
            assert!(scale || told.contains_key(&name), "docs/format.md lacks {name}");
            expected.retain(|known| *known != name);
        }
    }
    assert!(expected.is_empty(), "no run has {expected:?}, which docs/format.md tells");
}

#[test]
fn links_lead_somewhere() {
    for document in documents() {
        let text = std::fs::read_to_string(&document).unwrap();
        let links = text.split("](").skip(1).filter_map(|rest| rest.split(')').next());
        for link in links.filter(|link| !link.contains("://") && !link.starts_with('#')) {
            let path = document.parent().unwrap().join(link.split('#').next().unwrap());
            assert!(path.exists(), "{}: there is no {link}", document.display());
        }
    }
}

#[test]
fn files_that_are_named_are_there() {
    let folders = ["docs/", "scripts/", "cases/", "src/", "tests/", "python/", "./scripts/"];
    for document in documents() {
        let text = std::fs::read_to_string(&document).unwrap();
        for name in
            quoted(&text).into_iter().filter(|name| folders.iter().any(|f| name.starts_with(f)))
        {
            let plain = name.chars().all(|c| c.is_ascii_alphanumeric() || "./_-".contains(c));
            // cases are named without their ending, too
            let there = root().join(name).exists() || root().join(format!("{name}.toml")).exists();
            assert!(there || !plain, "{}: there is no {name}", document.display());
        }
    }
}

#[test]
fn versions_agree() {
    let version = env!("CARGO_PKG_VERSION");
    assert!(read("python/pyproject.toml").contains(&format!("\nversion = \"{version}\"\n")));
    assert!(read("CITATION.cff").contains(&format!("\nversion: {version}\n")));
    let rust = env!("CARGO_PKG_RUST_VERSION");
    assert!(read("README.md").matches(&format!("Rust {rust}")).count() >= 1);
    assert!(read("README.md").contains(&format!("({rust} or newer")));
}

#[test]
fn documents_use_plain_words() {
    for document in documents() {
        let text = std::fs::read_to_string(&document).unwrap().replace("ruling_", "");
        for word in ["ruling", "time stands still"] {
            assert!(!text.contains(word), "{}: {word}", document.display());
        }
    }
}

/// Blocks of a language in a document.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let opening = format!("```{language}\n");
    let blocks = text.split(opening.as_str()).skip(1);
    blocks.filter_map(|rest| Some(rest.split("```").next()?.to_owned())).collect()
}

/// The folder of the program, before all others on the path.
fn path() -> std::ffi::OsString {
    let folder = Path::new(env!("CARGO_BIN_EXE_freeplay")).parent().unwrap().to_owned();
    let others = std::env::var_os("PATH").unwrap_or_default();
    std::env::join_paths(std::iter::once(folder).chain(std::env::split_paths(&others))).unwrap()
}

#[test]
fn every_command_of_the_tutorial_runs() {
    let tutorial = read("docs/tutorial.md");
    let folder = tempfile::tempdir().unwrap();
    let commands = blocks(&tutorial, "sh");
    assert!(commands.len() > 8, "{commands:?}");
    for line in commands.iter().flat_map(|block| block.lines()) {
        let mut shell = Command::new("sh");
        said_by(shell.args(["-c", line]).current_dir(folder.path()).env("PATH", path()));
    }
    for made in ["rocker.html", "figures/force-A.svg", "figures/journal-path.svg"] {
        assert!(folder.path().join(made).exists(), "the tutorial names {made}");
    }
    for script in blocks(&tutorial, "python") {
        let mut command = Command::new(python());
        command.args(["-c", &script]).current_dir(folder.path()).env("PATH", path());
        command.env("PYTHONPATH", root().join("python")).env("PYTHONDONTWRITEBYTECODE", "1");
        let said = said_by(&mut command);
        assert!(said.contains("peak_force"), "{said}");
    }
}

#[test]
fn every_command_of_the_readme_s_start_runs() {
    let readme = read("README.md");
    let commands = blocks(&readme, "sh").into_iter().find(|block| block.contains("freeplay new"));
    let folder = tempfile::tempdir().unwrap();
    for line in commands.unwrap().lines() {
        let mut shell = Command::new("sh");
        said_by(shell.args(["-c", line]).current_dir(folder.path()).env("PATH", path()));
    }
    for script in blocks(&readme, "python").into_iter().rev() {
        let mut command = Command::new(python());
        let script = script.replace(".plot()", ".max()");
        command.args(["-c", &script]).current_dir(folder.path()).env("PATH", path());
        command.env("PYTHONPATH", root().join("python")).env("PYTHONDONTWRITEBYTECODE", "1");
        said_by(&mut command);
    }
}

/// The schema of a case file at a path of keys; `None` where it knows no such key.
fn schema_at<'a>(schema: &'a Value, keys: &[&str]) -> Option<&'a Value> {
    schema_below(schema, schema, keys)
}

fn schema_below<'a>(whole: &'a Value, at: &'a Value, keys: &[&str]) -> Option<&'a Value> {
    let at = schema_in(whole, at);
    let Some((key, rest)) = keys.split_first() else { return Some(at) };
    let next = at["properties"].get(key).or_else(|| at.get("additionalProperties"));
    let below = next.filter(|next| !next.is_boolean());
    let below = below.and_then(|next| schema_below(whole, next, rest));
    let alternatives = at["oneOf"].as_array().map_or(&[][..], Vec::as_slice);
    below.or_else(|| alternatives.iter().find_map(|at| schema_below(whole, at, keys)))
}

/// What a reference leads to.
fn schema_in<'a>(whole: &'a Value, at: &'a Value) -> &'a Value {
    let name = at["$ref"].as_str().and_then(|path| path.strip_prefix("#/$defs/"));
    name.map_or(at, |name| &whole["$defs"][name])
}

/// The schema of one kind of a part.
fn of_kind<'a>(family: &'a Value, kind: &str) -> &'a Value {
    let kinds = family["oneOf"].as_array().unwrap();
    let is = |schema: &&Value| {
        ["kind", "elastic", "law"].iter().any(|key| schema["properties"][key]["const"] == kind)
    };
    kinds.iter().find(is).unwrap()
}

fn schema() -> Value {
    freeplay::case::schema()
}

/// What the program says of a case with a key set to a word that it cannot know.
fn complaint(key: &str) -> String {
    complaint_after(&[], key)
}

/// The same with other changes made before; a key that has its value is set to that.
fn complaint_after(before: &[&str], key: &str) -> String {
    let text = read("cases/four-bar-a-friction.toml")
        + "\n[loads.gravity]\nkind = \"gravity\"\nacceleration = [0.0, -9.81]\n";
    let last = if key.contains('=') { key.to_owned() } else { format!("{key}=zzzzzzzz") };
    let set = before.iter().copied().chain([last.as_str()]);
    let set = set.map(|change| change.parse().unwrap()).collect();
    let read = Case::from_text(Path::new("case.toml"), &text, &Changes { set, ideal: false });
    read.expect_err(key).to_string()
}

#[test]
fn the_schema_of_cases_has_the_keys_that_the_program_reads() {
    let schema = schema();
    for table in [
        "",
        "ground",
        "bodies.crank",
        "joints.A",
        "joints.A.clearance",
        "joints.A.clearance.normal",
        "joints.A.clearance.friction",
        "drives.crank",
        "loads.gravity",
        "start.coupler",
        "run",
        "solver",
    ] {
        let keys: Vec<&str> = table.split('.').filter(|key| !key.is_empty()).collect();
        let dot = if table.is_empty() { "" } else { "." };
        let known = known(&format!("{table}{dot}zzzzzzzz"), &[]);
        let in_schema = schema_at(&schema, &keys).unwrap();
        let in_schema = match table {
            "joints.A" => of_kind(in_schema, "revolute"),
            "drives.crank" => of_kind(in_schema, "speed"),
            "loads.gravity" => of_kind(in_schema, "gravity"),
            "joints.A.clearance.normal" => of_kind(in_schema, "power"),
            "joints.A.clearance.friction" => of_kind(in_schema, "ambrosio"),
            _ => in_schema,
        };
        let told = properties(in_schema);
        assert_eq!(told, known, "{table} in the schema, and the keys that are read");
    }
}

/// The keys that the program knows beside one that it cannot know, with others set before.
fn known(key: &str, set: &[&str]) -> BTreeSet<String> {
    let said = complaint_after(set, key);
    let known = said.split("known here: ").nth(1).unwrap_or_else(|| panic!("{said}"));
    known.lines().next().unwrap().split(", ").map(str::to_owned).collect()
}

fn properties(schema: &Value) -> BTreeSet<String> {
    schema["properties"].as_object().unwrap().keys().cloned().collect()
}

#[test]
fn the_schema_of_cases_has_the_words_that_the_program_reads() {
    let schema = schema();
    for key in [
        "joints.A.clearance.tension",
        "joints.A.clearance.normal.law",
        "joints.A.clearance.normal.elastic",
        "joints.A.clearance.normal.stiffness",
        "run.sampling",
        "solver.engine",
        "solver.norm",
        "solver.absolute_tolerance",
    ] {
        let said = complaint(key);
        let line = said.lines().find(|line| line.contains(key)).unwrap();
        let must = line.split("must be ").nth(1).and_then(|rest| rest.split(", is ").next());
        let known: Vec<&str> = must.unwrap().split('"').skip(1).step_by(2).collect();
        let keys: Vec<&str> = key.split('.').collect();
        let at = schema_at(&schema, &keys).unwrap();
        let words = at.get("enum").unwrap_or_else(|| &at["oneOf"][1]["enum"]);
        let kinds: Value = freeplay::contact::elastic::KINDS.iter().map(|kind| kind.word).collect();
        let words = if key.ends_with(".elastic") { &kinds } else { words };
        // laws with a damping of their own have a schema each
        let mut words = words.as_array().unwrap().clone();
        if key.ends_with("normal.law") {
            words.extend(freeplay::contact::viscous::KINDS.iter().map(|kind| kind.word.into()));
        }
        assert_eq!(Value::from(words), serde_json::json!(known), "{key} in the schema");
    }
}

#[test]
fn the_schema_of_cases_knows_every_key_of_every_case() {
    let schema = schema();
    for folder in ["cases", "tests/cases", "tests/kinds", "src/cli/new"] {
        for entry in std::fs::read_dir(root().join(folder)).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "toml") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let case: toml_edit::DocumentMut = text.parse().unwrap();
            check_keys(&schema, case.as_table(), &mut Vec::new(), &path);
        }
    }
}

#[test]
fn the_example_of_every_kind_has_its_keys() {
    let schema = schema();
    let families = [
        freeplay::joint::KINDS,
        freeplay::load::KINDS,
        freeplay::course::KINDS,
        freeplay::contact::elastic::KINDS,
        freeplay::contact::viscous::KINDS,
        freeplay::friction::KINDS,
    ];
    for kind in families.concat() {
        let example: toml_edit::DocumentMut = kind.example.parse().unwrap();
        assert!(kind.example.contains(kind.word), "{}", kind.word);
        check_keys(&schema, example.as_table(), &mut Vec::new(), Path::new(kind.word));
    }
}

#[test]
fn the_examples_of_extending_are_the_files_that_are_compiled() {
    let text = read("docs/extending.md");
    let files = ["joint", "load", "course", "contact/damping", "contact/elastic", "friction"];
    for file in files.map(|room| format!("src/{room}/scratch.rs")) {
        assert!(text.contains(&format!("`{file}`:\n\n```rust\n{}```", read(&file))), "{file}");
    }
}

#[test]
fn the_tables_of_keys_are_those_that_the_program_prints() {
    let printed = |arguments: &[&str]| {
        said_by(Command::new(env!("CARGO_BIN_EXE_freeplay")).arg("schema").args(arguments))
    };
    let tables = printed(&["--markdown"]);
    assert!(tables == read("docs/cases.md"), "freeplay schema --markdown > docs/cases.md");
    let told = printed(&[]);
    assert!(told == read("docs/case.schema.json"), "freeplay schema > docs/case.schema.json");
}

/// Every key of a table, and of those in it, is in the schema.
fn check_keys(
    schema: &Value,
    table: &dyn toml_edit::TableLike,
    above: &mut Vec<String>,
    case: &Path,
) {
    for (key, item) in table.iter() {
        above.push(key.to_owned());
        let keys: Vec<&str> = above.iter().map(String::as_str).collect();
        assert!(schema_at(schema, &keys).is_some(), "{}: {above:?}", case.display());
        if let Some(table) = item.as_table_like() {
            check_keys(schema, table, above, case);
        }
        above.pop();
    }
}

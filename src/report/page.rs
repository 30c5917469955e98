//! The page's own parts: template, style and script, all in the binary.

use super::html::fill;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

const TEMPLATE: &str = include_str!("page/page.html");

/// uPlot 1.6.32, MIT; `page/vendor/README.md` tells where it is from.
const CHARTS_SCRIPT: &str = include_str!("page/vendor/uplot.js");
const CHARTS_STYLE: &str = include_str!("page/vendor/uplot.css");
const CHARTS_LICENCE: &str = include_str!("page/vendor/uplot.LICENSE");

const STYLE: &str = include_str!("page/page.css");

/// Modules of the script; each uses those above it, none below.
const MODULES: [(&str, &str); 17] = [
    ("format.js", include_str!("page/format.js")),
    ("theme.js", include_str!("page/theme.js")),
    ("unpack.js", include_str!("page/unpack.js")),
    ("run.js", include_str!("page/run.js")),
    ("clock.js", include_str!("page/clock.js")),
    ("pen.js", include_str!("page/pen.js")),
    ("mechanism.js", include_str!("page/mechanism.js")),
    ("stage.js", include_str!("page/stage.js")),
    ("dials.js", include_str!("page/dials.js")),
    ("strip.js", include_str!("page/strip.js")),
    ("transport.js", include_str!("page/transport.js")),
    ("axes.js", include_str!("page/axes.js")),
    ("quantities.js", include_str!("page/quantities.js")),
    ("charts.js", include_str!("page/charts.js")),
    ("paths.js", include_str!("page/paths.js")),
    ("film.js", include_str!("page/film.js")),
    ("main.js", include_str!("page/main.js")),
];

/// What the template is filled with; HTML, but for the title and the runs, all of it escaped.
pub(super) struct Content<'a> {
    pub title: &'a str,
    pub failures: &'a str,
    pub summary: &'a str,
    pub contacts: &'a str,
    pub what_was_run: &'a str,
    pub everything: &'a str,
    /// JSON that may stand in a `script` element.
    pub runs: &'a str,
    /// Program and version.
    pub program: &'a str,
}

/// The whole page.
pub(super) fn page(content: &Content<'_>) -> String {
    let script = script();
    let style = format!("{CHARTS_STYLE}\n{STYLE}");
    let policy = format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; \
         form-action 'none'",
        hash(&script),
        hash(&style)
    );
    fill(
        TEMPLATE,
        &[
            ("policy", &policy),
            ("style", &style),
            ("script", &script),
            ("title", content.title),
            ("failures", content.failures),
            ("summary", content.summary),
            ("contacts", content.contacts),
            ("what_was_run", content.what_was_run),
            ("everything", content.everything),
            ("runs", content.runs),
            ("program", content.program),
        ],
    )
}

/// A content security policy's name for an inline script or style.
pub(super) fn hash(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// One classic script of all modules: pages opened from a disk may load no other.
fn script() -> String {
    let modules: String = MODULES.iter().map(|(_, text)| classic(text)).collect();
    format!(
        "/*\nuPlot\n{CHARTS_LICENCE}\n*/\n{CHARTS_SCRIPT}\n(() => {{\n\"use strict\";\n{modules}}})();\n"
    )
}

/// A module without its imports and with its exports as plain declarations.
fn classic(module: &str) -> String {
    let lines = module.lines().filter(|line| !line.starts_with("import "));
    lines.flat_map(|line| [line.strip_prefix("export ").unwrap_or(line), "\n"]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_vendored_files_are_those_that_were_published() {
        let readme = include_str!("page/vendor/README.md");
        for (name, text) in [
            ("uplot.js", CHARTS_SCRIPT),
            ("uplot.css", CHARTS_STYLE),
            ("uplot.LICENSE", CHARTS_LICENCE),
        ] {
            let sha256: String =
                Sha256::digest(text.as_bytes()).iter().map(|b| format!("{b:02x}")).collect();
            let row = readme.lines().find(|line| line.contains(&format!("`{name}`")));
            let row = row.unwrap_or_else(|| panic!("vendor/README.md does not name {name}"));
            assert!(row.contains(&sha256), "{name} has SHA-256 {sha256}, told is: {row}");
        }
        assert!(CHARTS_SCRIPT.contains("uPlot (v1.6.32)"));
        assert!(readme.contains("1.6.32"));
    }

    #[test]
    fn nothing_in_script_or_style_ends_its_element() {
        assert!(!script().to_lowercase().contains("</script"));
        assert!(!script().contains("<!--"));
        assert!(!STYLE.to_lowercase().contains("</style"));
        assert!(!CHARTS_STYLE.to_lowercase().contains("</style"));
    }

    #[test]
    fn modules_import_only_modules_above_them() {
        for (place, (name, text)) in MODULES.iter().enumerate() {
            for line in text.lines().filter(|line| line.starts_with("import ")) {
                let above = MODULES[..place].iter();
                let known =
                    above.clone().any(|(other, _)| line.ends_with(&format!("\"./{other}\";")));
                assert!(known, "{name}: {line}");
            }
            assert!(text.len() < 24_000, "{name} is {} bytes", text.len());
        }
    }

    #[test]
    fn no_two_modules_declare_the_same_name() {
        let mut seen = std::collections::BTreeMap::new();
        for (module, text) in MODULES {
            for line in classic(text).lines() {
                let mut words = line.split(|c: char| !c.is_alphanumeric() && c != '_');
                let word = words.next().unwrap_or_default();
                if ["const", "let", "function", "class"].contains(&word) {
                    let name = words.next().unwrap_or_default().to_owned();
                    let before = seen.insert(name.clone(), module);
                    assert!(before.is_none(), "{name} is in {module} and {before:?}");
                }
            }
        }
    }

    #[test]
    fn the_script_names_no_address_but_that_of_its_charts_in_a_comment() {
        let own: String = MODULES.iter().map(|(_, text)| *text).collect();
        assert!(!own.contains("http") && !own.contains("//cdn"));
        assert_eq!(CHARTS_SCRIPT.matches("http").count(), 1);
    }
}

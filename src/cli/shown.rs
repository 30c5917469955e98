//! Text as it may go to a terminal.
//!
//! Titles, names and paths come from files, and files from strangers. What a terminal would take for
//! an order (control characters) or what turns words about (marks of direction, of no width) is shown
//! by its number. Line feeds pass here: who prints a text that must stay in its line has
//! [`one_line`](crate::model::one_line).

use crate::model::is_order;

/// Letters of a line that are shown; no message of ours is as long.
const LONGEST_LINE: usize = 4000;

/// A text for people.
pub(super) fn text(raw: &str) -> String {
    escaped(raw, |c| c.escape_unicode().to_string())
}

/// A text in JSON, which stays JSON.
pub(super) fn json(raw: &str) -> String {
    escaped(raw, |c| format!("\\u{:04x}", c as u32))
}

fn escaped(raw: &str, escape: impl Fn(char) -> String) -> String {
    let mut shown = String::with_capacity(raw.len());
    for c in raw.chars() {
        match is_order(c) && c != '\n' && c != '\t' {
            true => shown.push_str(&escape(c)),
            false => shown.push(c),
        }
    }
    shown
}

/// A message: lines behind the first are set in, so that none can be taken for another message.
pub(super) fn message(raw: &str) -> String {
    let lines = raw.lines().enumerate().map(|(number, line)| {
        let margin = if number > 0 && !line.starts_with("  ") { "  " } else { "" };
        let line = match line.char_indices().nth(LONGEST_LINE) {
            Some((end, _)) => format!("{}…", &line[..end]),
            None => line.to_owned(),
        };
        format!("{margin}{}", text(&line))
    });
    lines.collect::<Vec<_>>().join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown_and_words_stay() {
        assert_eq!(text("δ ≤ c\n\t9 %"), "δ ≤ c\n\t9 %");
        assert_eq!(text("\x1b[31m\r\u{9b}2J\u{7f}"), "\\u{1b}[31m\\u{d}\\u{9b}2J\\u{7f}");
        assert_eq!(text("a\u{202e}b\u{200b}"), "a\\u{202e}b\\u{200b}");
    }

    #[test]
    fn json_stays_json() {
        let told = json(&serde_json::json!({ "title": "\u{9b}\x1b\u{202e}\n" }).to_string());
        assert!(told.is_ascii(), "{told}");
        let read: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert_eq!(read["title"], "\u{9b}\x1b\u{202e}\n");
    }

    #[test]
    fn no_line_of_a_message_looks_like_another_message() {
        let faked = message("cannot read a\nerror: all is lost\n  line 3");
        assert_eq!(faked, "cannot read a\n  error: all is lost\n  line 3");
        assert!(message(&"x".repeat(1_000_000)).len() < 5000);
    }
}

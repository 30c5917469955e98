//! Text into HTML.

/// Text as HTML shows it, in elements and in attributes between double quotes.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            // No characters of HTML, and orders for a terminal that the page is shown on.
            c if c.is_control() && !matches!(c, '\n' | '\r' | '\t') => escaped.push('\u{fffd}'),
            c => escaped.push(c),
        }
    }
    escaped
}

/// JSON that may stand in a `script` element: nothing in it ends the element.
pub(super) fn json_in_script(json: &str) -> String {
    // `<` stands in strings only, where JSON knows this escape.
    json.replace('<', "\\u003c")
}

/// Fills the markers `{{name}}` of a template in one pass, so that what is put in is never taken
/// for a marker. Values are HTML already.
pub(super) fn fill(template: &str, values: &[(&str, &str)]) -> String {
    let mut filled = String::new();
    let mut rest = template;
    while let Some((before, after)) = rest.split_once("{{") {
        filled.push_str(before);
        let name = after.split_once("}}").map(|(name, behind)| {
            rest = behind;
            name
        });
        let value = values.iter().find(|(known, _)| Some(*known) == name);
        assert!(value.is_some(), "the template has a marker {name:?} that nothing fills");
        filled.push_str(value.map_or("", |(_, value)| value));
    }
    filled.push_str(rest);
    filled
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_leave_its_element_or_attribute() {
        assert_eq!(escape("<b title=\"x\" id='y'>&\0"), {
            "&lt;b title=&quot;x&quot; id=&#39;y&#39;&gt;&amp;\u{fffd}"
        });
    }

    #[test]
    fn json_cannot_end_its_script() {
        let json = serde_json::to_string("</script><!-- {{runs}}").unwrap();
        let embedded = json_in_script(&json);
        assert!(!embedded.contains('<'));
        let back: String = serde_json::from_str(&embedded).unwrap();
        assert_eq!(back, "</script><!-- {{runs}}");
    }

    #[test]
    fn markers_in_values_are_left_alone() {
        let filled = fill("<{{a}}|{{b}}>", &[("a", "{{b}}"), ("b", "{{a}} {{")]);
        assert_eq!(filled, "<{{b}}|{{a}} {{>");
    }

    #[test]
    #[should_panic(expected = "nothing fills")]
    fn a_marker_that_nothing_fills_is_a_bug() {
        fill("{{c}}", &[("a", "")]);
    }
}

//! Texts of files as people may safely see them: on a terminal, in a picture, on a page.

/// The same text with control characters, and those that turn the direction of writing, escaped.
/// Files hold them by accident and by malice.
pub(super) fn shown(text: &str) -> String {
    let turns = |c: char| matches!(c, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let escaped = |c: char| match c {
        c if c.is_control() || turns(c) => c.escape_default().to_string(),
        c => c.to_string(),
    };
    text.chars().map(escaped).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_reaches_a_terminal_but_what_can_be_read() {
        assert_eq!(shown("Réflexion \"a\\b\""), "Réflexion \"a\\b\"");
        assert_eq!(
            shown("\x1b[31mred\u{7}\u{9b}1m\u{202e}"),
            "\\u{1b}[31mred\\u{7}\\u{9b}1m\\u{202e}"
        );
        assert_eq!(shown("two\nlines"), "two\\nlines");
    }
}

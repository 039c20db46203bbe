//! Text for people.

/// Text with its control characters made visible: what comes out of a file must not move a cursor,
/// set a clipboard or hide a name.
pub(crate) fn shown(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for character in text.chars() {
        if is_hidden(character) {
            shown.extend(character.escape_default());
        } else {
            shown.push(character);
        }
    }
    shown
}

/// Lines of such text.
pub fn shown_lines(text: &str) -> String {
    text.split('\n').map(shown).collect::<Vec<_>>().join("\n")
}

/// Control characters, and those that turn the direction of the text around them (Unicode 15,
/// Bidi_Control).
fn is_hidden(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{61c}' | '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_reaches_a_terminal_but_what_can_be_read() {
        assert_eq!(shown("a\x1b[31mb\x07\u{9b}"), "a\\u{1b}[31mb\\u{7}\\u{9b}");
        assert_eq!(shown("\u{202e}gnp.exe"), "\\u{202e}gnp.exe");
        assert_eq!(shown("Réflexion \"a\\b\" μm 漢字"), "Réflexion \"a\\b\" μm 漢字");
        assert_eq!((shown("a\nb"), shown_lines("a\n\x07b")), ("a\\nb".into(), "a\n\\u{7}b".into()));
    }
}

//! Protection against terminal escape injection: control characters of text from files, arguments and sessions become visible.
//!
//! In: any text. Out: the same text with its control and direction characters escaped. Printed raw, control characters move
//! the cursor, set the window title and write to the clipboard (CVE-2003-0063), and direction overrides reorder the line
//! that a person reads (CVE-2021-42574).

use std::borrow::Cow;
use std::fmt::Write;

/// Whether the character is a control, a line separator, a direction override, or invisible. Joiners (U+200C, U+200D) and
/// direction marks (U+200E, U+200F) stay: words and emoji need them, and they affect their neighbours only.
pub fn is_unprintable(c: char) -> bool {
    let in_text = matches!(c, '\n' | '\t');
    let separator = matches!(c, '\u{2028}' | '\u{2029}');
    let direction = matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let invisible = matches!(c, '\u{200b}' | '\u{2060}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}');
    c.is_control() && !in_text || separator || direction || invisible
}

/// Text for people: ESC becomes `\u{1b}`.
pub fn text(text: &str) -> Cow<'_, str> {
    escaped(text, |out, c| {
        // Writing to a string cannot fail.
        let _ = write!(out, "\\u{{{:x}}}", u32::from(c));
    })
}

/// JSON for programs: ESC becomes `\u001b`, so the string's value stays. Valid JSON holds these characters in strings only.
pub fn json(text: &str) -> Cow<'_, str> {
    escaped(text, |out, c| {
        for unit in c.encode_utf16(&mut [0; 2]) {
            let _ = write!(out, "\\u{unit:04x}");
        }
    })
}

fn escaped(text: &str, escape: impl Fn(&mut String, char)) -> Cow<'_, str> {
    if !text.contains(is_unprintable) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_unprintable(c) { escape(&mut out, c) } else { out.push(c) }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn escapes_are_shown_and_words_stay() {
        assert_eq!(text("a\x1b[31mb\u{9b}2J\x07\x7f\r\n\tc"), "a\\u{1b}[31mb\\u{9b}2J\\u{7}\\u{7f}\\u{d}\n\tc");
        assert_eq!(text("\u{202e}txt.exe\u{2066}\u{feff}"), "\\u{202e}txt.exe\\u{2066}\\u{feff}");
        assert_eq!(json("\"\u{7f}\u{9b}\u{202e}\u{e0041}\""), r#""\u007f\u009b\u202e\udb40\udc41""#);
        for plain in ["schöne Vase → 0.4 m · ½", "日本語", "می\u{200c}خواهم", "👩\u{200d}🚀"] {
            assert!(matches!(text(plain), Cow::Borrowed(same) if same == plain));
        }
    }

    proptest! {
        #[test]
        fn nothing_unprintable_is_left(any in ".*") {
            prop_assert!(!text(&any).contains(is_unprintable));
        }

        #[test]
        fn json_reads_back_as_it_was(any in proptest::collection::vec(any::<char>(), 0..40)) {
            let any: String = any.into_iter().collect();
            let written = serde_json::to_string(&any).unwrap();
            let safe = json(&written);
            prop_assert!(!safe.contains(is_unprintable));
            prop_assert_eq!(serde_json::from_str::<String>(&safe).unwrap(), any);
        }
    }
}

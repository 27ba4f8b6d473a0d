//! What holds for any text.

use super::*;
use proptest::prelude::*;

/// Words of the lexicon, numbers, units, and words that nobody knows, in any order.
fn request() -> impl Strategy<Value = String> {
    let known: Vec<String> = lexicon::SECTIONS.iter().flat_map(|s| s.entries).flat_map(|e| e.words.split('|')).map(str::to_owned).collect();
    let word = prop_oneof![
        6 => proptest::sample::select(known),
        1 => proptest::sample::select(vec!["vase", "the vase", "it", "0.5", "3", "30 cm", "2 m/s", "90 degrees", "10 kPa", "20 %", "v2", "at 1 s", "half"]).prop_map(str::to_owned),
        1 => "[a-z]{1,9}",
        1 => "\\PC{1,4}",
    ];
    proptest::collection::vec(word, 0..9).prop_map(|words| words.join(" "))
}

fn reported(reply: &Reply) -> Vec<String> {
    match reply {
        Reply::Edits { not_understood, .. } | Reply::Refused { not_understood, .. } => not_understood.clone(),
        _ => Vec::new(),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, failure_persistence: None, ..ProptestConfig::default() })]

    /// No text panics, the same text gives the same reply, the words reported are the text's own, and the
    /// spec takes the edits.
    #[test]
    fn any_request(text in request(), undone in any::<bool>()) {
        let text = if undone { format!("undo that and {text}") } else { text };
        let stage = Stage::vase().with_table().then("make it jump").then("push it left at 0.5 s and wind from the left");
        let reply = stage.ask(&text);
        prop_assert_eq!(&reply, &stage.ask(&text));
        for word in reported(&reply) {
            prop_assert!(text.contains(&word), "{} is not in {}", word, text);
        }
        if let Reply::Edits { edits, .. } = &reply {
            prop_assert!(stage.spec.apply(edits).is_ok());
        }
    }

    /// Bytes of any kind do not panic either.
    #[test]
    fn any_text(text in "\\PC*") {
        let _ = Stage::vase().ask(&text);
    }

    /// A word that nobody knows is reported, or taken for the only object and said so, whatever stands around it.
    #[test]
    fn unknown_words_are_reported(before in request(), after in request()) {
        let text = format!("{before} zzyzxq {after}");
        if let reply @ (Reply::Edits { .. } | Reply::Refused { .. }) = Stage::vase().ask(&text) {
            let presumed = matches!(&reply, Reply::Edits { gloss, .. } if gloss.iter().any(|g| g.contains("zzyzxq")));
            prop_assert!(presumed || reported(&reply).contains(&"zzyzxq".to_owned()), "{:?} to {}", reply, text);
        }
    }
}

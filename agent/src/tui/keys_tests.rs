//! Every key that the REPL knows, in every split, and bytes that no terminal should send.

use super::*;
use proptest::prelude::*;

const CTRL_C_KEY: Input = Input::Key(KeyEvent::new(KeyCode::Char('c'), KeyModifiers::CONTROL));

fn key_of(code: KeyCode, modifiers: KeyModifiers) -> Input {
    Input::Key(KeyEvent::new(code, modifiers))
}

fn pasted(text: &str) -> Input {
    Input::Paste { text: text.to_owned(), lost: 0 }
}

/// Everything that the bytes come to, all at once, and what was open once its time is over.
fn decoded(bytes: &[u8]) -> Vec<Input> {
    let (mut decoder, now) = (Decoder::default(), Instant::now());
    let mut inputs = decoder.feed(bytes, now);
    while let Some(end) = decoder.deadline() {
        inputs.extend(decoder.expire(end));
    }
    inputs
}

/// What terminals send for the keys that the REPL uses: xterm, tmux, the Linux console, rxvt, kitty's CSI u.
fn keys() -> Vec<(&'static [u8], Input)> {
    use KeyCode as K;
    let (none, alt, control, shift) = (KeyModifiers::NONE, KeyModifiers::ALT, KeyModifiers::CONTROL, KeyModifiers::SHIFT);
    let table: Vec<(&'static [u8], KeyCode, KeyModifiers)> = vec![
        (b"a", K::Char('a'), none),
        (b"A", K::Char('A'), shift),
        ("ß".as_bytes(), K::Char('ß'), none),
        ("日".as_bytes(), K::Char('日'), none),
        ("🚀".as_bytes(), K::Char('🚀'), none),
        (b"\r", K::Enter, none),
        (b"\x1b\r", K::Enter, alt),
        (b"\x1b[13;2u", K::Enter, shift),
        (b"\t", K::Tab, none),
        (b"\x1b[Z", K::BackTab, shift),
        (b"\n", K::Char('j'), control),
        (b"\x03", K::Char('c'), control),
        (b"\x1b[99;5u", K::Char('c'), control),
        (b"\x04", K::Char('d'), control),
        (b"\x0c", K::Char('l'), control),
        (b"\x17", K::Char('w'), control),
        (b"\x7f", K::Backspace, none),
        (b"\x1b\x7f", K::Backspace, alt),
        (b"\x1b", K::Esc, none),
        (b"\x1b[27u", K::Esc, none),
        (b"\x1b[A", K::Up, none),
        (b"\x1bOA", K::Up, none),
        (b"\x1b[B", K::Down, none),
        (b"\x1b[C", K::Right, none),
        (b"\x1b[D", K::Left, none),
        (b"\x1b[1;3D", K::Left, alt),
        (b"\x1b[1;5C", K::Right, control),
        (b"\x1b[H", K::Home, none),
        (b"\x1bOH", K::Home, none),
        (b"\x1b[1~", K::Home, none),
        (b"\x1b[F", K::End, none),
        (b"\x1b[4~", K::End, none),
        (b"\x1b[8~", K::End, none),
        (b"\x1b[3~", K::Delete, none),
        (b"\x1b[5~", K::PageUp, none),
        (b"\x1b[6~", K::PageDown, none),
        (b"\x1bp", K::Char('p'), alt),
        (b"\x1b3", K::Char('3'), alt),
        (b"\x1b,", K::Char(','), alt),
        (b"\x1b.", K::Char('.'), alt),
        (b"\x1b[112;3u", K::Char('p'), alt),
        ("\x1bö".as_bytes(), K::Char('ö'), alt),
        (b"\x1b[", K::Char('['), alt),
        (b"\x1bO", K::Char('O'), alt),
        (b"\x1b_", K::Char('_'), alt),
        (b"\x1bOP", K::F(1), none),
        (b"\x1b[[B", K::F(2), none),
        (b"\x1b[15~", K::F(5), none),
    ];
    table.into_iter().map(|(bytes, code, modifiers)| (bytes, key_of(code, modifiers))).collect()
}

#[test]
fn every_key_is_known_however_its_bytes_are_split() {
    for (bytes, key) in keys() {
        assert_eq!(decoded(bytes), std::slice::from_ref(&key), "{:?}", String::from_utf8_lossy(bytes));
        for at in 0..bytes.len() {
            let (mut decoder, now) = (Decoder::default(), Instant::now());
            let mut inputs = decoder.feed(&bytes[..at], now);
            inputs.extend(decoder.feed(&bytes[at..], now));
            inputs.extend(decoder.expire(now + SEQUENCE));
            assert_eq!(inputs, std::slice::from_ref(&key), "{:?} split at {at}", String::from_utf8_lossy(bytes));
        }
    }
}

#[test]
fn escape_is_a_key_after_a_twentieth_of_a_second() {
    let (mut decoder, now) = (Decoder::default(), Instant::now());
    let escape = key_of(KeyCode::Esc, KeyModifiers::NONE);
    assert_eq!(decoder.feed(b"\x1b", now), []);
    assert_eq!(decoder.deadline(), Some(now + ESCAPE));
    assert_eq!(decoder.expire(now + ESCAPE / 2), []);
    assert_eq!(decoder.expire(now + ESCAPE), std::slice::from_ref(&escape));
    assert_eq!(decoder.deadline(), None);
    assert_eq!(decoded(b"\x1b\x1b"), [escape.clone(), escape.clone()]);
    assert_eq!(decoded(b"\x1b\x1b[A"), [escape, key_of(KeyCode::Up, KeyModifiers::NONE)]);
}

#[test]
fn a_paste_is_one_input_and_its_end_may_be_split() {
    let bytes = "\x1b[200~push it\r\n[201~ \x1b[31mleft ö\x1b[201~x".as_bytes();
    let whole = [pasted("push it\r\n[201~ \x1b[31mleft ö"), key_of(KeyCode::Char('x'), KeyModifiers::NONE)];
    assert_eq!(decoded(bytes), whole);
    for at in 0..bytes.len() {
        let (mut decoder, now) = (Decoder::default(), Instant::now());
        let mut inputs = decoder.feed(&bytes[..at], now);
        inputs.extend(decoder.feed(&bytes[at..], now));
        assert_eq!(inputs, whole, "split at {at}");
    }
    assert_eq!(decoded(b"\x1b[200~\x1b[201~\x1b[201~"), [], "an empty paste, and an end too many");
}

#[test]
fn a_paste_without_an_end_ends_a_second_after_its_text() {
    let (mut decoder, start) = (Decoder::default(), Instant::now());
    assert_eq!(decoder.feed(b"\x1b[200~jump\x03", start), []);
    // Ctrl-C pressed over and over does not keep it open.
    assert_eq!(decoder.feed(b"\x03", start + PASTE / 2), []);
    assert_eq!(decoder.expire(start + PASTE / 2), []);
    assert_eq!(decoder.expire(start + PASTE), [pasted("jump"), CTRL_C_KEY, CTRL_C_KEY]);
    assert_eq!(decoder.feed(b"\x03\x1b[201~", start + PASTE), [CTRL_C_KEY]);
}

#[test]
fn a_paste_holds_a_mebibyte_and_counts_what_is_lost() {
    let mut bytes = PASTE_BEGIN.to_vec();
    bytes.resize(bytes.len() + PASTE_BYTES + 7, b'x');
    bytes.extend_from_slice(PASTE_END);
    match decoded(&bytes).as_slice() {
        [Input::Paste { text, lost: 7 }] => assert_eq!(text.len(), PASTE_BYTES),
        other => panic!("{} inputs", other.len()),
    }
}

#[test]
fn reports_of_the_terminal_are_no_keys() {
    for report in ["\x1b_Gi=31;OK\x1b\\", "\x1b[?62;22c", "\x1b[<0;0;0M", "\x1b[0;0;0M", "\x1b[M", "\x1b[I", "\x1b[?1u"] {
        assert_eq!(decoded(report.as_bytes()), [], "{report:?}");
    }
}

/// Bytes that lead somewhere: parts of sequences, and any others.
fn bytes() -> impl Strategy<Value = Vec<u8>> {
    let parts: Vec<&'static [u8]> =
        vec![b"\x1b", b"\x1b[", b"\x1b[200~", b"\x1b[201~", b"\x1bO", b"\x1b_G", b"[", b"1;5", b"~", b"u", b"M", b"\xe6", b"\xff", b"\x03"];
    let part = prop_oneof![proptest::sample::select(parts).prop_map(<[u8]>::to_vec), proptest::collection::vec(any::<u8>(), 0..12)];
    proptest::collection::vec(part, 0..20).prop_map(|parts| parts.concat())
}

/// What the REPL takes for Ctrl-C: Esc before it makes it Alt too.
fn is_interrupt(input: &Input) -> bool {
    matches!(input, Input::Key(key) if key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL))
}

proptest! {
    #[test]
    fn nothing_deafens_it(bytes in bytes(), cuts in proptest::collection::vec(0usize..200, 0..6)) {
        let (mut decoder, now) = (Decoder::default(), Instant::now());
        let mut cuts: Vec<usize> = cuts.into_iter().map(|cut| cut.min(bytes.len())).chain([0, bytes.len()]).collect();
        cuts.sort_unstable();
        let mut split: Vec<Input> = cuts.windows(2).flat_map(|cut| decoder.feed(&bytes[cut[0]..cut[1]], now)).collect();
        // Ctrl-C is heard at once, or, in an open paste, a second later.
        let mut after = decoder.feed(b"\x03", now);
        after.extend(decoder.expire(now + PASTE));
        prop_assert!(after.last().is_some_and(is_interrupt), "{after:?}");
        prop_assert_eq!(decoder.deadline(), None);
        // How the bytes are split does not matter.
        let mut whole = Decoder::default();
        let mut all = whole.feed(&[bytes.as_slice(), b"\x03"].concat(), now);
        all.extend(whole.expire(now + PASTE));
        split.extend(after);
        prop_assert_eq!(split, all);
    }
}

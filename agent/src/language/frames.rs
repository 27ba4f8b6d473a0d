//! Frames of film as times: "at frame 25", "for 100 frames", "from frame 10 to frame 20". They become seconds before
//! anything else is read, so that whatever takes a time takes a frame.

use super::numbers;
use super::tokens::Token;

/// Rewrites counts of frames as seconds, by the request's own frames a second where it gives them, else by `fps`. What
/// was counted so, as sentences.
pub fn count(tokens: &mut [Token], fps: u32) -> Vec<String> {
    let said = (1..tokens.len()).find_map(|i| tokens[i - 1].number.filter(|_| tokens[i].word == "fps"));
    let fps = said.unwrap_or(f64::from(fps)).max(1.0);
    let mut notes = Vec::new();
    let mut at = 0;
    while at + 1 < tokens.len() {
        let one = |at: usize| numbers::number(tokens, at).filter(|(_, end)| *end == at + 1).map(|(value, _)| value);
        let counted = if is_frame(tokens, at) && one(at + 1).is_some() {
            one(at + 1)
        } else if is_frame(tokens, at + 1) && !is_rate(tokens, at + 2) {
            one(at)
        } else {
            None
        };
        let Some(frames) = counted else {
            at += 1;
            continue;
        };
        // "Frames 10 to 20", "10 to 20 frames": the other end is in frames too.
        let other = if is_frame(tokens, at) { at + 3 } else { at.wrapping_sub(2) };
        let between = if is_frame(tokens, at) { at + 2 } else { at.wrapping_sub(1) };
        let joined = tokens.get(between).is_some_and(|t| matches!(t.word.as_str(), "to" | "until" | "till" | "and"));
        let counted = is_frame(tokens, other.wrapping_add(1)) || is_frame(tokens, other);
        if joined && let Some(token) = tokens.get_mut(other).filter(|t| t.number.is_some() && !counted) {
            token.number = token.number.map(|frames| frames / fps);
        }
        let (frames_said, time) = (super::say::short(frames), super::say::seconds(frames / fps));
        notes.push(if is_frame(tokens, at) { format!("frame {frames_said} is at {time}") } else { format!("{frames_said} frames are {time}") });
        tokens[at].number = Some(frames / fps);
        tokens[at].word = (frames / fps).to_string();
        tokens[at + 1].number = None;
        "s".clone_into(&mut tokens[at + 1].word);
        at += 2;
    }
    notes
}

fn is_frame(tokens: &[Token], at: usize) -> bool {
    tokens.get(at).is_some_and(|t| matches!(t.word.as_str(), "frame" | "frames"))
}

/// Whether frames are counted per second here: "24 frames a second".
fn is_rate(tokens: &[Token], at: usize) -> bool {
    let word = |i: usize| tokens.get(i).map_or("", |t| t.word.as_str());
    match word(at) {
        "per" | "/" | "each" | "rate" => true,
        "a" | "every" => matches!(word(at + 1), "second" | "s" | "sec"),
        _ => false,
    }
}

//! Phrases and what they become: one row a phrase. Turns before the last are separated by `|`; what a row speaks of is a
//! vase one metre high (on a table, where the row says "table").

use super::*;

/// Asks the last turn of a row, the others having been made.
fn ask(row: &str) -> String {
    let turns: Vec<&str> = row.split(" | ").collect();
    let mut stage = if row.contains("table") { Stage::vase().with_table() } else { Stage::vase() };
    for turn in &turns[..turns.len() - 1] {
        stage = stage.then(turn);
    }
    let reply = stage.ask(turns[turns.len() - 1]);
    if let Reply::Edits { edits, .. } = &reply {
        stage.spec.apply(edits).unwrap_or_else(|e| panic!("{row}: {e:?}"));
    }
    line(&reply)
}

fn check(rows: &[(&str, &str)]) {
    let wrong: Vec<String> = rows
        .iter()
        .map(|(row, expected)| (row, expected, ask(row)))
        .filter(|(_, e, a)| a != *e)
        .map(|(r, e, a)| format!("{r}\n   expected {e}\n   got      {a}"))
        .collect();
    assert!(wrong.is_empty(), "{} of {} rows\n{}", wrong.len(), rows.len(), wrong.join("\n"));
}

#[test]
fn core() {
    check(&[
        ("Elastic vase jumps and falls.", "velocity_m_s = [0.0 0.0 2.80143]"),
        ("make the vase jump up and fall back", "velocity_m_s = [0.0 0.0 2.80143]"),
        ("make the vase jump and fall back to the table", "velocity_m_s = [0.0 0.0 2.80143]"),
        ("push the vase forward", "velocity_m_s = [1.5 0.0 0.0]"),
        ("softer", "young_pa = 100000.0"),
        ("stiffer", "young_pa = 400000.0"),
        ("do it on the moon", "gravity_m_s2 = [0.0 0.0 -1.62]"),
        ("push it to the left at 0.5 s", "+event {name:push1 at_s:0.5 object:vase push_m_s:[0.0 1.5 0.0]}"),
        ("undo that", "undo 1"),
    ]);
}

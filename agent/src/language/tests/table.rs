//! The table of phrases, and what a table cannot say: several objects, the gloss, refusals that name a reason.

use super::*;

const ROWS: &str = include_str!("phrases.txt");

/// Asks the last turn of a row, the others having been made; its edits must be ones that the spec takes.
fn ask(row: &str) -> Reply {
    let turns: Vec<&str> = row.split(" | ").collect();
    let mut stage = if row.contains("table") { Stage::vase().with_table() } else { Stage::vase() };
    for turn in &turns[..turns.len() - 1] {
        stage = stage.then(turn);
    }
    let reply = stage.ask(turns[turns.len() - 1]);
    if let Reply::Edits { edits, .. } = &reply {
        stage.spec.apply(edits).unwrap_or_else(|e| panic!("{row}: {e:?}"));
    }
    reply
}

/// Whether a reply is what a row expects: its line, or " ~ " and what its reason holds.
fn is_as(reply: &Reply, expected: &str) -> bool {
    match (expected.split_once(" ~ "), reply) {
        (Some((what, why)), Reply::Refused { reason, .. }) => line(reply).starts_with(what) && reason.contains(why),
        (Some(_), _) => false,
        (None, reply) => line(reply) == expected,
    }
}

#[test]
fn phrases_become_edits() {
    let rows: Vec<(&str, &str)> = ROWS.lines().filter(|l| !l.starts_with('#')).filter_map(|l| l.split_once(" =>")).collect();
    assert!(rows.len() >= 300, "{} rows", rows.len());
    let wrong: Vec<String> = rows
        .iter()
        .map(|(row, expected)| (row, expected.trim(), ask(row)))
        .filter(|(_, expected, actual)| !is_as(actual, expected))
        .map(|(row, expected, actual)| format!("{row}\n   expected {expected}\n   got      {}\n            {}", line(&actual), said(&actual)))
        .collect();
    assert!(wrong.is_empty(), "{} of {} rows\n{}", wrong.len(), rows.len(), wrong.join("\n"));
}

/// What a reply says, whatever it is.
fn said(reply: &Reply) -> String {
    match reply {
        Reply::Edits { .. } | Reply::Refused { .. } => gloss(reply),
        other => format!("{other:?}"),
    }
}

fn gloss(reply: &Reply) -> String {
    match reply {
        Reply::Edits { gloss, .. } => gloss.join("; "),
        Reply::Refused { reason, .. } => reason.clone(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_jump_is_the_speed_that_reaches_its_height() {
    for (text, height_m, gravity) in
        [("jump 30 cm", 0.3, 9.81), ("jump 2 ft on the moon", 0.6096, 1.62), ("jump half a metre in zero gravity", 0.5, 9.81)]
    {
        let stage = Stage::vase().then(text);
        let up = stage.spec.objects[0].velocity_m_s[2];
        assert!((up * up / (2.0 * gravity) - height_m).abs() < 1e-5, "{text}: {up}");
    }
}

#[test]
fn a_course_is_led_by_the_base_and_comes_back() {
    let stage = Stage::vase().then("carry it in a circle of 30 cm for 4 s");
    let pin = &stage.spec.pins[0];
    let round = |i: usize| pin.path[i].map(|x| (x * 1e3).round() / 1e3);
    assert_eq!((pin.name.as_str(), pin.path.len()), ("course", 64));
    assert_eq!((round(15), round(31), round(63)), ([1.0, 0.0, 0.6, 0.0], [2.0, 0.0, 0.0, 0.0], [4.0, 0.0, 0.0, 0.0]));
    // Another course takes its place.
    let stage = stage.then("carry the top along an eight");
    assert_eq!(stage.spec.pins.len(), 1);
    assert_eq!(stage.spec.pins[0].region, phystalk::spec::Region::Above(0.95));
}

#[test]
fn amounts_are_said_with_units() {
    let stage = Stage::vase();
    assert_eq!(gloss(&stage.ask("jump 30 cm")), "vase jumps: 2.43 m/s up, enough for 0.30 m");
    assert_eq!(gloss(&stage.ask("push it")), "vase is pushed forward (no direction said): 1.50 m/s at the start");
    assert_eq!(gloss(&stage.ask("softer")), "vase is softer: Young's modulus 200 kPa (automatic until now) to 100 kPa");
    assert_eq!(gloss(&stage.ask("make the vsae 30 kPa")), "read 'vsae' as 'vase'; vase has a Young's modulus of 30 kPa");
}

#[test]
fn materials_to_come_are_refused_by_name() {
    for (text, name, family) in [("turn it into milk", "milk", "liquid"), ("a gold vase", "gold", "rigid")] {
        let reply = Stage::of(&["thing"]).ask(text);
        let said = gloss(&reply);
        assert!(
            matches!(reply, Reply::Refused { .. }) && said.contains(name) && said.contains(family) && said.contains("not built yet"),
            "{text}: {said}"
        );
        assert!(said.contains("water") || said.contains("steel"), "{text}: {said}");
    }
}

#[test]
fn every_preset_is_understood_by_its_name() {
    for preset in phystalk::spec::presets::MATERIALS {
        let stage = Stage::vase().then(&format!("make it of {}", preset.name.replace('_', " ")));
        assert_eq!(stage.spec.objects[0].material, preset.material, "{}", preset.name);
    }
    for preset in phystalk::spec::presets::GRAVITY {
        let words = if preset.name == "zero" { "zero gravity".to_owned() } else { format!("on {}", preset.name) };
        let stage = Stage::vase().then("at 3 g").then(&words);
        assert_eq!(stage.spec.world.gravity_m_s2, preset.vector(), "{}", preset.name);
    }
}

#[test]
fn several_objects_are_told_apart() {
    let stage = Stage::of(&["vase", "lego_bulldozer"]);
    assert_eq!(line(&stage.ask("push the bulldozer forward")), "object.lego_bulldozer.velocity_m_s = [1.5 0.0 0.0]");
    assert_eq!(line(&stage.ask("push the lego bulldozer forward")), "object.lego_bulldozer.velocity_m_s = [1.5 0.0 0.0]");
    assert_eq!(
        line(&stage.ask("make the vase jump 30 cm and push the bulldozer forward, then make it softer")),
        "velocity_m_s = [0.0 0.0 2.42611]; object.lego_bulldozer.young_pa = 100000.0; object.lego_bulldozer.velocity_m_s = [1.5 0.0 0.0]"
    );
    assert_eq!(line(&stage.ask("make everything softer")), "young_pa = 100000.0; object.lego_bulldozer.young_pa = 100000.0");
    assert_eq!(
        line(&stage.ask("make the vase and the bulldozer jump 30 cm")),
        "velocity_m_s = [0.0 0.0 2.42611]; object.lego_bulldozer.velocity_m_s = [0.0 0.0 2.42611]"
    );
    // Nobody was spoken of: not guessed, but asked.
    assert_eq!(gloss(&stage.ask("make it jump")), "which one? there are: vase and lego_bulldozer");
    let talked = Stage::of(&["vase", "lego_bulldozer"]).then("push the bulldozer forward");
    assert_eq!(line(&talked.ask("make it jump 30 cm")), "object.lego_bulldozer.velocity_m_s = [1.5 0.0 2.42611]");
}

#[test]
fn a_denial_repeats_the_verb_before_it() {
    let stage = Stage::of(&["vase", "car"]);
    let jumps = line(&stage.ask("make the car jump 30 cm"));
    for text in ["the car jumps 30 cm and the vase does not", "make the car jump 30 cm but not the vase", "the car jumps 30 cm, the vase doesn't"] {
        assert_eq!(line(&stage.ask(text)), jumps, "{text}");
    }
    // Of each thing something else is no contradiction.
    assert!(matches!(stage.ask("make the car softer and the vase stiffer"), Reply::Edits { .. }));
}

#[test]
fn a_part_says_where_it_was_cut_and_why() {
    let said = gloss(&Stage::vase().ask("the pot is steel"));
    assert!(said.contains("what is below 42 % of its height, 0.42 m, at its neck") && said.contains("\"the pot is the lower third\""), "{said}");
    assert!(gloss(&Stage::vase().ask("hold the flowers")).contains("above 42 % of its height"));
}

#[test]
fn the_front_of_an_object_gives_its_directions() {
    let mut stage = Stage::vase();
    stage.spec.objects[0].forward = Axis::PlusY;
    assert_eq!(line(&stage.ask("push it forward")), "velocity_m_s = [0.0 1.5 0.0]");
    assert_eq!(line(&stage.ask("push it to the left")), "velocity_m_s = [-1.5 0.0 0.0]");
    assert_eq!(line(&stage.ask("push it along x")), "velocity_m_s = [1.5 0.0 0.0]");
}

#[test]
fn an_unknown_stiffness_is_said_to_be_assumed() {
    let mut stage = Stage::vase();
    stage.resolved.clear();
    assert!(gloss(&stage.ask("softer")).contains("taken for the automatic one"));
}

#[test]
fn values_out_of_range_are_refused_with_the_specs_reason() {
    let reply = Stage::vase().ask("push it at 5000 m/s");
    assert!(matches!(&reply, Reply::Refused { reason, .. } if reason.contains("velocity_m_s")), "{reply:?}");
}

#[test]
fn slips_are_read_and_said_but_other_words_are_not() {
    let stage = Stage::vase();
    assert!(gloss(&stage.ask("make it sofetr")).starts_with("read 'sofetr' as 'softer'"));
    assert!(gloss(&stage.ask("turn it into jely")).starts_with("read 'jely' as 'jelly'"));
    // A letter away from "lower", but not with the same beginning; a noun where "place" would be a verb.
    let two = Stage::of(&["vase", "lego_bulldozer"]);
    assert_eq!(line(&two.ask("push the flower")), "refused ?flower");
    assert_eq!(line(&two.ask("push the plate")), "refused ?plate");
}

#[test]
fn a_mended_word_is_read_with_its_neighbours() {
    let stage = Stage::vase();
    assert_eq!(line(&stage.ask("drop it from 30 cm for 1 secnd")), line(&stage.ask("drop it from 30 cm for 1 second")));
    assert_eq!(line(&stage.ask("make it jmup 20cm at half a seccond")), line(&stage.ask("make it jump 20cm at half a second")));
    assert_eq!(line(&stage.ask("lift it 2 metrs")), line(&stage.ask("lift it 2 metres")));
}

#[test]
fn an_unknown_noun_is_the_only_object() {
    let capture = Stage::of(&["my-capture"]);
    let same = |said: &str, plain: &str| assert_eq!(line(&capture.ask(said)), line(&capture.ask(plain)), "{said}");
    same("make the vase jump up and fall back", "make it jump up and fall back");
    same("push the toy car to the left", "push it to the left");
    same("drop the rubber duckling from 1 m", "drop it of rubber from 1 m");
    same("vases jump", "jump");
    same("push the sofa left", "push it left");
    same("the vase jumps and the vase is softer", "it jumps and it is softer");
    let said = gloss(&capture.ask("make the vase jump up and fall back"));
    assert!(said.starts_with("vase is taken for my-capture, the only object here"), "{said}");
    // Not where a word stands for a place, a manner or something else.
    assert_eq!(line(&capture.ask("throw it at the wall")), format!("{} ?wall", line(&capture.ask("throw it"))));
    // Among several objects nobody can know: the culprit is named, and nothing is done.
    let two = Stage::of(&["vase", "lego_bulldozer"]);
    let reply = two.ask("push the vase left and make the flowers jump");
    assert_eq!(line(&reply), "refused ?flowers");
    assert!(gloss(&reply).starts_with("flowers: no such object; there are: vase and lego_bulldozer"), "{}", gloss(&reply));
}

#[test]
fn a_refused_clause_refuses_the_turn() {
    let stage = Stage::vase();
    for text in ["turn it into milk and push it sideways", "push it left and make it of gold", "make it jump and make the table jump"] {
        let reply = stage.ask(text);
        assert!(gloss(&reply).ends_with("nothing of the turn was done"), "{text}: {reply:?}");
    }
}

#[test]
fn an_amount_that_nobody_takes_refuses_the_turn() {
    let stage = Stage::vase();
    for (text, culprit, instead) in [
        ("push it 2 m to the left", "\"2 m\"", "move it 2 m to the left"),
        ("bounce three times", "\"three times\"", "bouncier"),
        ("tip it over on the moon in 1 second", "\"1 second\"", "push it at 1 s"),
        ("jump twice", "\"twice\"", "jump at 1 s"),
        ("make it bouncier at 1 s", "\"1 s\"", "push it left at 1 s"),
        ("push it left and make it 3 m softer", "\"3 m\"", "jump 30 cm"),
        ("jump for 20 percent", "\"20 percent\"", "softer"),
    ] {
        let reply = stage.ask(text);
        assert!(matches!(reply, Reply::Refused { .. }), "{text}: {reply:?}");
        let said = gloss(&reply);
        assert!(said.contains(culprit) && said.contains(instead), "{text}: {said}");
    }
    // A word that says no amount is reported, and the rest is done.
    assert_eq!(line(&stage.ask("push it sternly to the left")), "velocity_m_s = [0.0 1.5 0.0] ?sternly");
    assert!(gloss(&stage.ask("push it sideways")).contains("sideways, to its left (no side said)"));
}

//! `docs/phrases.md`, made from the lexicon and from what the phrasebook says to examples.

use super::clause::{HARD, step};
use super::clauses::{camera, motion, place, stuff};
use super::directions;
use super::lexicon::SECTIONS;
use super::numbers::UNITS;
use super::sense::{Fate, Field, Form, Moment, Part, Property, Sense, Unbuilt, Verb};
use super::tests::Stage;
use super::{Reply, say};
use phystalk::spec::ProxyKind;
use std::fmt::Write;

/// Examples under headings; turns before the last are separated by `|`.
const EXAMPLES: &[(&str, &[&str])] = &[
    (
        "Motions",
        &[
            "Elastic vase jumps and falls.",
            "jump 30 cm",
            "make it jump | higher",
            "jump up and to the left",
            "drop it from 2 m",
            "drop it upside down from half a metre",
            "lift it by 20 cm",
            "Push the vase forward.",
            "push it to the left at 0.5 s",
            "kick it very hard towards me",
            "push it left at 0.5 s and right at 1 s",
            "make it jump, then push it left in mid-air",
            "throw it 2 m forward",
            "spin it clockwise at 2 turns per second",
            "tilt it 20 degrees to the left",
            "tip it over",
            "a backflip",
            "pull it left with 3 m/s2 from 0.2 s to 1 s",
            "strong wind from the front",
            "a gusty wind of 10 m/s from the left | a stronger wind",
            "swirl it clockwise",
            "explode at 1 s",
            "swing it to and fro from 0.5 s to 2 s",
            "shake it for 1 s",
            "keep it spinning",
            "air resistance | no air resistance",
            "hold the base | let go at 1 s",
            "spin it | stop spinning",
        ],
    ),
    (
        "Materials",
        &[
            "make it of rubber",
            "turn the vase into jelly",
            "turn the vase into sand",
            "turn it into mud at 1 s",
            "drop it from 1 m, when it hits the ground it turns to sand",
            "the upper half is snow",
            "softer",
            "a bit stiffer",
            "three times heavier",
            "20 % softer",
            "stiffness 30 kPa",
            "as soft as foam",
            "turn it into lava",
            "turn it into water as particles",
            "make it water, thicker",
            "turn it into honey | it holds together more",
            "make it sand | stickier",
            "the flowers are rubber and the pot is steel",
            "the flowers are jelly | only the upper third",
            "the left half is clay",
            "drop it from 1 m, it shatters into sand when it hits the ground",
            "melts at 1 s",
            "drop it of water from 1 m and it freezes when it lands",
            "softer at 1 s",
            "it breathes",
        ],
    ),
    (
        "World and time",
        &[
            "do it on the moon",
            "half the gravity",
            "zero gravity",
            "on ice",
            "bouncier",
            "for 3 seconds",
            "twice as long",
            "at 100 fps",
            "finer",
            "on a white background",
            "full hd",
        ],
    ),
    ("Camera", &["look from above", "camera from the left at 2 m", "zoom in a bit", "orbit once", "wider", "reset the camera"]),
    (
        "The turn before",
        &[
            "undo that",
            "undo twice",
            "back to the first",
            "back to v2",
            "push it left | no, the other way",
            "push it left at 0.5 s | no, at 1 s",
            "softer | again",
            "softer | a bit more",
            "softer | undo that and make it heavier",
        ],
    ),
    (
        "Several at once, slips, and what is not understood",
        &["make the vsae jump and look from behind", "make the golden vase jump", "push it sternly to the left", "push the flowers"],
    ),
];

/// The page.
pub fn page() -> String {
    let mut page = String::from(
        "<!-- Made from the code by `PHYSTALK_WRITE_DOCS=1 cargo test -p phystalk-agent phrases_page`. Do not edit. -->\n\n# Phrases\n\n\
         What the offline phrasebook understands. It is a grammar: any subject, verb, direction, amount and time below go together, and a request may hold \
         several clauses (`and`, `then`, `but`, commas). Every word counts: it is used, or it is one of the small words at the end, or it is reported. A request is \
         done as a whole or not at all: a clause that is refused, or an amount, a denial or a limit that has no place, refuses all of it. Where the scene has one object, a noun \
         that nobody knows means it, and that is said. A word of \
         four letters or more may have one slip; what it was read as is said.\n",
    );
    examples(&mut page);
    amounts(&mut page);
    words(&mut page);
    page
}

fn examples(page: &mut String) {
    page.push_str("\n## Examples\n\nSaid of a vase one metre high, automatic stiffness 200 kPa.\n");
    for (title, rows) in EXAMPLES {
        let _ = write!(page, "\n### {title}\n\n| words | what it does |\n|---|---|\n");
        for row in *rows {
            let turns: Vec<&str> = row.split(" | ").collect();
            let mut stage = Stage::vase();
            for turn in &turns[..turns.len() - 1] {
                stage = stage.then(turn);
            }
            let said = answer(&stage.ask(turns[turns.len() - 1]));
            let _ = writeln!(page, "| {} | {said} |", turns.join("; *then* "));
        }
    }
}

/// A reply in words.
fn answer(reply: &Reply) -> String {
    let unknown = |words: &[String]| if words.is_empty() { String::new() } else { format!(" (not understood: {})", words.join(", ")) };
    match reply {
        Reply::Edits { gloss, not_understood, .. } => format!("{}{}", gloss.join("; "), unknown(not_understood)),
        Reply::Undo(1) => "back by one turn".to_owned(),
        Reply::Undo(n) => format!("back by {n} turns"),
        Reply::Redo(n) => format!("forward by {n}"),
        Reply::BackTo(version) => format!("back to {}", called(*version)),
        Reply::Compare(from, to) => format!("says what {} and {} differ in", called(*from), called(*to)),
        Reply::Refused { reason, not_understood } => format!("refused: {reason}{}", unknown(not_understood)),
    }
}

fn called(version: super::VersionRef) -> String {
    match version {
        super::VersionRef::First => "the first version".to_owned(),
        super::VersionRef::Number(n) => format!("v{n}"),
        super::VersionRef::Last => "the newest".to_owned(),
        super::VersionRef::Previous => "the one before it".to_owned(),
    }
}

fn amounts(page: &mut String) {
    page.push_str("\n## Amounts that are not given\n\n| of | is |\n|---|---|\n");
    let rows = [
        (
            "a jump",
            format!(
                "{} of the object's height; stored as the speed √(2 g h) in the gravity of that turn (9.81 m/s² where there is none)",
                motion::JUMP_HEIGHTS
            ),
        ),
        ("a push", format!("{} m/s times √(longest side in metres), at the start; with a time it is an event", motion::PUSH_M_S)),
        ("a throw", format!("{} m/s times √(longest side), 45° up", motion::THROW_M_S)),
        ("a spin", "1 turn a second, counter-clockwise seen from above".to_owned()),
        ("a pull, wind", format!("{} m/s², to the end", motion::PULL_M_S2)),
        ("a drop", format!("{} of the object's height, from its lowest point to what is below it", place::DROP_HEIGHTS)),
        ("a lift", format!("{} of the object's height", place::LIFT_HEIGHTS)),
        ("a move", format!("{} of the longest side", place::MOVE_SIZES)),
        ("a turn, a tilt", format!("{}°, {}°", say::short(place::TURN_RAD.to_degrees()), say::short(place::TILT_RAD.to_degrees()))),
        (
            "a direction",
            "forward: the object's front, +x unless the spec says otherwise; its left is +y. \"Towards me\" and \"on screen left\" go by the camera"
                .to_owned(),
        ),
        ("hard, gently", format!("{HARD} times, 1/{HARD} times; \"very\" twice over")),
        (
            "softer, stiffer, heavier, lighter, more slippery",
            format!("a factor of {}; \"a bit\" its square root, \"much\" its square", step(Property::Stiffness)),
        ),
        ("higher, faster, stronger, longer, closer", format!("a factor of {}", step(Property::Height))),
        (
            "thicker, holds together more, spreads more, stickier",
            format!("a factor of {}, and at least what shows in a thing of that size", step(Property::Viscosity)),
        ),
        ("wetter", format!("a factor of {} of the cohesion, and at least a tenth of the pressure at its foot", step(Property::Cohesion))),
        ("a melt", "a liquid of the same density that takes about 0.2 s to sink together, whatever its size".to_owned()),
        (
            "the flowers, the pot",
            "what is above and below the height at which its profile has a neck and its colours change most; the answer says where".to_owned(),
        ),
        ("the top, the bottom", "a third of the height where they are of other stuff, a twentieth where they are held".to_owned()),
        ("closer, seen from a side", "never so near that what is predicted to move leaves the picture, unless a number says so".to_owned()),
        ("a material's stiffness before the first run", say::pressure(stuff::YOUNG_BEFORE_RUN_PA)),
        ("an orbit, a step of the camera", format!("{}° a second, {}°", camera::ORBIT_DEG_S, camera::STEP_DEG)),
    ];
    for (of, is) in rows {
        let _ = writeln!(page, "| {of} | {is} |");
    }
    page.push_str("\n## Numbers and units\n\nIn digits or words: `0.5`, `1,5`, `half a`, `two and a half`, `a third of a`, `twenty-five`, `20 %`, `3 times`. Units combine with `/` or *per*:\n");
    for (names, ..) in UNITS {
        let _ = writeln!(page, "- {}", names.replace(' ', ", "));
    }
}

fn words(page: &mut String) {
    page.push_str("\n## Words\n");
    for section in SECTIONS {
        let _ = write!(page, "\n### {}\n\n| meaning | words |\n|---|---|\n", section.title);
        for entry in section.entries {
            let _ = writeln!(page, "| {} | {} |", meaning(&entry.sense), entry.words.replace('|', ", "));
        }
    }
}

fn meaning(sense: &Sense) -> String {
    match sense {
        Sense::Verb(Verb::Push(strength)) if *strength > 0.0 => "a hard push".to_owned(),
        Sense::Verb(Verb::Push(strength)) if *strength < 0.0 => "a gentle push".to_owned(),
        Sense::Verb(Verb::Push(_)) => "push".to_owned(),
        Sense::Verb(Verb::Zoom(sign)) => if *sign > 0.0 { "camera closer" } else { "camera further away" }.to_owned(),
        Sense::Verb(Verb::Field(field)) => field_name(*field).to_owned(),
        Sense::Verb(Verb::Change(fate)) => fate_name(*fate).to_owned(),
        Sense::Gusty => "of wind: in gusts".to_owned(),
        Sense::Verb(verb) => format!("{verb:?}").to_lowercase(),
        Sense::Change(sign) => if *sign > 0.0 { "more" } else { "less" }.to_owned(),
        Sense::Degree(degree) => format!("so much: {} steps", say::short(*degree)),
        Sense::Strength(sign) => if *sign > 0.0 { "hard" } else { "gently" }.to_owned(),
        Sense::Factor(factor) => format!("{} times", say::short(*factor)),
        Sense::Property(property) => property_name(*property).to_owned(),
        Sense::Quality(property, sign, form) => {
            let way = if *sign > 0.0 { "more" } else { "less" };
            let form = if *form == Form::Comparative { "" } else { " (as an adjective or adverb)" };
            format!("{way} {}{form}", property_name(*property))
        }
        Sense::Material(name) => (*name).to_owned(),
        Sense::Unbuilt(what) => unbuilt_name(*what).to_owned(),
        Sense::Gravity(strength) => format!("gravity {}", say::acceleration(*strength)),
        Sense::Surface(friction) => format!("friction {}", say::short(*friction)),
        Sense::Springy(restitution) => format!("restitution {}", say::short(*restitution)),
        Sense::Direction(direction) => directions::said(*direction).to_owned(),
        Sense::View(view) => format!("seen from: {view:?}").to_lowercase(),
        Sense::Part(part) => part_name(*part).to_owned(),
        Sense::Pose(pose) => match pose {
            super::sense::Pose::UpsideDown => "upside down",
            super::sense::Pose::OnItsSide => "on its side",
            super::sense::Pose::Upright => "upright",
        }
        .to_owned(),
        Sense::Moment(Moment::Apex) => "at its apex, predicted".to_owned(),
        Sense::Moment(Moment::OnTheWay) => "half way: no event waits for that".to_owned(),
        Sense::Moment(Moment::LaterLanding | Moment::AfterLanding) => "later than an impact: no event waits for that".to_owned(),
        Sense::Moment(Moment::Landing) => "when it meets something, found by the run".to_owned(),
        Sense::Smoothed(true) => "a liquid by smoothed particles".to_owned(),
        Sense::Smoothed(false) => "a liquid on the grid".to_owned(),
        Sense::Backdrop(colour) => format!("background {colour}"),
        Sense::PictureSize([width, height]) => format!("pictures of {width} × {height}"),
        Sense::Reseed => "the next seed".to_owned(),
        Sense::Turn(word) => format!("{word:?}").to_lowercase(),
        Sense::Version(number) => format!("v{number}"),
        Sense::Preposition(preposition) => format!("*{preposition:?}*").to_lowercase(),
        Sense::Scenery(thing) => format!("a thing to meet: {thing:?}").to_lowercase(),
        Sense::Overhead => "what things hang from".to_owned(),
        Sense::Course(course) => format!("a course: {course:?}").to_lowercase(),
        Sense::Proxy(ProxyKind::Hull) => "solid as its convex hull".to_owned(),
        Sense::Proxy(ProxyKind::Voxel) => "solid as its Gaussians are".to_owned(),
        Sense::Ground => "the ground, or what is on it".to_owned(),
        Sense::It => "what was spoken of".to_owned(),
        Sense::All => "all objects".to_owned(),
        Sense::Edge => "over the edge of the collider it stands on".to_owned(),
        Sense::AboveGround => "over what is below it".to_owned(),
        Sense::Negation => "stops or takes back a motion; elsewhere it holds the clause back".to_owned(),
        Sense::Except => "what follows is left as it is".to_owned(),
        Sense::Limit => "a limit that is not built: holds the clause back".to_owned(),
        Sense::Whole => "its parts too".to_owned(),
        Sense::Ends => "ends what acts, at a time".to_owned(),
        Sense::Wait => "what follows comes later".to_owned(),
        Sense::Replace => "other stuff for some that is there".to_owned(),
        Sense::Condition => "not built yet: holds the clause back".to_owned(),
        Sense::Question => "a question is not answered".to_owned(),
        Sense::Instead => "replaces the push before".to_owned(),
        Sense::Separator => "between clauses".to_owned(),
        Sense::Filler => "says nothing".to_owned(),
        other => format!("{other:?}").to_lowercase(),
    }
}

fn property_name(property: Property) -> &'static str {
    match property {
        Property::Stiffness => "stiffness",
        Property::Hardness => "stiffness, or strength after a push",
        Property::Density => "density",
        Property::Height => "height of a jump or a drop",
        Property::Speed => "speed",
        Property::Strength => "strength",
        Property::Size => "strength of a motion",
        Property::Bounce => "restitution of what is below",
        Property::Friction => "friction of what is below",
        Property::Duration => "duration",
        Property::Distance => "distance of the camera, or of a throw",
        Property::Gravity => "gravity",
        Property::FrameRate => "frames a second",
        Property::FieldOfView => "field of view",
        Property::Poisson => "Poisson's ratio",
        Property::Detail => "cells of the grid",
        Property::Viscosity => "viscosity",
        Property::Tension => "surface tension",
        Property::Cohesion => "cohesion of grains",
        Property::Hold => "what holds it together: surface tension, cohesion, yield stress",
        Property::Stick => "cohesion of grains, viscosity of liquids, else friction of what is below",
        Property::Yield => "yield stress",
        Property::Slope => "friction angle of grains",
    }
}

fn part_name(part: Part) -> &'static str {
    match part {
        Part::Base => "the lowest twentieth",
        Part::Top => "the highest twentieth",
        Part::LowerHalf => "the lower half",
        Part::UpperHalf => "the upper half",
        Part::LowerThird => "the lowest third",
        Part::UpperThird => "the highest third",
        Part::MiddleThird => "the middle third",
        Part::LeftHalf => "the left half, as it faces",
        Part::RightHalf => "the right half",
        Part::FrontHalf => "the front half",
        Part::BackHalf => "the back half",
        Part::Flowers => "what is above its neck, or the height at which its colours change most",
        Part::Pot => "what is below that",
        Part::Ends => "the highest and the lowest twentieth",
        Part::Rest => "all that is no part of its own",
    }
}

fn fate_name(fate: Fate) -> &'static str {
    match fate {
        Fate::Melt => "becomes a thick liquid; beside a material, that",
        Fate::Freeze => "becomes a solid of the shape that it has",
        Fate::Crumble => "becomes loose grains; beside a material, that",
        Fate::Dissolve => "becomes water",
        Fate::Pulse => "becomes a muscle that pulls once a second",
        Fate::Shatter => "beside a material, becomes that",
    }
}

fn field_name(field: Field) -> &'static str {
    match field {
        Field::Spring => "on a spring",
        Field::Swirl => "swirling air",
        Field::Explode => "a blast from its middle",
        Field::Attract => "a pull to its middle",
        Field::Air => "the drag of air",
        Field::Water => "the drag of water",
        Field::Sway => "driven to and fro",
        Field::Shake => "driven to and fro, fast",
        Field::Motor => "kept turning",
    }
}

fn unbuilt_name(what: Unbuilt) -> &'static str {
    match what {
        Unbuilt::Liquid => "other liquids",
        Unbuilt::Rigid => "other rigid stuff",
        Unbuilt::Plastic => "other stuff that keeps dents",
        Unbuilt::Viscoplastic => "other thick stuff",
        Unbuilt::Grains => "other grains",
        Unbuilt::Gas => "gases",
        Unbuilt::Muscle => "things that move themselves",
        Unbuilt::Heat => "heat",
        Unbuilt::Deform => "squeezing and bending",
        Unbuilt::Look => "colours and light",
        Unbuilt::Scene => "size and number of things",
        Unbuilt::Filling => "filling, pouring, other stuff inside",
        Unbuilt::Front => "changes that run through a thing",
        Unbuilt::Mover => "other things that move",
        Unbuilt::Pendulum => "a swing about a point",
        Unbuilt::Playback => "playback",
    }
}

#[test]
fn phrases_page_is_current() {
    let file = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/phrases.md");
    if std::env::var_os("PHYSTALK_WRITE_DOCS").is_some() {
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(&file, page()).unwrap();
    }
    let written = std::fs::read_to_string(&file).unwrap_or_default();
    assert!(written == page(), "docs/phrases.md is not what the code says: PHYSTALK_WRITE_DOCS=1 cargo test -p phystalk-agent phrases_page");
}

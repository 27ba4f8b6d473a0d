//! What earlier turns asked for and a new one leaves in force, in a few words: nobody remembers every event of a session.

use crate::language::say;
use glam::DVec3;
use phystalk::spec::{Edit, Event, Force, Material, Pin, Spec, Until, When, presets};

/// More are only counted.
const MOST: usize = 4;

/// Events, forces and holds of `before` that `after` still has as they were; none where there are none, or where the
/// edits concern the picture alone.
pub fn said(before: &Spec, after: &Spec, edits: &[Edit]) -> Option<String> {
    if edits.iter().all(|edit| ["camera", "output"].contains(&edit.path().split('.').next().unwrap_or_default())) {
        return None;
    }
    let events = after.events.iter().filter(|e| before.events.contains(e)).map(event);
    let forces = after.forces.iter().filter(|f| before.forces.contains(f)).map(force);
    let pins = after.pins.iter().filter(|p| before.pins.contains(p)).map(pin);
    let mut kept: Vec<String> = events.chain(forces).chain(pins).collect();
    if kept.is_empty() {
        return None;
    }
    let more = kept.len().saturating_sub(MOST);
    kept.truncate(MOST);
    let rest = if more > 0 { format!(", and {more} more") } else { String::new() };
    Some(format!("still in force: {}{rest}", kept.join("; ")))
}

/// "vase turns into water at 1 s"
fn event(event: &Event) -> String {
    let who = event.part.as_ref().map_or_else(|| event.object.clone(), |part| format!("{part} of {}", event.object));
    let length = |v: [f64; 3]| DVec3::from(v).length();
    let what = match event {
        Event { push_m_s: Some(push), .. } if event.name.starts_with("jump") => format!("jumps with {}", say::speed(length(*push))),
        Event { push_m_s: Some(push), .. } => format!("is pushed with {}", say::speed(length(*push))),
        Event { velocity_m_s: Some(velocity), .. } if length(*velocity) == 0.0 => "stops".to_owned(),
        Event { velocity_m_s: Some(velocity), .. } => format!("gets {}", say::speed(length(*velocity))),
        Event { material: Some(material), .. } => format!("turns into {}", stuff(material)),
        Event { weaken: Some(_), .. } => "gives way".to_owned(),
        Event { freeze: true, .. } => "freezes".to_owned(),
        _ => "is let go".to_owned(),
    };
    let when = match (event.at_s, event.when) {
        (Some(at_s), _) => format!("at {}", say::seconds(at_s)),
        (None, Some(When::Impact) | None) => "when it meets something".to_owned(),
    };
    format!("{who} {what} {when}")
}

/// What some stuff is called: by its preset, else by its kind.
fn stuff(material: &Material) -> String {
    let preset = presets::MATERIALS.iter().find(|p| p.material == *material);
    preset.map_or_else(|| format!("something {}", material.kind()), |p| p.name.replace('_', " "))
}

/// "wind on vase from 0.5 s to 1 s"
fn force(force: &Force) -> String {
    let kind = force.name.trim_end_matches(|c: char| c.is_ascii_digit());
    format!("{kind} on {}{}", force.object, span(force.from_s, force.to_s))
}

/// "base of vase is held until 1 s"
fn pin(pin: &Pin) -> String {
    let who = if pin.name.starts_with("hold") { pin.object.clone() } else { format!("{} of {}", pin.name, pin.object) };
    format!("{who} is {}{}", if pin.path.is_empty() { "held" } else { "led" }, span(pin.from_s, pin.to_s))
}

fn span(from_s: f64, to_s: Until) -> String {
    match to_s {
        Until::End if from_s == 0.0 => String::new(),
        Until::End => format!(" from {} on", say::seconds(from_s)),
        Until::Time(to_s) if from_s == 0.0 => format!(" until {}", say::seconds(to_s)),
        Until::Time(to_s) => format!(" from {} to {}", say::seconds(from_s), say::seconds(to_s)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phystalk::spec::Region;

    #[test]
    fn what_a_turn_leaves_as_it_was_is_said_and_what_it_touches_is_not() {
        let mut before = Spec::of_scene("vase.splat");
        let water = presets::material("water").map(|p| p.material.clone());
        before.events.push(Event { material: water, ..Event::at("change1", "vase", 1.0) });
        before.events.push(Event { push_m_s: Some([0.0, 1.5, 0.0]), ..Event::on_impact("push1", "vase") });
        before.forces.push(Force::constant("wind1", "vase", 0.5, Until::End, [1.0, 0.0, 0.0]));
        let base = Pin { name: "base".into(), object: "vase".into(), region: Region::Below(0.05), from_s: 0.0, to_s: Until::Time(2.0), path: vec![] };
        before.pins.push(base);
        let jump = [Edit::set("object.vase.velocity_m_s", serde_json::json!([0.0, 0.0, 2.8]))];
        assert_eq!(
            said(&before, &before, &jump).as_deref(),
            Some(
                "still in force: vase turns into water at 1 s; vase is pushed with 1.50 m/s when it meets something; wind on vase from 0.5 s on; base of \
                 vase is held until 2 s"
            )
        );
        let mut after = before.clone();
        (after.events[0].at_s, after.events[1].push_m_s) = (Some(2.0), Some([0.0, 3.0, 0.0]));
        after.forces.clear();
        assert_eq!(said(&before, &after, &jump).as_deref(), Some("still in force: base of vase is held until 2 s"));
        assert_eq!(said(&before, &before, &[Edit::set("camera.fov_deg", 60)]), None);
        assert_eq!(said(&Spec::of_scene("vase.splat"), &after, &jump), None);
    }
}

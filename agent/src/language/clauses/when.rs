//! When something happens: at the start, at a time, or when the object meets something.

use super::super::clause::Clause;
use super::super::draft::{Draft, Refusal};
use super::super::say;
use super::super::sense::{Moment, Sense};
use phystalk::spec::{Event, When as Occasion};

/// When something happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// From the start.
    Start,
    /// At a time, seconds.
    At(f64),
    /// The first time that the object meets something.
    Impact,
}

/// A moment in mid-air that is not there.
const NO_FLIGHT: &str = "it does not fly, so there is no such moment: give a time, as in \"at 0.5 s\"";

impl When {
    /// Reads "at 0.5 s", "in mid-air", "when it lands". The top of a flight is predicted; an impact is found by the run.
    pub fn take(clause: &mut Clause, draft: &Draft, object: usize) -> Result<When, Refusal> {
        let moment = clause.take(|s| match s {
            Sense::Moment(moment) => Some(*moment),
            _ => None,
        });
        match moment {
            None => Ok(clause.take_at().map_or(When::Start, |at_s| When::At(say::tidy(at_s)))),
            Some(Moment::LaterLanding | Moment::AfterLanding | Moment::OnTheWay) => Err(no_occasion(moment.unwrap_or(Moment::OnTheWay)).to_owned()),
            Some(Moment::Apex) => flight_s(draft, object).map(|(apex, _)| When::At(apex)).ok_or(NO_FLIGHT.to_owned()),
            Some(Moment::Landing) if moves(draft) => Ok(When::Impact),
            Some(Moment::Landing) => {
                Err("it meets nothing, for nothing moves it: \"drop it from 1 m\", or give a time, as in \"at 0.5 s\"".to_owned())
            }
        }
    }

    /// As a time, for what cannot wait: a landing is predicted from the jump or the drop that the spec holds.
    pub fn time_s(self, draft: &Draft, object: usize) -> Result<Option<f64>, Refusal> {
        match self {
            When::Start => Ok(None),
            When::At(at_s) => Ok(Some(at_s)),
            When::Impact => flight_s(draft, object).map(|(_, landing)| Some(landing)).ok_or(NO_FLIGHT.to_owned()),
        }
    }

    /// An event then, without an effect yet; one that was to be at the start is at 0 s.
    pub fn event(self, name: &str, object: &str) -> Event {
        match self {
            When::Start => Event::at(name, object, 0.0),
            When::At(at_s) => Event::at(name, object, at_s),
            When::Impact => Event::on_impact(name, object),
        }
    }

    /// Whether an event is then.
    pub fn is_of(self, event: &Event) -> bool {
        match self {
            When::Impact => event.when == Some(Occasion::Impact),
            When::Start => event.at_s == Some(0.0),
            When::At(at_s) => event.at_s.is_some_and(|t| (t - at_s).abs() < 1e-9),
        }
    }

    /// " at 0.5 s", " when it meets something"; nothing at the start.
    pub fn said(self) -> String {
        match self {
            When::Start => String::new(),
            When::At(at_s) => format!(" at {}", say::seconds(at_s)),
            When::Impact => " when it meets something".to_owned(),
        }
    }
}

/// Why a moment is none that an event can wait for.
pub fn no_occasion(moment: Moment) -> &'static str {
    match moment {
        Moment::LaterLanding => {
            "an event waits for the first time that a thing meets something: \"at the first bounce\"; for a later one give a time, \"at 1.2 s\""
        }
        Moment::AfterLanding => "an event comes at the impact itself, \"when it lands\", or at a time from the start, \"at 1.2 s\"",
        _ => "half way is no moment that an event waits for: \"at the top of its jump\", \"when it lands\", \"at 0.5 s\" are",
    }
}

/// Whether the clause says when.
pub fn is_said(clause: &Clause) -> bool {
    clause.has(|s| matches!(s, Sense::At(_) | Sense::Moment(_)))
}

/// When a jump or a drop is at its top, and when it lands; none where there is no flight.
fn flight_s(draft: &Draft, object: usize) -> Option<(f64, f64)> {
    let gravity = draft.gravity_m_s2();
    let rising = draft.spec.objects[object].velocity_m_s[2].max(0.0);
    let gap = draft.gap_m(object).max(0.0);
    if gravity < 1e-6 || (rising == 0.0 && gap == 0.0) {
        return None;
    }
    let apex = rising / gravity;
    let landing = apex + (apex * apex + 2.0 * gap / gravity).sqrt();
    let whole = |time_s: f64| (time_s * 1e3).round() / 1e3;
    Some((whole(apex), whole(landing)))
}

/// Whether the spec moves anything that could meet something. An object that stands may be run into.
fn moves(draft: &Draft) -> bool {
    let spec = &draft.spec;
    let own = |index: usize| {
        let thing = &spec.objects[index];
        thing.velocity_m_s != [0.0; 3]
            || thing.spin_rad_s != [0.0; 3]
            || thing.rotate_deg != [0.0; 3]
            || draft.gap_m(index) > 0.0
            || spec.events.iter().any(|e| e.object == thing.name && (e.push_m_s.is_some() || e.velocity_m_s.is_some() || e.release))
            || spec.forces.iter().any(|f| f.object == thing.name)
            || spec.pins.iter().any(|p| p.object == thing.name)
    };
    (0..spec.objects.len()).any(own)
}

//! What happened, in words: plans, durations, what a run showed.

use crate::history::Session;
use crate::language::say;
use phystalk::spec::{Spec, Until};
use phystalk::stages::{Action, Metrics, ObjectMetrics, PlannedStage};
use phystalk::world::Facts;

/// What moves slower than so many of its heights a second, or than this share of its fastest, only trembles.
const STILL_HEIGHTS_S: f64 = 0.1;
const STILL_SHARE: f64 = 0.1;

/// What is wrong with a session's log, and what to do about it.
pub fn damage(session: &Session) -> Option<String> {
    let damage = session.damage();
    (!damage.is_empty()).then(|| {
        let name = session.name();
        format!("session {name} is damaged ({}): what those lines held is missing, all else is there; phystalk store verify --repair joins the rest and keeps a copy", damage.join("; "))
    })
}

/// Seconds as people say them.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s < 0.0995 => format!("{:.0} ms", s.max(0.0) * 1000.0),
        s if s < 9.95 => format!("{s:.1} s"),
        s if s < 99.5 => format!("{s:.0} s"),
        s => format!("{}:{:02} min", (s / 60.0) as u64, s as u64 % 60),
    }
}

fn verb(stage: &PlannedStage) -> String {
    match (stage.action, stage.from_s) {
        (Action::Run, _) => "run".to_owned(),
        (Action::Hit, _) => "hit".to_owned(),
        (Action::Skip, _) => "skip".to_owned(),
        (Action::Resume, Some(from)) => format!("resume from {from:.2} s"),
        (Action::Resume, None) => "resume".to_owned(),
    }
}

/// A plan in one line: what runs, and that the rest is in the store.
pub fn plan_line(stages: &[PlannedStage]) -> String {
    let works = |s: &&PlannedStage| matches!(s.action, Action::Run | Action::Resume);
    let describe = |s: &PlannedStage| match s.action {
        Action::Resume => format!("{} ({})", s.stage.as_str(), verb(s)),
        _ => s.stage.as_str().to_owned(),
    };
    let names: Vec<String> = stages.iter().filter(works).map(describe).collect();
    let Some(first) = stages.iter().find(works) else { return "plan: nothing to run, everything is in the store".to_owned() };
    format!("plan: {} ({})", names.join(", "), first.reason)
}

/// A plan as rows: stage, what happens, what it took, why.
pub fn plan_table(stages: &[PlannedStage]) -> Vec<Vec<String>> {
    let row = |s: &PlannedStage| {
        let seconds = s.seconds.filter(|_| s.action != Action::Skip).map(duration).unwrap_or_default();
        vec![s.stage.as_str().to_owned(), verb(s), seconds, s.reason.clone()]
    };
    stages.iter().map(row).collect()
}

/// The objects of a scene by name, with their sizes, one sentence each.
pub fn scene(facts: &Facts) -> Vec<String> {
    let sentence = |object: &phystalk::world::ObjectFacts| {
        let [x, y, z] = [0, 1, 2].map(|axis| object.high_m[axis] - object.low_m[axis]);
        format!("{}: {} high, {} by {}, {} Gaussians", object.name, length(z), length(x), length(y), object.gaussians)
    };
    facts.objects.iter().map(sentence).collect()
}

/// Where the time of a run went within its stages, and what memory it took, for whoever wants to know more.
pub fn details(metrics: &Metrics) -> Vec<String> {
    let parts = metrics.seconds.iter().filter_map(|(name, s)| Some((name.split_once('.')?, *s)));
    let mut lines: Vec<(&str, String)> = Vec::new();
    for ((stage, part), seconds) in parts {
        let said = format!("{part} {}", duration(seconds));
        match lines.last_mut() {
            Some((last, line)) if *last == stage => *line += &format!(", {said}"),
            _ => lines.push((stage, format!("{stage}: {said}"))),
        }
    }
    let megabytes = |bytes: u64| bytes.div_ceil(1_000_000);
    let (memory, solver) = (&metrics.memory, &metrics.solver);
    let mut said: Vec<String> = lines.into_iter().map(|(_, line)| line).collect();
    said.push(format!("solver: {} particles, {} substeps, {} taken back", solver.particles, solver.substeps, solver.retries));
    said.push(format!(
        "memory: {} MB on the device of {} set aside there, at most {} of main memory",
        megabytes(memory.device_bytes),
        megabytes(memory.device_reserved_bytes),
        megabytes(memory.host_peak_bytes)
    ));
    said
}

/// A run that got longer unasked by at least so much is worth a word.
const LONGER_S: f64 = 1.0;

/// What an automatic duration grew to.
pub fn longer(before_s: f64, after_s: f64) -> Option<String> {
    let text = || {
        let [before, after] = [before_s, after_s].map(say::seconds);
        format!("the run lasts {after} instead of {before}, to follow what moves: \"for {before}\" keeps it short")
    };
    (after_s - before_s >= LONGER_S).then(text)
}

/// What the objects did, one sentence each.
pub fn outcome(metrics: &Metrics, spec: &Spec) -> Vec<String> {
    metrics.objects.iter().map(|(name, object)| sentence(name, object, metrics, spec)).collect()
}

/// Whether something is meant to move when the run ends: driven, led, or with nothing that draws it down.
fn moves_on(name: &str, spec: &Spec) -> bool {
    let ends_s = |until: Until| if let Until::Time(to_s) = until { to_s } else { f64::INFINITY };
    let end_s = spec.time.duration_s.unwrap_or(f64::INFINITY);
    spec.world.gravity_m_s2 == [0.0; 3]
        || spec.forces.iter().any(|f| f.object == name && f.ends_s() >= end_s)
        || spec.pins.iter().any(|p| p.object == name && !p.path.is_empty() && ends_s(p.to_s) >= end_s)
}

/// How fast something still is at the end, metres a second, where that shows: not what trembles after a jump, and not what
/// was asked to go on.
fn surprises(name: &str, object: &ObjectMetrics, height_m: f64, spec: &Spec) -> Option<f64> {
    let (last, most) = (*object.mean_speed_m_s.last()?, object.mean_speed_m_s.iter().copied().fold(0.0, f64::max));
    (last > STILL_HEIGHTS_S * height_m && last > STILL_SHARE * most && !moves_on(name, spec)).then_some(last)
}

fn sentence(name: &str, object: &ObjectMetrics, metrics: &Metrics, spec: &Spec) -> String {
    let height = match (object.high_m.first(), object.low_m.first()) {
        (Some(high), Some(low)) => (high - low).max(1e-6),
        _ => 1.0,
    };
    let mut parts = Vec::new();
    let (apex, travel) = (object.apex_m(), object.travel_m());
    let aside = travel[0].hypot(travel[1]);
    parts.extend(up_and_down(apex, object.drop_m(), height));
    if aside > 0.01 * height {
        parts.push(format!("ends {} away", length(aside)));
    }
    let stretch = object.largest_stretch();
    if stretch > 1.05 {
        parts.push(format!("stretches to {:.0} %", stretch * 100.0));
    }
    if parts.is_empty() {
        parts.push("stays where it is".to_owned());
    } else {
        let longer_s = (2.0 * metrics.duration_s).ceil().min(phystalk::spec::limits::TIME_S);
        match (object.settle_s(metrics.fps), surprises(name, object, height, spec)) {
            (Some(settled), _) => parts.push(format!("is at rest from {settled:.2} s")),
            (None, Some(speed)) => {
                parts.push(format!("still moves at {} a second when the run ends: \"for {longer_s:.0} s\" shows more", length(speed)))
            }
            (None, None) => {}
        }
    }
    format!("{name}: {}", parts.join(", "))
}

/// How the middle went up and down. What falls about as far as it rose came down again: it sags a little as it lands.
fn up_and_down(apex_m: f64, drop_m: f64, height_m: f64) -> Option<String> {
    let (rises, falls) = (apex_m > 0.01 * height_m, drop_m > 0.01 * height_m);
    match (rises, falls) {
        (true, true) if (drop_m - apex_m).abs() <= 0.25 * apex_m => Some(format!("rises {} and comes down again", length(apex_m))),
        (true, true) => Some(format!("rises {}, falls {}", length(apex_m), length(drop_m))),
        (true, false) => Some(format!("rises {}", length(apex_m))),
        (false, true) => Some(format!("falls {}", length(drop_m))),
        (false, false) => None,
    }
}

fn length(metres: f64) -> String {
    if metres < 0.995 { format!("{:.0} cm", metres * 100.0) } else { format!("{metres:.2} m") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phystalk::stages::StageName;

    #[test]
    fn durations() {
        let said: Vec<String> = [0.004, 0.5, 2.34, 61.0, 125.0].into_iter().map(duration).collect();
        assert_eq!(said, ["4 ms", "0.5 s", "2.3 s", "61 s", "2:05 min"]);
    }

    #[test]
    fn a_jump_comes_down_again_and_a_fall_is_a_fall() {
        assert_eq!(up_and_down(0.24, 0.27, 1.0).as_deref(), Some("rises 24 cm and comes down again"));
        assert_eq!(up_and_down(0.24, 1.2, 1.0).as_deref(), Some("rises 24 cm, falls 1.20 m"));
        assert_eq!(up_and_down(0.0, 0.5, 1.0).as_deref(), Some("falls 50 cm"));
        assert_eq!(up_and_down(0.001, 0.001, 1.0), None);
    }

    #[test]
    fn what_still_moves_is_said_where_it_is_a_surprise_with_the_words_that_show_more() {
        let mut spec = Spec::of_scene("vase.splat");
        let metrics = Metrics { fps: 50, duration_s: 2.0, ..Metrics::default() };
        let moving = |last: f64| ObjectMetrics {
            com_m: vec![[0.0, 0.0, 0.5], [0.0, 0.0, 0.8], [0.0, 0.0, 0.5]],
            low_m: vec![0.0; 3],
            high_m: vec![1.0; 3],
            speed_m_s: vec![2.0; 3],
            mean_speed_m_s: vec![2.0, 1.0, last],
            stretch_max: vec![1.0; 3],
            ..ObjectMetrics::default()
        };
        let said = |spec: &Spec, last: f64| sentence("vase", &moving(last), &metrics, spec);
        assert!(said(&spec, 0.5).ends_with("still moves at 50 cm a second when the run ends: \"for 4 s\" shows more"), "{}", said(&spec, 0.5));
        // What trembles after a jump does not.
        assert_eq!(said(&spec, 0.05), "vase: rises 30 cm and comes down again");
        // Nor what was asked to go on.
        spec.forces.push(phystalk::spec::Force::constant("wind1", "vase", 0.0, Until::End, [1.0, 0.0, 0.0]));
        assert_eq!(said(&spec, 0.5), "vase: rises 30 cm and comes down again");
        assert_eq!(longer(2.0, 2.9), None);
        assert_eq!(longer(2.0, 4.3).as_deref(), Some("the run lasts 4.3 s instead of 2 s, to follow what moves: \"for 2 s\" keeps it short"));
    }

    fn stage(stage: StageName, action: Action, from_s: Option<f64>, reason: &str) -> PlannedStage {
        PlannedStage { stage, key: String::new(), action, from_s, reason: reason.to_owned(), seconds: None }
    }

    #[test]
    fn a_plan_says_what_runs_and_why() {
        let hit = |s| stage(s, Action::Hit, None, "in the store");
        let all = [hit(StageName::Scene), hit(StageName::Proxy)];
        assert_eq!(plan_line(&all), "plan: nothing to run, everything is in the store");
        let resumed = [
            hit(StageName::Bind),
            stage(StageName::Simulate, Action::Resume, Some(0.5), "event push changed"),
            stage(StageName::Picture, Action::Run, None, "simulate runs"),
        ];
        assert_eq!(plan_line(&resumed), "plan: simulate (resume from 0.50 s), picture (event push changed)");
        assert_eq!(plan_table(&resumed)[1], ["simulate", "resume from 0.50 s", "", "event push changed"]);
    }
}

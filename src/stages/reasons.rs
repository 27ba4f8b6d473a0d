//! Why a stage runs, in words.

use super::{Action, StageName};
use crate::spec::Spec;

/// Paths of a spec that each stage reads itself, as prefixes; `*` stands for a name.
fn reads(stage: StageName) -> &'static [&'static str] {
    match stage {
        StageName::Scene => &["scene", "object.*.select", "object.*.name"],
        StageName::Proxy => &["object.*.proxy", "object.*.material", "object.*.part", "solver", "world.ground.height_m", "seed"],
        StageName::Bind => &["skin"],
        StageName::Simulate => &["time", "world", "object", "pin", "collider", "force", "event", "seed"],
        StageName::Picture => &["camera", "output", "time"],
    }
}

fn matches(prefix: &str, path: &str) -> bool {
    let mut words = path.split('.');
    prefix.split('.').all(|want| words.next().is_some_and(|word| want == "*" || want == word))
}

/// Paths that changed between two specs and that this stage reads.
fn changed(stage: StageName, previous: &Spec, spec: &Spec) -> Vec<String> {
    let paths = previous.diff(spec).into_iter().map(|change| change.path);
    paths.filter(|path| reads(stage).iter().any(|prefix| matches(prefix, path))).collect()
}

/// One sentence on a stage's action. `upstream` is the first earlier stage whose result is new.
pub(super) fn reason(
    stage: StageName,
    action: Action,
    from_s: Option<f64>,
    spec: &Spec,
    previous: Option<&Spec>,
    upstream: Option<StageName>,
) -> String {
    let changes = previous.map(|previous| changed(stage, previous, spec)).unwrap_or_default();
    let cause = match (changes.as_slice(), upstream, previous) {
        ([], Some(stage), _) => format!("{} ran anew", stage.as_str()),
        ([], None, None) => "first run".to_owned(),
        ([], None, Some(_)) => "not in the store".to_owned(),
        ([one], ..) => format!("{one} changed"),
        ([one, two], ..) => format!("{one} and {two} changed"),
        ([one, rest @ ..], ..) => format!("{one} and {} more changed", rest.len()),
    };
    match action {
        Action::Hit => "in the store".to_owned(),
        Action::Skip => "no pictures asked for".to_owned(),
        Action::Run => cause,
        Action::Resume => {
            let from = from_s.map(|s| format!("{s:.2} s")).unwrap_or_default();
            // What the spec says of later times alone leaves what was before; anything else resumes where an earlier
            // run, not the version before, began the same way.
            let later = |path: &String| ["event", "force", "pin", "time"].iter().any(|of| matches(of, path));
            match (changes.as_slice(), previous) {
                ([], None) => format!("an earlier run began the same: goes on from its state at {from}"),
                ([], Some(_)) if upstream.is_none() => format!("a run that was stopped: goes on from {from}"),
                (changes, _) if !changes.is_empty() && changes.iter().all(later) => format!("{cause}; goes on from {from}"),
                _ => format!("{cause}; an earlier run began the same: goes on from its state at {from}"),
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::Auto;

    #[test]
    fn reasons_name_the_path_that_the_stage_reads() {
        let before = Spec::of_scene("vase.splat");
        let mut after = before.clone();
        after.world.gravity_m_s2 = [0.0, 0.0, -1.62];
        after.time.duration_s = Auto::Value(3.0);
        let text = reason(StageName::Simulate, Action::Run, None, &after, Some(&before), None);
        assert!(text.contains("world.gravity_m_s2") && text.contains("time.duration_s"), "{text}");
        assert_eq!(reason(StageName::Proxy, Action::Hit, None, &after, Some(&before), None), "in the store");
        assert_eq!(reason(StageName::Picture, Action::Run, None, &before, Some(&before), Some(StageName::Simulate)), "simulate ran anew");
    }

    #[test]
    fn a_star_matches_one_name() {
        assert!(matches("object.*.select", "object.vase.select.box") && !matches("object.*.select", "object.vase.material"));
    }
}

//! Edits that were made on one version and are to hold on another one, which somebody else added meanwhile.

use phystalk::spec::{Edit, Spec};
use serde_json::Value;

/// Paths at which two changes of one spec exclude each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Conflict {
    /// As in the spec, sorted.
    pub paths: Vec<String>,
}

/// The spec with both changes: edits made on `base`, which lead to `ours`, applied to `theirs`. Refused where both set a
/// value and the values differ.
///
/// Whether an edit was *computed* from a value that the other change set is not seen here: the caller makes computed edits
/// again on `theirs` and compares.
pub fn merge(base: &Spec, ours: &Spec, theirs: &Spec, edits: &[Edit]) -> Result<Spec, Conflict> {
    let (mine, other) = (changes(base, ours), changes(base, theirs));
    // An edit that changed nothing on `base` would still undo what the other one set since.
    let idle = edits.iter().filter(|edit| matches!(edit, Edit::Set { .. }) && !mine.iter().any(|(path, _)| overlap(path, edit.path())));
    let idle: Vec<String> = idle.map(|edit| edit.path().to_owned()).filter(|path| other.iter().any(|(p, _)| overlap(path, p))).collect();
    let excluded = |(path, value): &&(String, Option<Value>)| other.iter().any(|(p, v)| overlap(path, p) && (path, value) != (p, v));
    let mut paths: Vec<String> = mine.iter().filter(excluded).map(|(path, _)| path.clone()).chain(idle).collect();
    if paths.is_empty() {
        match theirs.apply(edits) {
            Ok(merged) => return Ok(merged),
            // They removed what ours needs, or took its name.
            Err(_) => paths.extend(mine.into_iter().map(|(path, _)| path)),
        }
    }
    paths.sort();
    paths.dedup();
    Err(Conflict { paths })
}

/// The paths at which two specs differ.
pub fn changed_paths(from: &Spec, to: &Spec) -> Vec<String> {
    changes(from, to).into_iter().map(|(path, _)| path).collect()
}

fn changes(from: &Spec, to: &Spec) -> Vec<(String, Option<Value>)> {
    from.diff(to).into_iter().map(|change| (change.path, change.to)).collect()
}

/// Whether one path is the other or leads into it.
fn overlap(a: &str, b: &str) -> bool {
    let (short, long) = if a.len() < b.len() { (a, b) } else { (b, a) };
    long.strip_prefix(short).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn edited(base: &Spec, edits: &[Edit]) -> Spec {
        base.apply(edits).unwrap()
    }

    #[test]
    fn changes_of_different_values_are_both_kept_and_of_one_value_refused() {
        let base = Spec::of_scene("vase.splat");
        let moon = [Edit::set("world.gravity_m_s2", json!([0.0, 0.0, -1.62]))];
        let mars = [Edit::set("world.gravity_m_s2", json!([0.0, 0.0, -3.71]))];
        let heavy = [Edit::set("object.vase.material.density_kg_m3", 2000)];
        let both = merge(&base, &edited(&base, &heavy), &edited(&base, &moon), &heavy).unwrap();
        assert_eq!(both, edited(&edited(&base, &moon), &heavy));
        let conflict = merge(&base, &edited(&base, &mars), &edited(&base, &moon), &mars).unwrap_err();
        assert_eq!(conflict.paths, ["world.gravity_m_s2"]);
        assert_eq!(merge(&base, &edited(&base, &moon), &edited(&base, &moon), &moon).unwrap(), edited(&base, &moon), "both said the same");
    }

    #[test]
    fn an_edit_that_set_what_was_there_does_not_undo_what_somebody_else_set() {
        let base = Spec::of_scene("vase.splat");
        let theirs = edited(&base, &[Edit::set("seed", 5)]);
        let ours = [Edit::set("seed", base.seed), Edit::set("time.fps", 25)];
        assert_eq!(merge(&base, &edited(&base, &ours), &theirs, &ours).unwrap_err().paths, ["seed"]);
        assert!(merge(&base, &edited(&base, &ours), &edited(&base, &[Edit::set("solver.cells_across", 20)]), &ours).is_ok());
    }

    #[test]
    fn what_leads_into_a_removed_or_replaced_entry_is_refused() {
        assert!(overlap("object.vase", "object.vase.material.young_pa") && overlap("seed", "seed"));
        assert!(!overlap("object.vase", "object.vase2.material") && !overlap("force.wind1", "force.wind12"));
        let wall = json!({ "name": "wall", "shape": { "plane": { "point_m": [0.0, 1.0, 0.0], "normal": [0.0, -1.0, 0.0] } } });
        let base = edited(&Spec::of_scene("vase.splat"), &[Edit::add("collider", wall)]);
        let smooth = [Edit::set("collider.wall.friction", 0.0)];
        let gone = [Edit::remove("collider.wall")];
        assert!(merge(&base, &edited(&base, &smooth), &edited(&base, &gone), &smooth).is_err());
        assert!(merge(&base, &edited(&base, &gone), &edited(&base, &smooth), &gone).is_err());
    }
}

//! The phrasebook against tables of phrases, and properties that hold for any text.

mod properties;
mod table;

use super::*;
use phystalk::spec::{Axis, BoxShape, Camera, Collider, ColliderShape, Object};
use phystalk::world::{Mark, ObjectFacts, Seam};

/// A scene to speak about: its spec, its facts, and what was resolved.
pub struct Stage {
    pub spec: Spec,
    pub facts: Facts,
    pub resolved: serde_json::Map<String, serde_json::Value>,
    pub previous: Option<Spec>,
}

impl Stage {
    /// A vase one metre high that stands on the ground at 0.
    pub fn vase() -> Stage {
        Stage::of(&["vase"])
    }

    /// Things of one metre in a row along y.
    pub fn of(names: &[&str]) -> Stage {
        let mut spec = Spec::of_scene("vase.splat");
        spec.objects = names.iter().map(|n| Object::new(n)).collect();
        let objects = names.iter().enumerate().map(|(i, name)| {
            let y = 2.0 * i as f64;
            ObjectFacts {
                name: (*name).to_owned(),
                gaussians: 9499,
                low_m: [-0.2, y - 0.5, 0.0],
                high_m: [0.2, y + 0.5, 1.0],
                centre_m: [0.0, y, 0.5],
                support_m: 0.0,
                forward: Axis::PlusX,
            }
        });
        let camera = Camera { eye_m: [-3.48, -1.96, 1.2], target_m: [0.0, 0.0, 0.5], fov_deg: 45.0, orbit_deg_s: 0.0 };
        let facts = Facts {
            objects: objects.collect(),
            seams: vec![Seam { share: 0.42, by: Mark::Neck }; names.len()],
            ground_m: 0.0,
            camera,
            has_static: false,
        };
        let mut resolved = serde_json::Map::new();
        for name in names {
            resolved.insert(format!("object.{name}.material.young_pa"), 200_000.0.into());
        }
        resolved.insert("time.duration_s".to_owned(), 2.0.into());
        Stage { spec, facts, resolved, previous: None }
    }

    /// On a table of 0.8 m by 0.6 m.
    pub fn with_table(mut self) -> Stage {
        let shape = ColliderShape::Box(BoxShape { centre_m: [0.0, 0.0, -0.05], size_m: [0.8, 0.6, 0.1] });
        self.spec.colliders.push(Collider { name: "table".to_owned(), shape, friction: 0.3, restitution: 0.0 });
        self.facts.ground_m = -0.8;
        self
    }

    pub fn ask(&self, text: &str) -> Reply {
        let resolved = |path: &str| self.resolved.get(path).and_then(serde_json::Value::as_f64);
        understand(text, &Context { spec: &self.spec, facts: &self.facts, resolved: &resolved, previous_spec: self.previous.as_ref() })
    }

    /// The stage after a turn that must make edits.
    pub fn then(mut self, text: &str) -> Stage {
        match self.ask(text) {
            Reply::Edits { edits, .. } => {
                let next = self.spec.apply(&edits).unwrap_or_else(|e| panic!("{text}: {e:?}"));
                self.previous = Some(std::mem::replace(&mut self.spec, next));
                self
            }
            other => panic!("{text}: {other:?}"),
        }
    }
}

/// A reply on one line, for tables: edits by path and value, or what else it is.
pub fn line(reply: &Reply) -> String {
    let words = |words: &[String]| if words.is_empty() { String::new() } else { format!(" ?{}", words.join(",")) };
    match reply {
        Reply::Edits { edits, not_understood, .. } => {
            let edits: Vec<String> = edits.iter().map(edit_line).collect();
            format!("{}{}", edits.join("; "), words(not_understood))
        }
        Reply::Undo(n) => format!("undo {n}"),
        Reply::Redo(n) => format!("redo {n}"),
        Reply::BackTo(version) => format!("back to {version:?}"),
        Reply::Compare(from, to) => format!("compare {from:?} {to:?}"),
        Reply::Refused { not_understood, .. } => format!("refused{}", words(not_understood)),
    }
}

fn edit_line(edit: &Edit) -> String {
    let plain = |v: &serde_json::Value| v.to_string().replace('"', "").replace(',', " ");
    match edit {
        Edit::Set { path, value } => format!("{} = {}", short_path(path), plain(value)),
        Edit::Add { path, value } => format!("+{path} {}", plain(value)),
        Edit::Remove { path } => format!("-{path}"),
    }
}

fn short_path(path: &str) -> String {
    path.replace("object.vase.", "").replace("material.", "").replace("world.", "")
}

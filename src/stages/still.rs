//! The stages before motion: scene, proxy, bind. Each is taken from memory, else from the store,
//! else made and kept.

use super::keys::{self, StillKeys};
use super::{Action, EngineError, pack};
use crate::proxy::{self, ProxyRequest, Solid, Stance};
use crate::scene::{self, Format, Gaussians, Loaded, SceneFrame};
use crate::skin::{self, Bound};
use crate::spec::{Auto, Axis, Select, Spec, file_name};
use crate::store::Store;
use crate::world::{Prepared, Resolved};
use glam::Vec3;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// The name that stands for the built-in scene.
pub const BUILTIN_DEMO: &str = "builtin:demo";

/// What stays in memory between runs: the last scene and what was made of it.
#[derive(Debug, Default)]
pub(super) struct Memory {
    file: Option<(String, Arc<Loaded>)>,
    /// With what was done for it, which a plan tells until a run has told it.
    scene: Option<(String, Made<Prepared>)>,
    solids: Option<(String, Arc<Vec<Solid>>)>,
    bound: Option<(String, Arc<Bound>)>,
    /// Automatic stiffness of objects, by what it is made of.
    pub young_pa: BTreeMap<String, f64>,
}

impl Memory {
    /// A run has told what was done: from now on it is there.
    pub fn told(&mut self) {
        if let Some((_, made)) = &mut self.scene {
            made.action = Action::Hit;
        }
    }
}

/// A stage's result and how it was had.
#[derive(Debug)]
pub(super) struct Made<T> {
    pub value: Arc<T>,
    pub action: Action,
}

impl<T> Clone for Made<T> {
    fn clone(&self) -> Self {
        Made { value: self.value.clone(), action: self.action }
    }
}

/// Reads the scene's file, or takes it from memory where path, length and time are unchanged.
fn load(memory: &mut Memory, spec: &Spec, base: &Path) -> Result<Arc<Loaded>, EngineError> {
    if spec.scene.file == BUILTIN_DEMO {
        let tag = format!("{BUILTIN_DEMO} {}", spec.seed);
        if let Some((known, loaded)) = &memory.file
            && *known == tag
        {
            return Ok(loaded.clone());
        }
        let loaded = Arc::new(builtin(spec.seed));
        memory.file = Some((tag, loaded.clone()));
        return Ok(loaded);
    }
    let path = base.join(file_name::decode(&spec.scene.file));
    let stamp = std::fs::metadata(&path).ok().map(|m| format!("{} {} {:?}", path.display(), m.len(), m.modified().ok()));
    if let (Some((known, loaded)), Some(stamp)) = (&memory.file, &stamp)
        && known == stamp
    {
        return Ok(loaded.clone());
    }
    let loaded = Arc::new(scene::read(&path)?);
    if let Some(stamp) = stamp {
        memory.file = Some((stamp, loaded.clone()));
    }
    Ok(loaded)
}

/// The built-in scene, as if it had been read.
fn builtin(seed: u64) -> Loaded {
    let gaussians = scene::demo::gaussians(seed);
    let mut hash = blake3::Hasher::new();
    for array in [bytemuck::cast_slice::<_, u8>(&gaussians.mean), bytemuck::cast_slice(&gaussians.scale), bytemuck::cast_slice(&gaussians.rotation)] {
        hash.update(array);
    }
    hash.update(bytemuck::cast_slice(&gaussians.opacity)).update(bytemuck::cast_slice(&gaussians.sh));
    let place = (0..gaussians.len() as u32).collect();
    Loaded { gaussians, place, format: Format::Ply, warnings: Vec::new(), blake3: hash.finalize().to_hex().to_string(), stated_up: None }
}

/// Key and result of the scene stage.
pub(super) fn scene(memory: &mut Memory, store: &Store, spec: &Spec, base: &Path) -> Result<(String, Made<Prepared>), EngineError> {
    let loaded = load(memory, spec, base)?;
    if let Some(recorded) = &spec.scene.blake3
        && *recorded != loaded.blake3
    {
        let (file, found, recorded) = (spec.scene.file.clone(), loaded.blake3.clone(), recorded.clone());
        return Err(EngineError::SceneChanged { file, found, recorded });
    }
    let key = keys::scene(spec, &loaded.blake3);
    if let Some((known, made)) = &memory.scene
        && *known == key
    {
        return Ok((key, made.clone()));
    }
    let kept = pack::find(store, "scene", &key)?.and_then(|entry| Some((axis(entry.meta().get("up")?)?, pack::read::<u8>(&entry, "floater").ok()??)));
    let (action, pruned) = match kept {
        Some((up, floater)) if floater.len() == loaded.gaussians.len() => (Action::Hit, (up, floater)),
        _ => (Action::Run, prune(&loaded, spec)),
    };
    let prepared = Arc::new(divide(&loaded, spec, &pruned.1, pruned.0)?);
    if action == Action::Run {
        let entry = store.begin("scene", &key)?;
        pack::write(&entry, "floater", &pruned.1)?;
        entry.finish(json!({ "up": pruned.0, "gaussians": loaded.gaussians.len() }))?;
    }
    let made = Made { value: prepared, action };
    memory.scene = Some((key.clone(), made.clone()));
    Ok((key, made))
}

fn axis(value: &Value) -> Option<Axis> {
    serde_json::from_value(value.clone()).ok()
}

/// Which axis is up, and which Gaussians float alone, in the file's order.
fn prune(loaded: &Loaded, spec: &Spec) -> (Axis, Vec<u8>) {
    let up = match spec.scene.up {
        Auto::Value(axis) => axis,
        Auto::Auto => loaded.up().axis,
    };
    (up, scene::floaters(&loaded.gaussians).into_iter().map(u8::from).collect())
}

/// Turns the scene upright, orders it along a Morton curve, and gives each object its Gaussians.
fn divide(loaded: &Loaded, spec: &Spec, floater: &[u8], up: Axis) -> Result<Prepared, EngineError> {
    let frame = SceneFrame { up, metres_per_unit: spec.scene.metres_per_unit as f32 };
    let world = loaded.gaussians.to_world(&frame);
    let order = world.morton_order();
    let gaussians = world.subset(&order);
    let place: Vec<u32> = order.iter().map(|&i| loaded.place[i as usize]).collect();
    let floater: Vec<bool> = order.iter().map(|&i| floater[i as usize] != 0).collect();
    let mut object_of = vec![u32::MAX; gaussians.len()];
    for (index, object) in spec.objects.iter().enumerate() {
        let mut any = false;
        for member in scene::select(&gaussians, &place, &object.select) {
            let owner = &mut object_of[member as usize];
            // Where objects overlap, the first one named keeps the Gaussian.
            if *owner == u32::MAX {
                *owner = index as u32;
                any |= !floater[member as usize];
            }
        }
        if !any {
            let select = serde_json::to_string(&object.select).unwrap_or_default();
            return Err(EngineError::Empty { object: object.name.clone(), gaussians: gaussians.len(), select });
        }
    }
    let lowest = Prepared::lowest(&gaussians, &object_of, &floater).map_or(0.0, f64::from);
    let mut warnings = loaded.warnings.clone();
    if spec.scene.up == Auto::Auto {
        let guess = loaded.up();
        warnings.extend((!guess.why.is_empty()).then(|| format!("up axis taken as {}: {}", axis_name(up), guess.why)));
    }
    let known: std::collections::BTreeSet<u32> = loaded.place.iter().copied().collect();
    for object in &spec.objects {
        let Select::Ids(ids) = &object.select else { continue };
        let unknown = ids.iter().filter(|id| !known.contains(id)).count();
        if unknown > 0 {
            warnings.push(format!(
                "{}: {unknown} of its {} ids are of no Gaussian that was read; the file has {}",
                object.name,
                ids.len(),
                known.len()
            ));
        }
    }
    let ground_m = spec.world.ground.height_m.unwrap_or(lowest);
    Ok(Prepared { gaussians, world_from_sh: frame.quat(), object_of, floater, up, ground_m, warnings })
}

fn axis_name(axis: Axis) -> String {
    serde_json::to_value(axis).ok().and_then(|v| v.as_str().map(str::to_owned)).unwrap_or_default()
}

/// Solids of all objects, one for each object of the spec.
pub(super) fn solids(
    memory: &mut Memory,
    store: &Store,
    spec: &Spec,
    prepared: &Prepared,
    keys: &StillKeys,
    resolved: &Resolved,
) -> Result<Made<Vec<Solid>>, EngineError> {
    if let Some((known, solids)) = &memory.solids
        && *known == keys.proxy
    {
        return Ok(Made { value: solids.clone(), action: Action::Hit });
    }
    let kept = match pack::find(store, "proxy", &keys.proxy)? {
        Some(entry) => read_solids(&entry)?.filter(|solids| solids.len() == spec.objects.len()),
        None => None,
    };
    let action = if kept.is_some() { Action::Hit } else { Action::Run };
    let solids = match kept {
        Some(solids) => solids,
        None => {
            let solids = build_solids(spec, prepared, resolved)?;
            keep_solids(store, &keys.proxy, &solids)?;
            solids
        }
    };
    let value = Arc::new(solids);
    memory.solids = Some((keys.proxy.clone(), value.clone()));
    Ok(Made { value, action })
}

fn build_solids(spec: &Spec, prepared: &Prepared, resolved: &Resolved) -> Result<Vec<Solid>, EngineError> {
    let one = |(index, object): (usize, &crate::spec::Object)| {
        let gaussians: Gaussians = prepared.gaussians.subset(&prepared.members(index as u32, false));
        let request = ProxyRequest {
            gaussians: &gaussians,
            ground_m: resolved.ground_m as f32,
            cell_m: resolved.cell_m as f32,
            kind: object.proxy,
            stands: object.stands(),
            seed: spec.seed.wrapping_add(index as u64),
        };
        proxy::build(&request).map_err(|source| EngineError::Proxy { object: object.name.clone(), source })
    };
    spec.objects.iter().enumerate().map(one).collect()
}

fn keep_solids(store: &Store, key: &str, solids: &[Solid]) -> Result<(), EngineError> {
    let entry = store.begin("proxy", key)?;
    let mut rows = Vec::new();
    for (index, solid) in solids.iter().enumerate() {
        let positions: Vec<[f32; 3]> = solid.position_m.iter().map(|p| p.to_array()).collect();
        let inner: Vec<u8> = solid.inner.iter().map(|&b| u8::from(b)).collect();
        pack::write(&entry, &format!("{index}.position"), &positions)?;
        pack::write(&entry, &format!("{index}.volume"), &solid.volume_m3)?;
        pack::write(&entry, &format!("{index}.inner"), &inner)?;
        pack::write(&entry, &format!("{index}.stance"), &solid.stance.local_m)?;
        pack::write(&entry, &format!("{index}.from_base"), &solid.stance.from_base_m)?;
        let (hung, hung_at): (Vec<u32>, Vec<[f32; 3]>) = solid.hung.iter().map(|&(g, at)| (g, at.to_array())).unzip();
        pack::write(&entry, &format!("{index}.hung"), &hung)?;
        pack::write(&entry, &format!("{index}.hung_at"), &hung_at)?;
        rows.push(json!({ "stance_m": solid.stance.whole_m, "fill_ratio": solid.fill_ratio, "spacing_m": solid.spacing_m, "volume_total_m3": solid.volume_total_m3, "warnings": solid.warnings }));
    }
    entry.finish(json!({ "solids": rows }))?;
    Ok(())
}

/// Numbers of a solid that are not arrays.
#[derive(serde::Deserialize)]
struct SolidRow {
    stance_m: f64,
    fill_ratio: f32,
    spacing_m: f32,
    volume_total_m3: f32,
    warnings: Vec<String>,
}

fn read_solids(entry: &crate::store::Entry) -> Result<Option<Vec<Solid>>, EngineError> {
    let Some(Ok(rows)) = entry.meta().get("solids").map(|v| serde_json::from_value::<Vec<SolidRow>>(v.clone())) else { return Ok(None) };
    let mut solids = Vec::new();
    for (index, row) in rows.into_iter().enumerate() {
        let (Some(position), Some(volume_m3), Some(inner), Some(local_m), Some(from_base_m), Some(hung), Some(hung_at)) = (
            pack::read::<[f32; 3]>(entry, &format!("{index}.position"))?,
            pack::read::<f32>(entry, &format!("{index}.volume"))?,
            pack::read::<u8>(entry, &format!("{index}.inner"))?,
            pack::read::<f32>(entry, &format!("{index}.stance"))?,
            pack::read::<f32>(entry, &format!("{index}.from_base"))?,
            pack::read::<u32>(entry, &format!("{index}.hung"))?,
            pack::read::<[f32; 3]>(entry, &format!("{index}.hung_at"))?,
        ) else {
            return Ok(None);
        };
        solids.push(Solid {
            position_m: position.into_iter().map(Vec3::from).collect(),
            volume_m3,
            inner: inner.into_iter().map(|b| b != 0).collect(),
            fill_ratio: row.fill_ratio,
            spacing_m: row.spacing_m,
            volume_total_m3: row.volume_total_m3,
            stance: Stance { whole_m: row.stance_m, local_m, from_base_m },
            hung: hung.into_iter().zip(hung_at.into_iter().map(Vec3::from)).collect(),
            warnings: row.warnings,
        });
    }
    Ok(Some(solids))
}

/// The Gaussians of threads, ascending, and where the thread that each belongs to ends on the solid.
fn hung(prepared: &Prepared, solids: &[Solid]) -> Vec<(u32, Vec3)> {
    let mut hung = Vec::new();
    for (index, solid) in solids.iter().enumerate().filter(|(_, solid)| !solid.hung.is_empty()) {
        let members = prepared.members(index as u32, false);
        hung.extend(solid.hung.iter().filter_map(|&(member, at)| Some((*members.get(member as usize)?, at))));
    }
    hung.sort_unstable_by_key(|&(gaussian, _)| gaussian);
    hung
}

/// Each Gaussian's particles and weights.
pub(super) fn bound(
    memory: &mut Memory,
    store: &Store,
    spec: &Spec,
    prepared: &Prepared,
    solids: &[Solid],
    keys: &StillKeys,
) -> Result<Made<Bound>, EngineError> {
    if let Some((known, bound)) = &memory.bound
        && *known == keys.bind
    {
        return Ok(Made { value: bound.clone(), action: Action::Hit });
    }
    let expected = prepared.gaussians.len();
    let kept = match pack::find(store, "bind", &keys.bind)? {
        Some(entry) => match (pack::read::<u32>(&entry, "index")?, pack::read::<f32>(&entry, "weight")?, entry.meta().get("neighbours")) {
            (Some(index), Some(weight), Some(n)) => {
                let neighbours = n.as_u64().unwrap_or(0) as u32;
                let whole = index.len() == expected * neighbours as usize && weight.len() == index.len();
                whole.then(|| Bound { neighbours, index, weight, hung: hung(prepared, solids) })
            }
            _ => None,
        },
        None => None,
    };
    let action = if kept.is_some() { Action::Hit } else { Action::Run };
    let value = Arc::new(match kept {
        Some(bound) => bound,
        None => {
            let particles: Vec<Vec3> = solids.iter().flat_map(|s| s.position_m.iter().copied()).collect();
            let owner: Vec<u32> = solids.iter().enumerate().flat_map(|(i, s)| std::iter::repeat_n(i as u32, s.position_m.len())).collect();
            let hung = hung(prepared, solids);
            let mut held = prepared.gaussians.mean.clone();
            hung.iter().for_each(|&(gaussian, at)| held[gaussian as usize] = at);
            let bound = Bound { hung, ..skin::bind(&held, &prepared.object_of, &particles, &owner, &spec.skin) };
            let entry = store.begin("bind", &keys.bind)?;
            pack::write(&entry, "index", &bound.index)?;
            pack::write(&entry, "weight", &bound.weight)?;
            entry.finish(json!({ "neighbours": bound.neighbours }))?;
            bound
        }
    });
    memory.bound = Some((keys.bind.clone(), value.clone()));
    Ok(Made { value, action })
}

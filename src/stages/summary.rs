//! A finished run as `metrics.json` tells it.

use super::engine::Ready;
use super::keys;
use super::segments::SolverTotals;
use super::{EventMetrics, ExpectationResult, LeftMetrics, MemoryMetrics, Metrics, ObjectMetrics, SolverMetrics, SubstepRange, lookup};
use crate::gpu::Gpu;
use crate::render::View;
use crate::solver::{Advance, Taut};
use crate::spec::expect::Condition;
use crate::spec::{Event, Object, Spec, limits};
use crate::world::ObjectFacts;
use crate::world::bodies::Matter;
use crate::world::measure::Row;
use std::collections::BTreeMap;

/// A solid is crushed under this share of its volume.
const CRUSHED: f64 = 0.25;

/// Sums of one advance.
pub(super) fn totals(advance: &Advance, spec: &Spec) -> SolverTotals {
    let name = |object: u32| spec.objects.get(object as usize).map_or("an object", |o| o.name.as_str());
    SolverTotals {
        substeps: advance.substeps,
        dt_min_s: if advance.substeps > 0 { advance.dt_min_s } else { 0.0 },
        dt_max_s: advance.dt_max_s,
        retries: advance.retries,
        softened: advance
            .softened
            .iter()
            .map(|s| {
                let (unit, what) = match s.what {
                    Taut::Stiffness => ("Pa", "stiffness"),
                    Taut::SurfaceTension => ("N/m", "surface tension"),
                    Taut::Hardening => ("times its stiffness where it is packed", "hardening"),
                };
                let (name, value, from_s) = (name(s.object), s.value, s.time_s);
                format!("{name}: simulated with at most {value:.2e} {unit} from {from_s:.3} s on, {:.2e} of its {what}: {}", s.factor, s.reason)
            })
            .collect(),
        undefined: advance.undefined.iter().filter_map(|(name, times)| Some((key_of(spec, name)?, *times))).collect(),
        limited: advance.limited,
        held_m_s: f64::from(advance.held_m_s),
        mended: advance.mended.iter().map(|(object, times)| (name(*object).to_owned(), *times)).collect(),
        left: advance.left.iter().map(|(object, left)| (name(*object).to_owned(), (*left).into())).collect(),
        unmet: advance.unmet,
        ..SolverTotals::default()
    }
}

fn key_of(spec: &Spec, force: &str) -> Option<String> {
    spec.forces.iter().find(|f| f.name == force).map(keys::force)
}

/// How often each force gave no number, by the name that the spec has for it. Of equal ones the first counts.
fn undefined(totals: &SolverTotals, spec: &Spec) -> BTreeMap<String, u64> {
    let name = |key: &String| spec.forces.iter().find(|f| keys::force(f) == *key).map(|f| f.name.clone());
    totals.undefined.iter().filter_map(|(key, times)| Some((name(key)?, *times))).collect()
}

/// What forces did otherwise than they were told, in words.
pub(super) fn of_forces(totals: &SolverTotals, spec: &Spec) -> Vec<String> {
    let undefined = undefined(totals, spec).into_iter().map(|(name, times)| {
        format!("force.{name} gave no number {times} times (a division by zero, a root or logarithm of a negative): it counted as zero there")
    });
    let limited = (totals.limited > 0)
        .then(|| format!("forces would have brought particles beyond {} m/s {} times: they were held there", limits::SPEED_M_S, totals.limited));
    let held = (totals.held_m_s > 0.0).then(|| {
        format!(
            "something would have been faster than {:.3e} m/s, the most that the substeps of a frame follow, and was held there: use a higher time.fps \
             (up to {}) or solver.substeps_most (up to {}), or a smaller solver.cells_across (down to {})",
            totals.held_m_s,
            limits::FPS,
            limits::SUBSTEPS.1,
            limits::CELLS_ACROSS.0
        )
    });
    undefined.chain(limited).chain(held).collect()
}

/// What no substep resolved, in words.
pub(super) fn of_mended(totals: &SolverTotals) -> Vec<String> {
    let text = |(name, times): (&String, &u64)| {
        format!(
            "{name}: {times} times a particle came to what neither shorter substeps nor softer matter resolve, and lost its strain or its speed there: \
             lower the speeds, raise material.young_pa, or use a smaller solver.cells_across"
        )
    };
    totals.mended.iter().map(text).collect()
}

/// What flew away, in words.
pub(super) fn of_left(totals: &SolverTotals) -> Vec<String> {
    let text = |(name, left): (&String, &LeftMetrics)| {
        let (particles, away_m) = (left.particles, left.away_m);
        let them = if particles == 1 { "1 particle flew up to".to_owned() } else { format!("{particles} particles flew up to") };
        format!(
            "{name}: {them} {away_m:.3} m away from the rest, farther than the grid holds, and are no longer followed: they weigh nothing from then on \
             and are not seen"
        )
    };
    totals.left.iter().map(text).collect()
}

/// What contacts were left out, in words.
pub(super) fn of_contacts(totals: &SolverTotals) -> Option<String> {
    let text = "a rigid body touched more than a dozen things at one time: on its side the dozen that pressed deepest counted";
    totals.unmet.then(|| text.to_owned())
}

/// When what waited for an impact came about, in words.
pub(super) fn of_impacts(spec: &Spec, totals: &SolverTotals, cell_m: f64, stopped: bool) -> Vec<String> {
    let told = |event: &EventMetrics, waits: bool| match event.at_s {
        Some(at_s) if waits => Some(format!("{}: {} met something at {at_s:.3} s", event.name, event.object)),
        None if waits && !stopped => Some(format!(
            "{}: {} met nothing that it had been clear of by half a cell ({:.1} cm), so it did not happen",
            event.name,
            event.object,
            50.0 * cell_m
        )),
        _ => None,
    };
    let events = events(spec, totals, f64::INFINITY);
    events.iter().zip(&spec.events).filter_map(|(event, asked)| told(event, asked.when.is_some())).collect()
}

/// Solids that ended as little of their volume, which nothing of that kind does.
pub(super) fn of_crushed(spec: &Spec, metrics: &Metrics) -> Vec<String> {
    let solid = |o: &&Object| o.material.stands() && !spec.events.iter().any(|e| e.object == o.name && e.material.is_some());
    let left = |o: &Object| metrics.objects.get(&o.name)?.volume_ratio.last().copied();
    let crushed = spec.objects.iter().filter(solid).filter_map(|o| Some((o, left(o)?))).filter(|(_, ratio)| *ratio < CRUSHED);
    crushed
        .map(|(o, ratio)| {
            format!(
                "{}: was crushed to {:.0} % of its volume and stays so: it is too soft for what hits it, \"stiffer\" or a higher material.young_pa helps",
                o.name,
                100.0 * ratio.max(0.0)
            )
        })
        .collect()
}

/// When each event of the spec happened.
fn events(spec: &Spec, totals: &SolverTotals, end_s: f64) -> Vec<EventMetrics> {
    let mut waiting = 0..;
    let when = |event: &Event| match event.when {
        None => event.at_s.filter(|at_s| *at_s < end_s),
        Some(_) => {
            let number = waiting.next();
            totals.fired.iter().find(|(fired, _)| Some(*fired) == number).map(|(_, at_s)| *at_s)
        }
    };
    let times: Vec<Option<f64>> = spec.events.iter().map(when).collect();
    spec.events.iter().zip(times).map(|(e, at_s)| EventMetrics { name: e.name.clone(), object: e.object.clone(), at_s }).collect()
}

/// Everything that was measured.
pub(super) fn metrics(
    spec: &Spec,
    ready: &Ready,
    matter: &Matter,
    rows: &[Vec<Row>],
    totals: &SolverTotals,
    seconds: BTreeMap<String, f64>,
    gpu: &Gpu,
) -> Metrics {
    let fps = spec.time.fps;
    let facts = ready.prepared.value.object_facts(spec);
    let duration_s = rows.len().saturating_sub(1) as f64 / f64::from(fps);
    let mut metrics = Metrics {
        version: String::new(),
        spec: spec.hash(),
        fps,
        frames: rows.len() as u32,
        duration_s,
        solver: SolverMetrics {
            device: gpu.name().to_owned(),
            quality: if ready.draft { "draft" } else { "full" }.to_owned(),
            cell_m: ready.resolved.cell_m,
            substep_s: SubstepRange { min: totals.dt_min_s, max: totals.dt_max_s },
            substeps: totals.substeps,
            particles: matter.particles.len() as u64,
            nonfinite: totals.nonfinite,
            retries: totals.retries,
            softened: totals.softened.clone(),
            undefined: undefined(totals, spec),
            limited: totals.limited,
            held_m_s: totals.held_m_s,
            mended: totals.mended.clone(),
            left: totals.left.clone(),
            simulate_s: totals.seconds,
        },
        resolved: resolved(spec, ready, matter),
        seconds,
        memory: MemoryMetrics::default(),
        objects: spec.objects.iter().zip(&facts).enumerate().map(|(i, (o, facts))| (o.name.clone(), object(facts, matter, rows, i, fps))).collect(),
        events: events(spec, totals, duration_s),
        expect: Vec::new(),
    };
    metrics.expect = spec.expectations.iter().map(|e| expectation(&metrics, &e.that)).collect();
    metrics
}

/// Values that were `"auto"`, by path.
fn resolved(spec: &Spec, ready: &Ready, matter: &Matter) -> serde_json::Map<String, serde_json::Value> {
    let mut values = serde_json::Map::new();
    values.extend(matter.young_auto.iter().map(|(path, young_pa)| (path.clone(), (*young_pa).into())));
    values.extend(ready.resolved.report(spec));
    let c = &ready.resolved.camera;
    let point = |p: [f64; 3]| glam::Vec3::from(p.map(|v| v as f32));
    let view = View::look_at(point(c.eye_m), point(c.target_m), c.fov_deg as f32, ready.resolved.size);
    values.insert("camera".to_owned(), serde_json::to_value(view).unwrap_or_default());
    values
}

fn object(facts: &ObjectFacts, matter: &Matter, rows: &[Vec<Row>], index: usize, fps: u32) -> ObjectMetrics {
    let column = |pick: fn(&Row) -> f64| rows.iter().map(|r| pick(&r[index])).collect::<Vec<f64>>();
    let range = matter.bodies.ranges[index].clone();
    let particles = &matter.particles.position_m[range.clone()];
    let lowest = particles.iter().map(|p| f64::from(p.z)).fold(f64::INFINITY, f64::min);
    let mut metrics = ObjectMetrics {
        particles: range.len() as u64,
        gaussians: matter.gaussians[index] as u64,
        mass_kg: matter.bodies.mass_kg[range].iter().map(|&m| f64::from(m)).sum(),
        fill_ratio: matter.fill_ratio[index],
        com_m: rows.iter().map(|r| r[index].com_m).collect(),
        low_m: column(|r| r.low_m),
        high_m: column(|r| r.high_m),
        speed_m_s: column(|r| r.speed_m_s),
        mean_speed_m_s: column(|r| r.mean_speed_m_s),
        volume_ratio: column(|r| r.volume_ratio),
        stretch_max: column(|r| r.stretch_max),
        spin_rad_s: rows.iter().map(|r| r[index].spin_rad_s).collect(),
        kinetic_j: column(|r| r.kinetic_j),
        spread_m: column(|r| r.spread_m),
        gap_m: column(|r| r.gap_m),
        impacts_s: Vec::new(),
    };
    metrics.impacts_s = metrics.impacts_s(lowest - facts.support_m, facts.height_m(), fps);
    metrics
}

fn expectation(metrics: &Metrics, text: &str) -> ExpectationResult {
    match Condition::parse(text) {
        Ok(condition) => {
            let outcome = condition.evaluate(|object, metric| lookup(metrics, object, metric));
            ExpectationResult { text: text.to_owned(), value: outcome.value, held: outcome.held }
        }
        // `Spec::validate` refuses such a condition before anything runs.
        Err(_) => ExpectationResult { text: text.to_owned(), value: None, held: false },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spec::{Force, Until};

    #[test]
    fn a_force_is_told_of_by_the_name_that_it_has_now() {
        let mut spec = Spec::of_scene("vase.splat");
        spec.forces = vec![Force::constant("gale", "vase", 0.1, Until::End, [1.0, 0.0, 0.0]), Force::new("other", "vase", 0.0, Until::End)];
        let kept = totals(&Advance { undefined: vec![("gale".to_owned(), 3)], ..Advance::default() }, &spec);
        // Another version shares what was kept of it.
        (spec.forces[0].name, spec.forces[0].to_s) = ("breeze".to_owned(), Until::Time(2.0));
        assert_eq!(undefined(&kept, &spec), BTreeMap::from([("breeze".to_owned(), 3)]));
        assert!(of_forces(&kept, &spec)[0].starts_with("force.breeze gave no number 3 times"));
    }
}

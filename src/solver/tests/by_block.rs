//! The form of the transfers that GPUs run, on whatever device the tests have.

use super::laws::{all_laws, liquids};
use super::twins::{SUBSTEP, follows_the_twins_on, gpu, node_count, run, scene_on, shown_rows, sort};
use crate::Stop;
use crate::gpu::{Gpu, Recording, Tier};
use crate::solver::advance::Substep;
use crate::solver::record::Bound;
use crate::solver::state::ParticleState;
use crate::solver::substance::Substance;
use crate::solver::twin;
use crate::solver::validate::{append, block};
use crate::solver::{Activation, Plane, Settings, Solver};
use crate::spec::ElasticModel;
use glam::Vec3;

fn taken_for(tier: Tier) -> Gpu {
    let mut gpu = gpu();
    gpu.tier = tier;
    gpu
}

/// The test's device, taken for a GPU.
fn as_gpu() -> Gpu {
    taken_for(Tier::Gpu)
}

fn elastic() -> [Substance; 2] {
    [Substance::Elastic(ElasticModel::Corotated), Substance::Elastic(ElasticModel::NeoHookean)]
}

#[test]
fn one_substep_pass_by_pass() {
    follows_the_twins_on(&as_gpu(), elastic());
}

/// Every law that moves on the grid, two at a time.
fn pairs_of_laws() -> Vec<[Substance; 2]> {
    let [_, neo_hookean, muscle, hardening, softening, viscoplastic, sand, sticky, snow] = all_laws().try_into().expect("nine");
    vec![elastic(), [muscle, hardening], [viscoplastic, softening], [sand, sticky], [snow, neo_hookean], liquids()]
}

#[test]
fn one_substep_of_other_laws() {
    pairs_of_laws().into_iter().skip(1).for_each(|pair| follows_the_twins_on(&as_gpu(), pair));
}

#[test]
fn the_sort_deals_the_particles_of_a_block_out_by_cell() {
    let (mut solver, states) = scene_on(&as_gpu(), elastic());
    solver.params.item_particles = 40;
    solver.start_segment();
    sort(&mut solver);
    let (want, n) = (twin::sort::sort(&states, &solver.params), states.len());
    let cell_of = |slot: usize| want.starts[want.starts.partition_point(|&(_, start)| start as usize <= slot) - 1].0;
    let by_cell: Vec<(u32, u32)> = (0..n).map(|slot| (cell_of(slot) / 64, want.order[slot])).collect();
    let items: Vec<&[(u32, u32)]> = by_cell.chunk_by(|a, b| a.0 == b.0).flat_map(|block| block.chunks(40)).collect();
    let dealt: Vec<u32> = items.iter().flat_map(|item| (0..8).flat_map(|hand| item.iter().skip(hand).step_by(8))).map(|p| p.1).collect();
    let matter: Vec<[f32; 4]> = gpu().read(&solver.buffers[solver.current].matter, 4 * n).expect("matter");
    assert_eq!((0..n).map(|i| matter[3 * n + i][0].to_bits()).collect::<Vec<_>>(), dealt);
    // The list of items, with its length before it.
    let listed: Vec<[u32; 4]> = gpu().read(&solver.grid.as_ref().expect("a grid").items, items.len() + 1).expect("items");
    assert_eq!(listed[0][0] as usize, items.len());
    let mut first = 0;
    for (item, listed) in items.iter().zip(&listed[1..]) {
        let end = first + item.len() as u32;
        assert_eq!(*listed, [item[0].0, want.active[item[0].0 as usize - 1], first, end]);
        first = end;
    }
}

/// A scene whose particles went two thirds of a cell since their last sort, put together again by one of two ways.
fn put_together_by(way: fn(&Solver, &Bound, &mut Recording)) -> Solver {
    let (mut solver, _) = scene_on(&as_gpu(), elastic());
    solver.params.item_particles = 40;
    solver.start_segment();
    sort(&mut solver);
    let step_m = solver.params.cell_m * 2.0 / 3.0;
    solver.edit(|state| state.position_m += Vec3::new(step_m, -step_m, step_m)).expect("an edit");
    solver.start_segment();
    let bound = solver.bind_both().expect("bound");
    run(|r| way(&solver, &bound[solver.current], r));
    solver.current = 1 - solver.current;
    solver
}

#[test]
fn a_block_s_particles_come_together_in_any_order_and_count_the_same() {
    let [sorted, regrouped] = [put_together_by(Solver::record_sort), put_together_by(Solver::record_regroup)];
    let n = sorted.particle_count() as usize;
    let originals = |solver: &Solver| -> Vec<u32> {
        let matter: Vec<[f32; 4]> = gpu().read(&solver.buffers[solver.current].matter, 4 * n).expect("matter");
        matter[3 * n..].iter().map(|label| label[0].to_bits()).collect()
    };
    let items = |solver: &Solver| -> Vec<[u32; 4]> {
        let listed = &solver.grid.as_ref().expect("a grid").items;
        let number = gpu().read::<[u32; 4]>(listed, 1).expect("their number")[0][0] as usize;
        gpu().read(listed, number + 1).expect("items")
    };
    let (before, after) = (originals(&sorted), originals(&regrouped));
    assert!(items(&sorted) == items(&regrouped) && items(&sorted).len() > 10);
    assert_ne!(before, after, "the scene's order is that of its cells already: nothing was tested");
    let mut blocks: Vec<(u32, u32, u32)> = items(&sorted)[1..].iter().map(|&[_, block, first, end]| (block, first, end)).collect();
    blocks.dedup_by(|next, block| {
        next.0 == block.0 && {
            block.2 = next.2;
            true
        }
    });
    for (block, first, end) in blocks {
        let [mut one, mut other] = [&before, &after].map(|order| order[first as usize..end as usize].to_vec());
        one.sort_unstable();
        other.sort_unstable();
        assert_eq!(one, other, "block {block}");
    }
    assert!(sums(&sorted) == sums(&regrouped));
}

/// Sums and marks of the grid after a substep's first half.
fn sums(solver: &Solver) -> (Vec<[i32; 4]>, Vec<[u32; 2]>) {
    let bound = solver.bind_both().expect("bound");
    let b = &bound[solver.current];
    run(|r| r.dispatch_with(&solver.passes.stress, &b.stress, &SUBSTEP, solver.particle_groups()));
    run(|r| solver.record_p2g(b, &SUBSTEP, r));
    let (grid, nodes) = (solver.grid.as_ref().expect("a grid"), node_count(solver));
    (gpu().read(&grid.sums, nodes).expect("sums"), gpu().read(&grid.marks, nodes).expect("marks"))
}

#[test]
fn what_left_its_block_counts_all_the_same() {
    let in_place = {
        let (mut solver, _) = scene_on(&as_gpu(), elastic());
        sort(&mut solver);
        sums(&solver)
    };
    // In the order they were given, hardly any lies in the block whose workgroup takes it.
    let (mut solver, _) = scene_on(&as_gpu(), elastic());
    sort(&mut solver);
    solver.edit(|_| ()).expect("an edit");
    let elsewhere = sums(&solver);
    assert!(in_place == elsewhere);
    assert!(in_place.1.iter().filter(|m| **m != [0; 2]).count() > 50);
}

#[test]
fn one_pass_does_what_two_do() {
    pairs_of_laws().into_iter().for_each(|pair| one_pass_does_what_two_do_to(&pair));
}

fn one_pass_does_what_two_do_to(pair: &[Substance; 2]) {
    let next = Substep { index: SUBSTEP.index + 1, lag: 1, ..SUBSTEP };
    let half = |ended: &dyn Fn(&Solver, &Bound, &mut Recording)| {
        let (mut solver, _) = scene_on(&as_gpu(), pair.clone());
        sort(&mut solver);
        sums(&solver);
        let bound = solver.bind_both().expect("bound");
        let b = &bound[solver.current];
        run(|r| r.indirect_with(&solver.passes.grid, &b.grid, &SUBSTEP, &b.active_groups, 0));
        run(|r| ended(&solver, b, r));
        let (grid, nodes) = (solver.grid.as_ref().expect("a grid"), node_count(&solver));
        let sums: Vec<[i32; 4]> = gpu().read(&grid.sums, nodes).expect("sums");
        let marks: Vec<[u32; 2]> = gpu().read(&grid.marks, nodes).expect("marks");
        (sums, marks, solver.states().expect("states"), shown_rows(&solver))
    };
    let one = half(&|solver, b, r| solver.record_fused(b, &SUBSTEP, r));
    let two = half(&|solver, b, r| {
        solver.record_g2p(b, &SUBSTEP, r);
        solver.record_p2g(b, &next, r);
    });
    assert_eq!(one.1, two.1, "{pair:?}");
    // Rounding may differ where a compiler contracts: a few units in 2^26.
    let apart = one.0.iter().flatten().zip(two.0.iter().flatten()).map(|(a, b)| (a - b).abs()).max();
    assert!(apart.is_some_and(|a| a <= 64) && one.0.iter().any(|s| s[3] > 1 << 20), "{pair:?}: {apart:?}");
    for (a, b) in one.2.iter().zip(&two.2) {
        assert!((a.position_m - b.position_m).length() < 1e-6 && a.f().abs_diff_eq(b.f(), 1e-5), "{pair:?}: {a:?} and {b:?}");
        assert!((a.history - b.history).abs() < 1e-5 * b.history.abs().max(1.0), "{pair:?}: {a:?} and {b:?}");
    }
    assert!(one.3.iter().flatten().flatten().zip(two.3.iter().flatten().flatten()).all(|(a, b)| (a - b).abs() < 1e-5), "{pair:?}: what is shown");
}

/// Two bodies, one slow and one fast, that fall onto the ground and each other.
fn fall(device: &Gpu, [first, second]: [Substance; 2]) -> Solver {
    let liquid = first.is_liquid();
    let mut particles = block(Vec3::new(0.0, 0.0, 0.03), Vec3::splat(0.15), 0.025, 1e5, 0.3);
    let other = block(Vec3::new(0.03, 0.02, 0.25), Vec3::splat(0.1), 0.025, if liquid { 1e5 } else { 5e4 }, 0.2);
    particles.substances = vec![first];
    append(&mut particles, other, second);
    particles.velocity_m_s = particles.object.iter().map(|&o| Vec3::new(0.1, 0.0, -2.0 * o as f32)).collect();
    let mut settings = Settings::new(0.05);
    settings.ground = Some(Plane { height_m: 0.0, friction: 0.4, restitution: 0.0 });
    Solver::new(device, settings, &particles).expect("a solver")
}

fn after(solver: &mut Solver, to_s: f64) -> Vec<ParticleState> {
    solver.advance(to_s, &Stop::default()).expect("frames");
    solver.states().expect("states")
}

/// What pulls at once pulls more and more.
fn gently(substance: Substance) -> Substance {
    match substance {
        Substance::Muscle { model, fibre, .. } => Substance::Muscle { model, fibre, activation: Activation::Curve(vec![(0.0, 0.0), (0.1, 0.5)]) },
        other => other,
    }
}

#[test]
fn runs_repeat_and_resume_to_the_bit() {
    let fall = |pair: &[Substance; 2]| fall(&as_gpu(), pair.clone());
    for pair in &pairs_of_laws() {
        let mut first = fall(pair);
        after(&mut first, 0.06);
        let kept = first.checkpoint().expect("a checkpoint");
        let end = after(&mut first, 0.12);
        assert!(end == after(&mut fall(pair), 0.12), "{pair:?}");
        let mut resumed = fall(pair);
        resumed.restore(&kept).expect("it fits");
        assert!(end == after(&mut resumed, 0.12), "{pair:?}");
    }
}

#[test]
fn both_forms_move_alike() {
    for pair in pairs_of_laws() {
        let on = |device: &Gpu| after(&mut fall(device, pair.clone().map(gently)), 0.1);
        for (a, b) in on(&as_gpu()).iter().zip(&on(&taken_for(Tier::Cpu))) {
            assert!((a.position_m - b.position_m).length() < 2e-5, "{pair:?}: {} and {}", a.position_m, b.position_m);
        }
    }
}

//! Each quick case of the validation holds on this device; `tests/physics.rs` has the others.

use crate::gpu::Gpu;
use crate::solver::validate::CASES;

fn holds(name: &str) {
    let gpu = Gpu::shared_for_tests().expect("a device");
    let case = CASES.iter().find(|c| c.name == name).expect("a case");
    let checks = case.run(&gpu).expect("a run");
    assert_eq!(case.flaw(&checks), None);
    checks.iter().for_each(|check| println!("{check:?}"));
    for check in checks {
        assert!(check.held, "{check:?}");
    }
}

/// A test for each case that is named, and one that none is left out.
macro_rules! quick_cases {
    ($($test:ident: $name:literal;)*) => {
        $(#[test]
        fn $test() {
            holds($name);
        })*

        #[test]
        fn every_quick_case_is_run() {
            let listed = [$($name),*];
            let missing: Vec<_> = CASES.iter().filter(|c| c.quick && !listed.contains(&c.name)).map(|c| c.name).collect();
            assert!(missing.is_empty(), "no test runs {missing:?}");
        }
    };
}

quick_cases! {
    v1_free_fall: "V1";
    v2_momentum: "V2";
    v3_angular_momentum: "V3";
    v4_spinning_rod: "V4";
    a_bending_bar: "bending bar";
    v7_column: "V7";
    v8_wave_in_a_bar: "V8";
    v9_bouncing_ball: "V9";
    v10_rigid_block_and_ball_on_a_slope: "V10";
    v11_block_on_a_slope: "V11";
    v12_cradle: "V12";
    v13_incline: "V13";
    v13_cohesion: "V13 cohesion";
    v16_tension: "V16";
    large_strain: "large strain";
    bingham_flows: "Bingham";
    v17_snow: "V17";
    a_muscle_shortens: "muscle";
    v18_dam_break: "V18";
    films_on_walls: "film";
    v19_hydrostatic: "V19";
    v20_viscous: "V20";
    v22_laplace: "V22";
    a_hanging_thread: "thread";
    loose_liquid: "loose";
    paste_on_a_slope: "paste";
    v26_liquid_same_bits: "V26 liquid";
    v18_dam_break_of_particles: "V18 SPH";
    v19_pool_of_particles: "V19 SPH";
    v20_channel_of_particles: "V20 SPH";
    v20_held_out: "V20 SPH held out";
    v22_drops_of_particles: "V22 SPH";
    v24_ball_into_jelly: "V24";
    v24_pairs: "V24 pairs";
    thin_plate: "thin plate";
    v25_joint: "V25";
    v26_same_bits: "V26";
    drag: "drag";
    spring: "spring";
    swirl: "swirl";
    attractor: "attractor";
    explosion: "explosion";
    motor: "motor";
    pin: "pin";
    impact: "impact";
    friction: "friction";
    fields_same_bits: "fields";
}

//! The validation cases that take longer than a unit test should.

use phystalk::gpu::Gpu;
use phystalk::solver::validate::CASES;

fn holds(name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let gpu = Gpu::shared_for_tests()?;
    let case = CASES.iter().find(|c| c.name == name).ok_or("no such case")?;
    let checks = case.run(&gpu)?;
    assert_eq!(case.flaw(&checks), None);
    for check in checks {
        assert!(check.held, "{check:?}");
    }
    Ok(())
}

/// A test for each case that is named, and one that none is left out.
macro_rules! long_cases {
    ($($test:ident: $name:literal;)*) => {
        $(#[test]
        fn $test() -> Result<(), Box<dyn std::error::Error>> {
            holds($name)
        })*

        #[test]
        fn every_long_case_is_run() {
            let listed = [$($name),*];
            let missing: Vec<_> = CASES.iter().filter(|c| !c.quick && !listed.contains(&c.name)).map(|c| c.name).collect();
            assert!(missing.is_empty(), "no test runs {missing:?}");
        }
    };
}

long_cases! {
    a_cantilever_bends_as_timoshenko_says: "V5";
    a_cantilever_swings_as_its_beam_does: "V6";
    sand_comes_to_rest_at_its_angle: "V13 heap";
    slabs_of_grains_run_out_as_experiments_say: "V14";
    a_cylinder_of_sand_runs_out_as_experiments_say: "V15";
    v19_sloshing: "V19 sloshing";
    v21_swinging_drop: "V21";
    a_drop_of_smoothed_particles_swings: "V21 SPH";
    liquids_spread_as_their_viscosity_and_tension_say: "spread";
    smoothed_particles_spread_so_too: "spread SPH";
    cubes_float_as_archimedes_says: "V23";
    a_cube_floats_on_particles_too: "V23 SPH";
    a_stack_of_ten_stands: "stack";
    what_was_captured_standing_stays_as_it_stands: "left alone";
    what_is_dropped_bends_and_comes_back: "dropped";
}

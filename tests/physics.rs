//! The validation cases that take longer than a unit test should.

use phystalk::gpu::Gpu;
use phystalk::solver::validate::CASES;

fn holds(name: &str) {
    let gpu = Gpu::shared_for_tests().expect("a device");
    let case = CASES.iter().find(|c| c.name == name).expect("a case");
    let checks = case.run(&gpu).expect("a run");
    assert!(!checks.is_empty());
    for check in checks {
        println!("{check:?}");
        assert!(check.held, "{check:?}");
    }
}

#[test]
fn a_cantilever_bends_as_timoshenko_says() {
    holds("V5");
}

#[test]
fn what_was_captured_standing_stays_as_it_stands() {
    holds("left alone");
}

#[test]
fn what_is_dropped_bends_and_comes_back() {
    holds("dropped");
}

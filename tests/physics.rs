//! The validation cases that take longer than a unit test should.

use phystalk::gpu::Gpu;
use phystalk::solver::validate::CASES;

fn holds(name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let gpu = Gpu::shared_for_tests()?;
    let case = CASES.iter().find(|c| c.name == name).ok_or("no such case")?;
    let checks = case.run(&gpu)?;
    assert!(!checks.is_empty());
    for check in checks {
        assert!(check.held, "{check:?}");
    }
    Ok(())
}

#[test]
fn a_cantilever_bends_as_timoshenko_says() -> Result<(), Box<dyn std::error::Error>> {
    holds("V5")
}

#[test]
fn what_was_captured_standing_stays_as_it_stands() -> Result<(), Box<dyn std::error::Error>> {
    holds("left alone")
}

#[test]
fn what_is_dropped_bends_and_comes_back() -> Result<(), Box<dyn std::error::Error>> {
    holds("dropped")
}

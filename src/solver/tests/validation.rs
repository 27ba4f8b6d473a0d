//! Each quick case of the validation holds on this device; `tests/physics.rs` has the others.

use crate::gpu::Gpu;
use crate::solver::validate::CASES;

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
fn v1_free_fall() {
    holds("V1");
}

#[test]
fn v2_momentum() {
    holds("V2");
}

#[test]
fn v3_angular_momentum() {
    holds("V3");
}

#[test]
fn v4_spinning_rod() {
    holds("V4");
}

#[test]
fn v7_column() {
    holds("V7");
}

#[test]
fn v26_same_bits() {
    holds("V26");
}

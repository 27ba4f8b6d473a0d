// By Newton, for what is near 1: powers lose bits that add up over many steps.
fn cube_root(value: f32) -> f32 {
    var root = 1.0 + (value - 1.0) * (1.0 / 3.0);
    for (var k = 0u; k < CUBE_ROOT_STEPS; k++) {
        root = (2.0 * root + value / (root * root)) * (1.0 / 3.0);
    }
    return root;
}

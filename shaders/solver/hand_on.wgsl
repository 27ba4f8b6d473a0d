// A particle from one state to the other.
fn hand_on(from_slot: u32, to_slot: u32) {
    let n = params.count;
    for (var plane = 0u; plane < 4u; plane++) {
        kinematics_out[plane * n + to_slot] = kinematics[plane * n + from_slot];
        matter_out[plane * n + to_slot] = matter[plane * n + from_slot];
    }
}

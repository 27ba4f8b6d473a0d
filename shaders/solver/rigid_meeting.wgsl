// Where bodies and soft matter share nodes of the grid, in any of its layers: what soft parts hang on a body
// lies in that of its own object, what touches it in others. A body has no mass on the grid: its particles
// near the surface only say which nodes it reaches and with how much of it, and the exchange at those
// nodes is shared among them, so that every sum over nodes becomes one over members, in their order.

// What particles leave at a node before the exchange.
struct Near {
    // Fixed-point mass of the particles of the body that soft matter hangs on, and of the one that it touches:
    // another body near by, which it does neither to, has no part in it.
    bonded: u32,
    touched: u32,
    // Contact of the nearest soft particle: nearness above the body's number.
    contact: u32,
    // The body that soft particles of its own object hang on, plus one.
    bond: u32,
}

struct Meeting {
    // Of the body, outward; zero where the node is bonded to it.
    normal: vec3<f32>,
    // The node may leave the body no slower than this, m/s.
    allowed_m_s: f32,
    // Given to the body in the end, as the fixed point has it, kg m/s.
    impulse: vec3<f32>,
    // Mass of the body's particles at the node; 0 where nothing meets.
    rigid_kg: f32,
    // Of the node, then what it gives the body.
    momentum: vec3<f32>,
    soft_kg: f32,
    // And whether the node slides along it.
    body: u32,
}

// Beside a body's number: without friction.
const SLIDES: u32 = 512u;

// The nearer the larger, so that the nearest particle wins a maximum; overlaps are nearer still.
fn pack_near(gap_m: f32, b: u32) -> u32 {
    return ((u32(clamp(0.5 - 0.5 * gap_m / params.reach_m, 0.0, 1.0) * GAP_STEPS) + 1u) << 10u) | b;
}

fn near_gap_m(value: u32) -> f32 {
    return params.reach_m * (1.0 - 2.0 * f32((value >> 10u) - 1u) / GAP_STEPS);
}

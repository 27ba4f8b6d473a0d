// What every pass of the solver shares: the step's parameters, the window of the lattice, the spline.
//
// Node i of the lattice stands at i * cell_m, whatever the window: moving the window moves no node.
// Storage is block-linear, blocks of 4^3 nodes, x fastest, so that an index is a sum over the axes.

struct Params {
    // First lattice node of the window, each coordinate a multiple of 4.
    origin: vec3<i32>,
    // Particles.
    count: u32,
    // Blocks of the window along each axis.
    blocks: vec3<u32>,
    // Entries of `colliders`; the ground, where there is one, is the first.
    collider_count: u32,
    gravity_m_s2: vec3<f32>,
    cell_m: f32,
    // 1 / cell_m
    per_m: f32,
    // Fixed-point units of a kilogram on the grid.
    mass_units: f32,
    // Particles farther than this from contact leave no mark on the grid, metres.
    reach_m: f32,
    // 1 where the first collider is the ground.
    has_ground: u32,
    // Entries of `pins` in force.
    pin_count: u32,
    // Cells that a particle may travel before the next sort.
    slack: i32,
    // Of the dither.
    seed: u32,
    // Smallest measure of momentum that the fixed-point scale is made for, kg m/s.
    momentum_floor: f32,
}

// Offset in nodes of one axis' coordinate within the block-linear storage; the three axes add up.
fn axis_offsets(cell: vec3<u32>) -> vec3<u32> {
    let block = cell >> vec3<u32>(2u);
    let inner = cell & vec3<u32>(3u);
    return vec3<u32>(
        block.x * 64u + inner.x,
        block.y * (params.blocks.x * 64u) + inner.y * 4u,
        block.z * (params.blocks.x * params.blocks.y * 64u) + inner.z * 16u,
    );
}

// First of the three lattice nodes that a quadratic spline at x reaches along each axis.
fn base_node(x: vec3<f32>) -> vec3<i32> {
    return vec3<i32>(floor(x * params.per_m - vec3<f32>(0.5)));
}

// Whether the stencil that starts at a node of the window, and a margin of one node, lie inside it.
fn in_window(first: vec3<i32>) -> bool {
    let last = vec3<i32>(params.blocks * 4u) - vec3<i32>(4);
    return all(first >= vec3<i32>(1)) && all(first <= last);
}

// Quadratic B-spline weights of the three nodes, for an offset of 0.5 to 1.5 cells from the first.
fn spline(offset: vec3<f32>) -> array<vec3<f32>, 3> {
    let a = vec3<f32>(1.5) - offset;
    let b = offset - vec3<f32>(1.0);
    let c = offset - vec3<f32>(0.5);
    return array<vec3<f32>, 3>(0.5 * a * a, vec3<f32>(0.75) - b * b, 0.5 * c * c);
}

// NaN and infinities by their bits: a comparison with itself is folded away by compilers.
fn finite(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u;
}

fn finite3(value: vec3<f32>) -> bool {
    return finite(value.x) && finite(value.y) && finite(value.z);
}

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
    // Bits of the largest measure of momentum in fixed point.
    momentum_bits: u32,
    // Number of the segment's first substep.
    first_substep: u32,
    // Fixed-point units of a cell full of liquid's surface tension over density, m^3/s^2.
    tension_units: f32,
    // And of its kinematic viscosity, m^2/s.
    viscosity_units: f32,
    // 1 where some particles are liquids beside the grid.
    has_liquid: u32,
    // Layers of the grid: how many groups of objects have velocities of their own.
    layers: u32,
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

// The 3^3 nodes that a particle exchanges with: weights of the quadratic B-spline and offsets in
// storage along each axis, the particle's place from the first node in cells.
struct Stencil {
    wx: vec3<f32>,
    wy: vec3<f32>,
    wz: vec3<f32>,
    ox: vec3<u32>,
    oy: vec3<u32>,
    oz: vec3<u32>,
    place: vec3<f32>,
}

fn stencil(x: vec3<f32>, base: vec3<i32>, cell: vec3<u32>) -> Stencil {
    let place = x * params.per_m - vec3<f32>(base);
    let a = vec3<f32>(1.5) - place;
    let b = place - vec3<f32>(1.0);
    let c = place - vec3<f32>(0.5);
    let w0 = 0.5 * a * a;
    let w1 = vec3<f32>(0.75) - b * b;
    let w2 = 0.5 * c * c;
    let o0 = axis_offsets(cell);
    let o1 = axis_offsets(cell + vec3<u32>(1u));
    let o2 = axis_offsets(cell + vec3<u32>(2u));
    return Stencil(
        vec3<f32>(w0.x, w1.x, w2.x),
        vec3<f32>(w0.y, w1.y, w2.y),
        vec3<f32>(w0.z, w1.z, w2.z),
        vec3<u32>(o0.x, o1.x, o2.x),
        vec3<u32>(o0.y, o1.y, o2.y),
        vec3<u32>(o0.z, o1.z, o2.z),
        place,
    );
}

// Nodes of one layer of the grid; the layers lie one after another.
fn layer_nodes() -> u32 {
    return params.blocks.x * params.blocks.y * params.blocks.z * 64u;
}

// The same nodes in the layer of a particle's object.
fn in_layer(s: Stencil, tag: u32) -> Stencil {
    var own = s;
    own.oz += vec3<u32>((tag & 0xffffu) % params.layers * layer_nodes());
    return own;
}

// One of three by number: an index that varies would send the vector through memory.
fn pick(v: vec3<f32>, k: u32) -> f32 {
    return select(select(v.z, v.y, k == 1u), v.x, k == 0u);
}

fn pick_offset(v: vec3<u32>, k: u32) -> u32 {
    return select(select(v.z, v.y, k == 1u), v.x, k == 0u);
}

// A row of three nodes along x: their weights, where they are stored, how far they are in y and z.
struct Row {
    weights: vec3<f32>,
    nodes: vec3<u32>,
    dy: f32,
    dz: f32,
}

fn row(s: Stencil, number: u32) -> Row {
    let y = number % 3u;
    let z = number / 3u;
    let weights = s.wx * (pick(s.wy, y) * pick(s.wz, z));
    let nodes = s.ox + vec3<u32>(pick_offset(s.oy, y) + pick_offset(s.oz, z));
    return Row(weights, nodes, f32(y) - s.place.y, f32(z) - s.place.z);
}

// NaN and infinities by their bits: a comparison with itself is folded away by compilers.
fn finite(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u;
}

fn finite3(value: vec3<f32>) -> bool {
    return finite(value.x) && finite(value.y) && finite(value.z);
}

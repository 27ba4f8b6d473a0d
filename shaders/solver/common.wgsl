// What every pass of the solver shares: the step's parameters, where the grid's blocks are stored, the
// spline.
//
// Node i of the lattice stands at i * cell_m, whatever the window: moving the window moves no node.
// Only blocks of 4^3 nodes that particles may reach are stored, those of each layer apart. A node's index
// is that of its block times 64 and its place in the block, x fastest. Block 0 is the empty one: it
// stands for all that are not stored, and nothing but zeros is ever found there.

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
    // 1 where the first layer also stores the blocks of all others: liquids share it.
    pools: u32,
    // Particles that one workgroup takes, where workgroups go by block.
    item_particles: u32,
    // 1 where those of an item that lie in one cell are kept apart.
    mixes: u32,
    // 1.5 * 2^23, which takes the fraction from what is added to it. A constant would be added to other
    // constants first.
    rounder: f32,
    // Nothing moves faster, m/s: the substeps of a frame would not follow.
    speed_most: f32,
    // Bits of the layers that hold liquid.
    wet_layers: u32,
    // What stands inside a surface comes out of it by so much in a substep, m: a jump would take it out of the order of
    // its cells, or through whatever is beyond.
    push_m: f32,
    // Layer of each object, four bits each.
    layer_of: array<u32, DEALT / 8u>,
    // Where each block of the window is stored, layer after layer.
    slots: array<u32>,
}

// The layer of a particle's object.
fn layer_of(tag: u32) -> u32 {
    let object = (tag & 0xffffu) % DEALT;
    return ((params.layer_of[object / 8u] >> (4u * (object & 7u))) & 15u) % params.layers;
}

// The layer whose blocks a particle is sorted into: where there are liquids beside the grid, who look for
// neighbours among all particles, the first.
fn sorted_into(tag: u32) -> u32 {
    return select(layer_of(tag), 0u, params.has_liquid != 0u);
}

// Number of a block of a layer within the window, whether it is stored or not.
fn block_number(block: vec3<u32>, layer: u32) -> u32 {
    return ((layer * params.blocks.z + block.z) * params.blocks.y + block.y) * params.blocks.x + block.x;
}

// Back from the number: the block's first node from the window's, and its layer.
struct Block {
    corner: vec3<i32>,
    layer: u32,
}

fn block_of(number: u32) -> Block {
    let slab = number / params.blocks.x;
    let deep = slab / params.blocks.y;
    let block = vec3<u32>(number % params.blocks.x, slab % params.blocks.y, deep % params.blocks.z);
    return Block(vec3<i32>(4u * block), deep / params.blocks.z);
}

// Where a cell, or the node at its lowest corner, is stored.
fn stored(cell: vec3<u32>, layer: u32) -> u32 {
    let inner = cell & vec3<u32>(3u);
    return params.slots[block_number(cell >> vec3<u32>(2u), layer)] * 64u + inner.z * 16u + inner.y * 4u + inner.x;
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

// Weights of the quadratic B-spline along each axis, for a place from the first of its nodes in cells.
struct Weights {
    x: vec3<f32>,
    y: vec3<f32>,
    z: vec3<f32>,
}

fn spline(place: vec3<f32>) -> Weights {
    let a = vec3<f32>(1.5) - place;
    let b = place - vec3<f32>(1.0);
    let c = place - vec3<f32>(0.5);
    let w0 = 0.5 * a * a;
    let w1 = vec3<f32>(0.75) - b * b;
    let w2 = 0.5 * c * c;
    return Weights(vec3<f32>(w0.x, w1.x, w2.x), vec3<f32>(w0.y, w1.y, w2.y), vec3<f32>(w0.z, w1.z, w2.z));
}

// The 3^3 nodes that a particle exchanges with: weights of the quadratic B-spline, the particle's place
// from the first node in cells, and where the nodes are stored. They lie in two blocks along each axis, a
// near and a far one, which may be the same.
struct Stencil {
    wx: vec3<f32>,
    wy: vec3<f32>,
    wz: vec3<f32>,
    place: vec3<f32>,
    // First node, from the window's.
    cell: vec3<u32>,
    // The nodes' places within their blocks.
    ox: vec3<u32>,
    oy: vec3<u32>,
    oz: vec3<u32>,
    // Whether they are in the far block: 1 along x and y, 2 along z.
    fx: vec3<u32>,
    fy: vec3<u32>,
    fz: vec3<u32>,
    // First nodes of the blocks that are near along x and of those that are far, (fy + fz) by (fy + fz).
    near: vec4<u32>,
    far: vec4<u32>,
}

// In the first layer; `cell` is the first node, from the window's.
fn stencil(x: vec3<f32>, base: vec3<i32>, cell: vec3<u32>) -> Stencil {
    let place = x * params.per_m - vec3<f32>(base);
    let w = spline(place);
    let first = cell & vec3<u32>(3u);
    let steps = vec3<u32>(0u, 1u, 2u);
    let nx = first.x + steps;
    let ny = first.y + steps;
    let nz = first.z + steps;
    let s = Stencil(
        w.x,
        w.y,
        w.z,
        place,
        cell,
        nx & vec3<u32>(3u),
        (ny & vec3<u32>(3u)) * 4u,
        (nz & vec3<u32>(3u)) * 16u,
        nx >> vec3<u32>(2u),
        ny >> vec3<u32>(2u),
        (nz >> vec3<u32>(2u)) * 2u,
        vec4<u32>(0u),
        vec4<u32>(0u),
    );
    return in_layer(s, 0u);
}

// The same nodes in another layer.
fn in_layer(s: Stencil, layer: u32) -> Stencil {
    var own = s;
    let near = s.cell >> vec3<u32>(2u);
    let far = (s.cell + vec3<u32>(2u)) >> vec3<u32>(2u);
    let nn = block_number(near, layer);
    let fa = block_number(vec3<u32>(near.x, far.y, near.z), layer);
    let nf = block_number(vec3<u32>(near.xy, far.z), layer);
    let ff = block_number(vec3<u32>(near.x, far.yz), layer);
    let across = far.x - near.x;
    own.near = 64u * vec4<u32>(params.slots[nn], params.slots[fa], params.slots[nf], params.slots[ff]);
    own.far = 64u * vec4<u32>(params.slots[nn + across], params.slots[fa + across], params.slots[nf + across], params.slots[ff + across]);
    return own;
}

// One of three by number: an index that varies would send the vector through memory.
fn pick(v: vec3<f32>, k: u32) -> f32 {
    return select(select(v.z, v.y, k == 1u), v.x, k == 0u);
}

fn pick_offset(v: vec3<u32>, k: u32) -> u32 {
    return select(select(v.z, v.y, k == 1u), v.x, k == 0u);
}

fn pick_block(v: vec4<u32>, k: u32) -> u32 {
    return select(select(v.w, v.z, k == 2u), select(v.y, v.x, k == 0u), k < 2u);
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
    let beside = pick_offset(s.fy, y) + pick_offset(s.fz, z);
    let inner = pick_offset(s.oy, y) + pick_offset(s.oz, z);
    let blocks = select(vec3<u32>(pick_block(s.near, beside)), vec3<u32>(pick_block(s.far, beside)), s.fx == vec3<u32>(1u));
    return Row(weights, blocks + s.ox + vec3<u32>(inner), f32(y) - s.place.y, f32(z) - s.place.z);
}

// What substeps follow of a velocity.
fn held_back(v: vec3<f32>) -> vec3<f32> {
    return v * min(1.0, params.speed_most / max(length(v), 1e-30));
}

// NaN and infinities by their bits: a comparison with itself is folded away by compilers.
fn finite(value: f32) -> bool {
    return (bitcast<u32>(value) & 0x7f800000u) != 0x7f800000u;
}

fn finite3(value: vec3<f32>) -> bool {
    return finite(value.x) && finite(value.y) && finite(value.z);
}

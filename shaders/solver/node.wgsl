// Nodes of active blocks by their place in the window.

struct Node {
    // Where it is stored.
    index: u32,
    // Nodes from the window's first.
    cell: vec3<i32>,
    layer: u32,
}

// One of the 64 of an active block, `place` along the list of them.
fn node_of(place: u32, lane: u32) -> Node {
    let inner = vec3<u32>(lane & 3u, (lane >> 2u) & 3u, lane >> 4u);
    let block = block_of(active_blocks[1u + place]);
    return Node((1u + place) * 64u + lane, block.corner + vec3<i32>(inner), block.layer);
}

fn position_of(node: Node) -> vec3<f32> {
    return vec3<f32>(params.origin + node.cell) * params.cell_m;
}

// Storage of a neighbour; at the window's edge, which no particle comes near, of what is nearest.
fn beside(node: Node, step: vec3<i32>) -> u32 {
    return stored(vec3<u32>(clamp(node.cell + step, vec3<i32>(0), vec3<i32>(params.blocks * 4u) - vec3<i32>(1))), node.layer);
}

// The k-th of the 3^3 steps to a node's neighbours and itself.
fn step_of(k: u32) -> vec3<i32> {
    return vec3<i32>(vec3<u32>(k % 3u, k / 3u % 3u, k / 9u)) - vec3<i32>(1);
}

// Weight of a neighbour in each component of a gradient: central differences, smoothed [1 2 1] / 4
// across. Times 1 / cell.
fn slope(step: vec3<i32>) -> vec3<f32> {
    let s = vec3<f32>(step);
    let w = vec3<f32>(1.0) - 0.5 * abs(s);
    return s * w.yzx * w.zxy * 0.125;
}

// Contact between objects, on the grid: where two layers hold mass at a node, their velocities may part
// freely and approach as far as there is room between their surfaces; friction takes from the rest what
// Coulomb grants. Momentum only changes hands. One workgroup for each active block.
//
// After Bardenhagen et al. (2001), with a normal that two bodies share (Huang et al. 2011). A body's surface
// near a node is taken as a plane: mass and its gradient there say how far off it is, whatever the density.
// So bodies meet when their matter does, not when their splines do.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
// Of each layer: Coulomb coefficient, and size.
@group(0) @binding(2) var<storage, read> surfaces: array<vec2<f32>>;
@group(0) @binding(3) var<storage, read> masses: array<f32>;
@group(0) @binding(4) var<storage, read_write> velocity: array<vec4<f32>>;
var<immediate> substep: Substep;

// One layer at one node.
struct Side {
    layer: u32,
    node: u32,
    v: vec3<f32>,
    mass: f32,
    // 1 / mass, 0 where it is pinned.
    ease: f32,
    // Of mass, a cell; it points into the body.
    slope: vec3<f32>,
}

// Gradient of a layer's mass: central differences, smoothed (1 2 1) / 4 across.
fn mass_slope(layer: u32, cell: vec3<i32>) -> vec3<f32> {
    let low = vec3<u32>(clamp(cell - vec3<i32>(1), vec3<i32>(0), vec3<i32>(params.blocks * 4u) - vec3<i32>(3)));
    let s = in_layer(stencil(vec3<f32>(0.0), vec3<i32>(0), low), layer);
    var sum = vec3<f32>(0.0);
    for (var k = 0u; k < 9u; k++) {
        let nodes = row(s, k).nodes;
        let step = vec3<i32>(0, vec2<i32>(vec2<u32>(k % 3u, k / 3u)) - vec2<i32>(1));
        sum += slope(step - vec3<i32>(1, 0, 0)) * abs(masses[nodes.x]);
        sum += slope(step) * abs(masses[nodes.y]);
        sum += slope(step + vec3<i32>(1, 0, 0)) * abs(masses[nodes.z]);
    }
    return sum;
}

// How far a half-space of matter begins before (negative: behind) the node, in cells, from the relative
// gradient of mass towards it: that of quadratic splines, inverted to a tenth of a cell.
fn ahead(relative: f32) -> f32 {
    let r = max(relative, 0.08) * (1.0 / SURFACE_SLOPE);
    if (r < 1.0) {
        return 0.76 * log(r);
    }
    return 1.5 - 3.0 / (1.0 + pow(r, 0.7225));
}

// Which way from one side to the other: as the surface of the larger body lies there, which the edges of
// the smaller one do not tilt. Deep inside it, where its slope says nothing, as the other's.
fn between(a: Side, b: Side) -> vec3<f32> {
    let by_a = surfaces[a.layer].y > surfaces[b.layer].y;
    let towards = select(b.slope, -a.slope, by_a);
    let deep = length(towards) < FAINT_SLOPE * select(b.mass, a.mass, by_a);
    let way = select(towards, select(-a.slope, b.slope, by_a), deep);
    return way * inverseSqrt(max(dot(way, way), 1e-30));
}

fn meet(a: ptr<function, Side>, b: ptr<function, Side>) {
    let ease = (*a).ease + (*b).ease;
    let normal = between(*a, *b);
    // Where one begins farther off they meet at other nodes: its tail here knows its edges, not its face.
    let far = length((*a).slope) > FAR_SLOPE * (*a).mass || length((*b).slope) > FAR_SLOPE * (*b).mass;
    if (ease == 0.0 || far || dot(normal, normal) < 0.5) {
        return;
    }
    let gap_m = params.cell_m * (ahead(-dot((*a).slope, normal) / (*a).mass) + ahead(dot((*b).slope, normal) / (*b).mass));
    let relative = (*a).v - (*b).v;
    let approach = dot(relative, normal);
    let stopped = approach - max(gap_m, 0.0) / substep.dt_s;
    if (stopped <= 0.0) {
        return;
    }
    let sliding = relative - normal * approach;
    let friction = sqrt(surfaces[(*a).layer].x * surfaces[(*b).layer].x);
    let held = min(friction * stopped / max(length(sliding), 1e-20), 1.0);
    let impulse = (normal * stopped + sliding * held) / ease;
    (*a).v -= impulse * (*a).ease;
    (*b).v += impulse * (*b).ease;
}

// Where each layer stores the workgroup's block.
var<workgroup> slots: array<u32, MOST_LAYERS>;

// The node of this lane's place in another layer.
fn node_in(layer: u32, lane: u32) -> u32 {
    return 64u * slots[layer] + lane;
}

fn side_of(layer: u32, cell: vec3<i32>, lane: u32) -> Side {
    let node = node_in(layer, lane);
    let mass = masses[node];
    return Side(layer, node, velocity[node].xyz, abs(mass), select(0.0, 1.0 / mass, mass > 0.0), mass_slope(layer, cell));
}

// More than two that meet at a node. What one pair settles another may upset.
fn meet_all(first_layer: u32, cell: vec3<i32>, lane: u32) {
    var sides: array<Side, MOST_LAYERS>;
    var count = 0u;
    for (var layer = first_layer; layer < params.layers; layer++) {
        if (masses[node_in(layer, lane)] != 0.0) {
            sides[count] = side_of(layer, cell, lane);
            count++;
        }
    }
    for (var round = 0u; round < MEETING_ROUNDS; round++) {
        for (var i = 0u; i + 1u < count; i++) {
            for (var j = i + 1u; j < count; j++) {
                var a = sides[i];
                var b = sides[j];
                meet(&a, &b);
                sides[i].v = a.v;
                sides[j].v = b.v;
            }
        }
    }
    for (var k = 0u; k < count; k++) {
        velocity[sides[k].node] = vec4<f32>(sides[k].v, 0.0);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place >= active_blocks[0]) {
        return;
    }
    let own = node_of(place, lane);
    if (lane < params.layers) {
        slots[lane] = params.slots[block_number(vec3<u32>(own.cell) >> vec3<u32>(2u), lane)];
    }
    workgroupBarrier();
    // The first layer that has this block speaks for all.
    for (var layer = 0u; layer < own.layer; layer++) {
        if (slots[layer] != 0u) {
            return;
        }
    }
    var count = 0u;
    var first_layer = 0u;
    var last_layer = 0u;
    for (var layer = own.layer; layer < params.layers; layer++) {
        let here = masses[node_in(layer, lane)] != 0.0;
        first_layer = select(first_layer, layer, here && count == 0u);
        last_layer = select(last_layer, layer, here);
        count += select(0u, 1u, here);
    }
    if (count == 2u) {
        var a = side_of(first_layer, own.cell, lane);
        var b = side_of(last_layer, own.cell, lane);
        meet(&a, &b);
        velocity[a.node] = vec4<f32>(a.v, 0.0);
        velocity[b.node] = vec4<f32>(b.v, 0.0);
    } else if (count > 2u) {
        meet_all(first_layer, own.cell, lane);
    }
}

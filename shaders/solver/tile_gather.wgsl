// The grid's velocity, in the tile.
var<workgroup> flow_x: array<f32, TILE_NODES>;
var<workgroup> flow_y: array<f32, TILE_NODES>;
var<workgroup> flow_z: array<f32, TILE_NODES>;

// To be called by all, between barriers.
fn load_flow(lane: u32) {
    for (var k = lane; k < 512u; k += TILE_LANES) {
        let v = velocity[stored_in_tile(k)].xyz;
        let at = in_tile(k);
        flow_x[at] = v.x;
        flow_y[at] = v.y;
        flow_z[at] = v.z;
    }
}

fn flow_at(node: u32) -> vec3<f32> {
    return vec3<f32>(flow_x[node], flow_y[node], flow_z[node]);
}

// Adds a row of three nodes along x, at a distance along y and z.
fn with_row(sum: Gathered, node: u32, weights: vec3<f32>, x: f32, y: f32, z: f32) -> Gathered {
    let a = flow_at(node) * weights.x;
    let b = flow_at(node + 1u) * weights.y;
    let c = flow_at(node + 2u) * weights.z;
    let v = a + b + c;
    return Gathered(sum.v + v, sum.gradient + mat3x3<f32>(b + 2.0 * c - v * x, v * y, v * z));
}

// Adds a slab of three rows.
fn with_slab(sum: Gathered, node: u32, w: Weights, share: f32, place: vec3<f32>, z: f32) -> Gathered {
    let low = with_row(sum, node, w.x * (w.y.x * share), place.x, -place.y, z);
    let middle = with_row(low, node + TILE_ROW, w.x * (w.y.y * share), place.x, 1.0 - place.y, z);
    return with_row(middle, node + 2u * TILE_ROW, w.x * (w.y.z * share), place.x, 2.0 - place.y, z);
}

// As `gather`, from the tile. Written out: a loop stays a loop.
fn gather_tile(place: vec3<f32>, start: u32) -> Gathered {
    let w = spline(place);
    let low = with_slab(Gathered(vec3<f32>(0.0), mat3x3<f32>()), start, w, w.z.x, place, -place.z);
    let middle = with_slab(low, start + TILE_SLAB, w, w.z.y, place, 1.0 - place.z);
    return with_slab(middle, start + 2u * TILE_SLAB, w, w.z.z, place, 2.0 - place.z);
}

// Of a particle of the item; one that left the tile asks the grid itself.
fn gathered(item: Item, position: vec3<f32>, tag: u32) -> Gathered {
    let base = base_node(position);
    let first = base - params.origin;
    if (tile_holds(item, first, tag)) {
        return gather_tile(position * params.per_m - vec3<f32>(base), tile_start(item, first));
    }
    let cell = vec3<u32>(clamp(first, vec3<i32>(0), vec3<i32>(params.blocks * 4u) - vec3<i32>(3)));
    return gather(in_layer(stencil(position, base, cell), layer_of(tag)));
}

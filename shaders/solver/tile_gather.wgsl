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

// Sums over a row of nodes: what they hold times the weights, and that times the nodes' number in the row.
struct InRow {
    all: vec3<f32>,
    along: vec3<f32>,
}

fn in_row(node: u32, weights: vec3<f32>) -> InRow {
    let b = flow_at(node + 1u) * weights.y;
    let c = flow_at(node + 2u);
    return InRow(flow_at(node) * weights.x + b + c * weights.z, b + c * (2.0 * weights.z));
}

// The same over a slab of three rows, along x and y.
struct InSlab {
    all: vec3<f32>,
    along_x: vec3<f32>,
    along_y: vec3<f32>,
}

fn in_slab(node: u32, w: Weights) -> InSlab {
    let low = in_row(node, w.x);
    let middle = in_row(node + TILE_ROW, w.x);
    let high = in_row(node + 2u * TILE_ROW, w.x);
    let b = middle.all * w.y.y;
    return InSlab(
        low.all * w.y.x + b + high.all * w.y.z,
        low.along * w.y.x + middle.along * w.y.y + high.along * w.y.z,
        b + high.all * (2.0 * w.y.z),
    );
}

// As `gather`, from the tile, an axis after the other. Written out: a loop stays a loop.
fn gather_tile(place: vec3<f32>, start: u32) -> Gathered {
    let w = spline(place);
    let low = in_slab(start, w);
    let middle = in_slab(start + TILE_SLAB, w);
    let high = in_slab(start + 2u * TILE_SLAB, w);
    let b = middle.all * w.z.y;
    let v = low.all * w.z.x + b + high.all * w.z.z;
    let x = low.along_x * w.z.x + middle.along_x * w.z.y + high.along_x * w.z.z;
    let y = low.along_y * w.z.x + middle.along_y * w.z.y + high.along_y * w.z.z;
    let z = b + high.all * (2.0 * w.z.z);
    return Gathered(v, mat3x3<f32>(x - v * place.x, y - v * place.y, z - v * place.z));
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

// Liquids and pastes to grid: the rest volume around each node in volumes of a cell, and that volume's surface
// tension over density and kinematic viscosity, in fixed point.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> substances: array<Substance>;
// Three words a node.
@group(0) @binding(4) var<storage, read_write> fill: array<atomic<i32>>;

fn pour(node: u32, amount: vec3<f32>) {
    let whole = vec3<i32>(round(amount));
    atomicAdd(&fill[3u * node], whole.x);
    atomicAdd(&fill[3u * node + 1u], whole.y);
    atomicAdd(&fill[3u * node + 2u], whole.z);
}

// 1, surface tension and viscosity of what clings to walls.
fn wetness(s: Substance) -> vec3<f32> {
    switch (s.kind) {
        case LIQUID: { return vec3<f32>(1.0, s.values[1], s.values[0]); }
        case VISCOPLASTIC: { return vec3<f32>(sign(s.values[1]), 0.0, s.values[1]); }
        default: { return vec3<f32>(0.0); }
    }
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = id.x;
    let n = params.count;
    let substance = substances[row_of(bitcast<u32>(matter[3u * n + i].y))];
    let position = kinematics[i];
    let base = base_node(position.xyz);
    let first = base - params.origin;
    let wet = wetness(substance);
    if (wet.x == 0.0 || !in_window(first)) {
        return;
    }
    let volume = matter[2u * n + i].w;
    let per_density = volume / position.w;
    let share = volume * params.per_m * params.per_m * params.per_m;
    let amount = share * vec3<f32>(
        FILL_UNITS,
        wet.y * per_density * params.tension_units,
        wet.z * per_density * params.viscosity_units,
    );
    let s = stencil(position.xyz, base, vec3<u32>(first));
    for (var k = 0u; k < 9u; k++) {
        let r = row(s, k);
        pour(r.nodes.x, amount * r.weights.x);
        pour(r.nodes.y, amount * r.weights.y);
        pour(r.nodes.z, amount * r.weights.z);
    }
}

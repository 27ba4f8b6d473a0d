// Prestress, on the grid: sets up a system. What force is left over, and what holds each node.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> active_blocks: array<u32>;
@group(0) @binding(2) var<storage, read> colliders: array<Collider>;
@group(0) @binding(3) var<storage, read> pins: array<Pin>;
@group(0) @binding(4) var<storage, read_write> sums: array<vec4<i32>>;
@group(0) @binding(5) var<storage, read_write> marks: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> velocity: array<vec4<f32>>;
@group(0) @binding(7) var<storage, read_write> control: Control;
@group(0) @binding(8) var<storage, read_write> nodes: array<vec4<f32>>;
@group(0) @binding(9) var<storage, read_write> partial: array<vec4<f32>>;
var<immediate> substep: Substep;

// The support that a node stands on. One that weight presses into squarely holds along its normal
// alone, so that the solution asks no friction of it; on a slope the node is held wholly.
fn support(mark: u32, x: vec3<f32>) -> vec4<f32> {
    if (mark == 0u || mark_gap_m(mark) > TOUCHING_CELLS * params.cell_m) {
        return vec4<f32>(0.0);
    }
    let feature = mark & 1023u;
    let normal = surface_normal(colliders[feature >> 3u], feature & 7u, x);
    let square = abs(dot(normal, params.gravity_m_s2)) > 0.9999 * length(params.gravity_m_s2);
    return vec4<f32>(normal, select(2.0, 1.0, square));
}

@compute @workgroup_size(64)
fn main(@builtin(local_invocation_index) lane: u32, @builtin(workgroup_id) group: vec3<u32>) {
    let place = group.y * GROUPS_ACROSS + group.x;
    if (place == 0u && lane == 0u) {
        atomicStore(&control.momentum[(substep.index + 1u) & 3u], 0u);
    }
    let alive = place < active_blocks[0];
    let count = active_blocks[0] * 64u;
    var share = vec4<f32>(0.0);
    if (alive) {
        let at = node_of(place, lane);
        let node = at.index;
        let k = place * 64u + lane;
        let sum = sums[node];
        let mark = marks[node];
        sums[node] = vec4<i32>(0);
        marks[node] = vec2<u32>(0u);
        let momentum_unit = momentum_units(substep.index, substep.lag);
        // Nodes that particles hardly reach are lost in the rounding: they are conditioned as heavier
        // ones and left out of the measure.
        let mass = select(0.0, max(f32(sum.w), LIGHTEST) / params.mass_units, sum.w > 0);
        let measured = f32(sum.w) > LIGHTEST;
        let force = select(vec3<f32>(0.0), vec3<f32>(sum.xyz) / momentum_unit, mass > 0.0);

        // The first time, with no stress yet, the force is the node's weight.
        var released = 0.0;
        let first = steer(substep.job, params.count) == SET_UP;
        var bound = nodes[BOUND * count + k];
        var weight = nodes[SOLUTION * count + k].w;
        if (first) {
            let x = position_of(at);
            bound = support(mark.y, x);
            if (bound.w == 0.0) {
                bound = support(mark.x, x);
            }
            // Pins that move begin where they were captured.
            bound.w = select(bound.w, 2.0, pinned(x, at.layer).w > 0.0);
            weight = select(0.0, length(force) / mass, measured);
        } else if (bound.w == 1.0 && dot(force, bound.xyz) > RELEASE * weight * mass) {
            // A support only pushes.
            bound = vec4<f32>(0.0);
            released = 1.0;
        }
        let left = hold(force, bound);
        let step = select(vec3<f32>(0.0), left / mass, mass > 0.0);
        nodes[BOUND * count + k] = bound;
        nodes[RESIDUAL * count + k] = vec4<f32>(left, mass);
        nodes[DIRECTION * count + k] = vec4<f32>(step, 0.0);
        nodes[SOLUTION * count + k] = vec4<f32>(vec3<f32>(0.0), weight);
        velocity[node] = vec4<f32>(step, 0.0);
        // Square of acceleration over gravity's, weighted by the node's weight.
        share = vec4<f32>(select(0.0, dot(step, step) * mass / weight, weight > 0.0), weight * mass, dot(left, step), released);
    }
    let sum = workgroup_sum(lane, share);
    if (lane == 0u && alive) {
        partial[place] = sum;
    }
}

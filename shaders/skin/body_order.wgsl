// One thread a sorted particle: what others need of it, next to its neighbours', and where its key starts and ends.

@group(0) @binding(0) var<storage, read> keys: array<u32>;
@group(0) @binding(1) var<storage, read> order: array<u32>;
@group(0) @binding(2) var<storage, read> motion: array<PackedDelta>;
/// Its own colour, display-referred, and its size in metres.
@group(0) @binding(3) var<storage, read> tint: array<vec4<f32>>;
/// The colour of its surroundings: what flows brings that along. And how clear it is as a liquid.
@group(0) @binding(4) var<storage, read> dye: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> parted: array<f32>;
/// First and one past the last of each key; zeros where there is none.
@group(0) @binding(6) var<storage, read_write> spans: array<u32>;
/// (x, y, z, size), (colour, parted and how it flows as halves: between 3 and 3.5 a liquid, the clearer the more).
@group(0) @binding(7) var<storage, read_write> sorted: array<vec4<u32>>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let k = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if k >= params.count || keys[k] > params.mask {
        return;
    }
    let key = keys[k];
    if k == 0u || keys[max(k, 1u) - 1u] != key {
        spans[2u * key] = k;
    }
    if k + 1u == params.count || keys[min(k + 1u, params.count - 1u)] != key {
        spans[2u * key + 1u] = k + 1u;
    }
    let i = order[k];
    let own = tint[i];
    let flow = unpack2x16float(motion[i].b.w).y;
    let colour = select(own.xyz, dye[i].xyz, flow > 1.5);
    sorted[2u * k] = vec4(motion[i].a.xyz, bitcast<u32>(own.w));
    sorted[2u * k + 1u] = vec4(bitcast<vec3<u32>>(colour), pack2x16float(vec2(parted[i], flow + select(0.0, 0.5 * dye[i].w, flow > 2.5))));
}

// What each particle of a surface pulls its neighbours there with, for its part of the area.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> solve: Solve;
@group(0) @binding(2) var<storage, read> place: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> nature: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read> neighbours: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> near: array<u32>;
// Gradient of the density of liquid, times the cell.
@group(0) @binding(6) var<storage, read> inward: array<f32>;
// Strength of its pull, and how far it belongs to the surface.
@group(0) @binding(7) var<storage, read_write> skin: array<vec2<f32>>;

// The particle itself, beyond the end of a list, is at no distance.
fn lever(j: u32, at: vec3<f32>) -> f32 {
    let q = length(at - place[j].xyz) * params.per_m;
    return on_surface(inward[j]) * tug(q) * q;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.count) {
        return;
    }
    let list = unpack_near(near[i]);
    let mine = place[i];
    let member = select(0.0, on_surface(inward[i]), list.liquid);
    var levers = 0.0;
    for (var k = 0u; k < select(0u, list.liquids, member > 0.0); k += 4u) {
        let j = neighbours[liquids_from(k, i)];
        levers += (lever(j.x, mine.xyz) + lever(j.y, mine.xyz)) + (lever(j.z, mine.xyz) + lever(j.w, mine.xyz));
    }
    let area = mine.w * inward[i] * member;
    skin[i] = vec2<f32>(TENSION * nature[i].y * area / max(levers, LEVERS_LEAST), member);
}

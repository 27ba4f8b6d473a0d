// One thread a particle: its motion to the affine map of its surroundings.

struct Immediates {
    origin: vec3<f32>,
    count: u32,
    span_m: f32,
}
var<immediate> params: Immediates;

/// (x, y, z, G - I as nine halves, how it flows), 32 bytes.
@group(0) @binding(0) var<storage, read> motion: array<PackedDelta>;
/// Captured positions, relative to the origin.
@group(0) @binding(1) var<storage, read> rest_particle: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> delta: array<PackedDelta>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if i >= params.count {
        return;
    }
    let m = motion[i];
    let p0 = rest_particle[i].xyz;
    var t = bitcast<vec3<f32>>(m.a.xyz) - params.origin - p0;
    // The paper moves centres by displacements alone; exact weights carry them along with G too.
    if !PAPER {
        let g = unpacked(m);
        t -= vec3(dot(g.x.xyz, p0), dot(g.y.xyz, p0), dot(g.z.xyz, p0));
    }
    delta[i] = PackedDelta(vec4(bitcast<vec3<u32>>(t), m.a.w), m.b);
}

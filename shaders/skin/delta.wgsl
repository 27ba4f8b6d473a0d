// One thread a particle: its motion to the affine map of its surroundings.

struct Immediates {
    origin: vec3<f32>,
    count: u32,
    span_m: f32,
}
var<immediate> params: Immediates;

/// (x, y, z, G - I as nine halves, 1 where shapes are lost), 32 bytes.
@group(0) @binding(0) var<storage, read> motion: array<array<vec4<u32>, 2>>;
/// Captured positions, relative to the origin.
@group(0) @binding(1) var<storage, read> rest_particle: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> delta: array<Delta>;
/// 1 where matter keeps no shape, else 0.
@group(0) @binding(3) var<storage, read_write> sheds: array<f32>;

@compute @workgroup_size(GROUP_SIZE)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * GROUP_SIZE + lane;
    if i >= params.count {
        return;
    }
    let a = motion[i][0];
    let b = motion[i][1];
    let p0 = rest_particle[i].xyz;
    let moved = bitcast<vec3<f32>>(a.xyz) - params.origin - p0;

    let h0 = unpack2x16float(a.w);
    let h1 = unpack2x16float(b.x);
    let h2 = unpack2x16float(b.y);
    let h3 = unpack2x16float(b.z);
    let h4 = unpack2x16float(b.w);
    let row_x = vec3(h0, h1.x);
    let row_y = vec3(h1.y, h2);
    let row_z = vec3(h3, h4.x);

    // The paper moves centres by displacements alone; exact weights carry them along with G too.
    var t = moved;
    if !PAPER {
        t -= vec3(dot(row_x, p0), dot(row_y, p0), dot(row_z, p0));
    }
    sheds[i] = h4.y;
    delta[i] = Delta(vec4(row_x, t.x), vec4(row_y, t.y), vec4(row_z, t.z));
}

// Changes the velocity of one object's particles. What is set anew loses its gradient too.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> kinematics: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> matter: array<vec4<f32>>;
var<immediate> kick: Kick;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let i = id.x;
    if ((bitcast<u32>(matter[3u * params.count + i].y) & 0xffffu) != kick.object) {
        return;
    }
    write_motion(i, kinematics[params.count + i].xyz * kick.keep + kick.add_m_s, read_affine(i) * kick.keep);
}

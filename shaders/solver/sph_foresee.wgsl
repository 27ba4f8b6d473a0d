// Start of implicit viscosity: what it did in the last substep, it is taken to do again. A thick liquid creeps at
// the end of a long search, whose start is then its end; total momentum stays as it was, since pairs gave it.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> matter: array<vec4<f32>>;
// What viscosity accelerated each by, in the original order.
@group(0) @binding(2) var<storage, read> braking: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> corrected: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> slowed: array<vec4<f32>>;
var<immediate> substep: Substep;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    if (i >= params.count) {
        return;
    }
    let before = braking[bitcast<u32>(matter[3u * params.count + i].x)];
    slowed[i] = corrected[i] + substep.dt_s * vec4<f32>(before.xyz, 0.0);
}

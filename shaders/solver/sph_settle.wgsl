// End of implicit viscosity. It was solved along with the pressures that the last substep ended with, for a
// thick liquid stands between weight, pressure and viscosity at once. What it changed goes into the velocities that
// the correction of density starts from, to which those pressures come anew, and is what the next substep foresees.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read> near: array<u32>;
@group(0) @binding(2) var<storage, read> slowed: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> predicted: array<vec4<f32>>;
@group(0) @binding(4) var<storage, read_write> corrected: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> matter: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read_write> braking: array<vec4<f32>>;
var<immediate> substep: Substep;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x >= params.count) {
        return;
    }
    let list = unpack_near(near[id.x]);
    var change = vec3<f32>(0.0);
    if (list.liquid || list.liquids > 0u) {
        change = slowed[id.x].xyz - corrected[id.x].xyz;
        predicted[id.x] += vec4<f32>(change, 0.0);
        corrected[id.x] = slowed[id.x];
    }
    braking[bitcast<u32>(matter[3u * params.count + id.x].x)] = vec4<f32>(change / substep.dt_s, 0.0);
}

// What has just become such a liquid stands as it is: what was sampled unevenly, squeezed or put into one place is too
// dense from the start, and is not thrown apart for it. Each particle notes how much too dense it may be, which it
// loses little by little.

@group(0) @binding(0) var<storage, read> params: Params;
@group(0) @binding(1) var<storage, read_write> nature: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> density: array<vec4<f32>>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let i = id.x;
    // Not noted yet.
    if (i < params.count && nature[i].w < 0.0) {
        let excess = max(density[i].w - 1.0, 0.0);
        nature[i].w = excess;
        density[i].w -= excess;
    }
}

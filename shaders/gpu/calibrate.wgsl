// A fixed amount of arithmetic that no cache, queue or scene changes: its time tells the clock.

@group(0) @binding(0) var<storage, read_write> sums: array<f32>;

@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    var x = vec4<f32>(f32(id.x)) * 1e-6 + vec4<f32>(0.1, 0.2, 0.3, 0.4);
    for (var i = 0u; i < STEPS; i++) { x = x * (vec4<f32>(3.7) - 3.7 * x); }
    sums[id.x] = x.x + x.y + x.z + x.w;
}

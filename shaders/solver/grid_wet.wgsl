// Acceleration by surface tension, m/s^2; kinematic viscosity, m^2/s.
@group(0) @binding(9) var<storage, read> pull: array<vec4<f32>>;

fn liquid_pull(node: Node) -> vec4<f32> {
    return pull[stored(vec3<u32>(node.cell), 0u)];
}

// Where nothing is liquid.

fn liquid_pull(node: Node) -> vec4<f32> {
    return vec4<f32>(0.0);
}

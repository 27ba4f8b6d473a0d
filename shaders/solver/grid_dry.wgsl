// Where nothing is liquid.

fn liquid_pull(node: Node) -> vec4<f32> {
    return vec4<f32>(0.0);
}

fn braked(v: vec3<f32>, mark: u32, x: vec3<f32>, node: Node) -> vec3<f32> {
    return v;
}

fn held_by(mark: u32, x: vec3<f32>, node: Node) -> f32 {
    return 0.0;
}

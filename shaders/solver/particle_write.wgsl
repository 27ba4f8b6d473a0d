fn write_motion(i: u32, v: vec3<f32>, affine: mat3x3<f32>) {
    let n = params.count;
    let rows = transpose(affine);
    kinematics[n + i] = vec4<f32>(v, rows[0].x);
    kinematics[2u * n + i] = vec4<f32>(rows[0].yz, rows[1].xy);
    kinematics[3u * n + i] = vec4<f32>(rows[1].z, rows[2]);
}

// How large a momentum this particle may hand to a node, kg m/s.
fn momentum_measure(mass: f32, v: vec3<f32>, affine: mat3x3<f32>) -> f32 {
    let spread = dot(affine[0], affine[0]) + dot(affine[1], affine[1]) + dot(affine[2], affine[2]);
    return mass * length(v) + params.cell_m * sqrt(spread);
}

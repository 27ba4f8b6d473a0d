// What the pressures of a particle and its neighbours do to its velocity in a substep.
//
// The force between two liquid particles is -V_i V_j (p_i + p_j) grad W, the transpose of the change of
// densities, so that momentum is kept pair by pair and no pair makes energy. A wall or a solid answers
// with the pressure of the liquid beside it.

fn pushed(i: u32, near: Near) -> vec3<f32> {
    let mine = place[i];
    var sum = pressure[solve.pressure + i] * density[i].xyz;
    for (var k = 0u; k < near.liquids; k++) {
        let j = neighbours[k * params.count + i];
        let other = place[j];
        let y = (mine.xyz - other.xyz) * params.per_m;
        let q = length(y);
        let steep = select(solid_steepness(q), steepness(q), near.liquid);
        sum += (other.w * pressure[solve.pressure + j] * steep) * y;
    }
    return (-substep.dt_s * params.per_m * nature[i].x) * sum;
}

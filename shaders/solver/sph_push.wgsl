// What the pressures of a particle and its neighbours do to its velocity in a substep.
//
// The force between two liquid particles is -V_i V_j (p_i + p_j) grad W, the transpose of the change of
// densities, so that momentum is kept pair by pair and no pair makes energy. A wall or a solid answers
// with the pressure of the liquid beside it: its part of the gradient counts twice, for both sides.

// Of one neighbour, without the common factor.
fn press(j: u32, at: vec3<f32>, liquid: bool, offset: u32) -> vec3<f32> {
    let other = place[j];
    let y = (at - other.xyz) * params.per_m;
    let q = length(y);
    let steep = select(solid_steepness(q), steepness(q), liquid);
    return (other.w * pressure[offset + j] * steep) * y;
}

fn pushed(i: u32, list: Near) -> vec3<f32> {
    let n = params.count;
    let at = place[i].xyz;
    let offset = solve.pressure;
    let wall = density[n + i];
    var sum = pressure[offset + i] * density[i].xyz;
    for (var k = 0u; k < list.liquids; k += 4u) {
        let j = liquids_from(k, i);
        sum += (press(j.x, at, list.liquid, offset) + press(j.y, at, list.liquid, offset))
            + (press(j.z, at, list.liquid, offset) + press(j.w, at, list.liquid, offset));
    }
    return (-substep.dt_s * params.per_m * nature[i].x) * along_walls(sum, wall);
}

// What the pressures of a particle and its neighbours do to its velocity in a substep.
//
// The force between two liquid particles is -V_i V_j (p_i + p_j) grad W, the transpose of the change of
// densities, so that momentum is kept pair by pair and no pair makes energy. A wall or a solid answers
// with the pressure of the liquid beside it: its part of the gradient counts twice, for both sides.

// Of one neighbour, without the common factor.
fn press(j: u32, slope: f32, at: vec3<f32>) -> vec3<f32> {
    return (pressure[j] * slope) * (at - place[j].xyz);
}

fn pushed(i: u32, list: Near) -> vec3<f32> {
    let at = place[i].xyz;
    let wall = density[params.count + i];
    var sum = vec3<f32>(0.0);
    for (var k = 0u; k < list.liquids; k += 4u) {
        let entry = liquids_from(k, i);
        let j = neighbours[entry];
        let slope = slopes[entry];
        sum += (press(j.x, slope.x, at) + press(j.y, slope.y, at)) + (press(j.z, slope.z, at) + press(j.w, slope.w, at));
    }
    let all = pressure[i] * density[i].xyz + params.per_m * sum;
    return (-substep.dt_s * params.per_m * nature[i].x) * along_walls(all, wall);
}

// Velocity, and its gradient times the cell's size over 4, from the grid.
struct Gathered {
    v: vec3<f32>,
    gradient: mat3x3<f32>,
}

fn gather(s: Stencil) -> Gathered {
    var v = vec3<f32>(0.0);
    var g = mat3x3<f32>();
    for (var k = 0u; k < 9u; k++) {
        let r = row(s, k);
        let a = velocity[r.nodes.x].xyz * r.weights.x;
        let b = velocity[r.nodes.y].xyz * r.weights.y;
        let c = velocity[r.nodes.z].xyz * r.weights.z;
        let sum = a + b + c;
        v += sum;
        g += mat3x3<f32>(b + 2.0 * c - sum * s.place.x, sum * r.dy, sum * r.dz);
    }
    return Gathered(v, g);
}

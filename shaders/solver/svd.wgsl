// Singular values of a 3x3 matrix by one-sided Jacobi (Hestenes 1958): columns are turned in pairs
// until all are at right angles; their lengths are the values. Small values keep their digits, which
// eigenvalues of F^T F would lose.

// m = u diag(s) v^T with proper rotations u and v and s.x >= s.y >= |s.z|; s.z is negative where m
// turns space inside out.
struct Svd {
    u: mat3x3<f32>,
    s: vec3<f32>,
    v: mat3x3<f32>,
}

// Cosine and sine of the turn that brings two columns to right angles; (1, 0) where they are.
fn turn_apart(a: vec3<f32>, b: vec3<f32>) -> vec2<f32> {
    let across = dot(a, b);
    let aa = dot(a, a);
    let bb = dot(b, b);
    if (!(across * across > 1e-14 * aa * bb)) {
        return vec2<f32>(1.0, 0.0);
    }
    let zeta = (bb - aa) / (2.0 * across);
    let t = select(-1.0, 1.0, zeta >= 0.0) / (abs(zeta) + sqrt(1.0 + zeta * zeta));
    let c = 1.0 / sqrt(1.0 + t * t);
    return vec2<f32>(c, c * t);
}

fn some_normal(a: vec3<f32>) -> vec3<f32> {
    let other = select(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0), abs(a.x) > 0.6);
    return normalize(cross(a, other));
}

fn svd(m: mat3x3<f32>) -> Svd {
    var a = m[0];
    var b = m[1];
    var c = m[2];
    var va = vec3<f32>(1.0, 0.0, 0.0);
    var vb = vec3<f32>(0.0, 1.0, 0.0);
    var vc = vec3<f32>(0.0, 0.0, 1.0);
    for (var sweep = 0u; sweep < SVD_SWEEPS; sweep++) {
        let p = turn_apart(a, b);
        let a1 = p.x * a - p.y * b;
        b = p.y * a + p.x * b;
        a = a1;
        let va1 = p.x * va - p.y * vb;
        vb = p.y * va + p.x * vb;
        va = va1;
        let q = turn_apart(a, c);
        let a2 = q.x * a - q.y * c;
        c = q.y * a + q.x * c;
        a = a2;
        let va2 = q.x * va - q.y * vc;
        vc = q.y * va + q.x * vc;
        va = va2;
        let r = turn_apart(b, c);
        let b1 = r.x * b - r.y * c;
        c = r.y * b + r.x * c;
        b = b1;
        let vb1 = r.x * vb - r.y * vc;
        vc = r.y * vb + r.x * vc;
        vb = vb1;
        if (p.y == 0.0 && q.y == 0.0 && r.y == 0.0) {
            break;
        }
    }
    // Longest first; one of each swapped pair changes sign, so that v stays a rotation.
    if (dot(a, a) < dot(b, b)) {
        let old = a;
        a = b;
        b = -old;
        let v_old = va;
        va = vb;
        vb = -v_old;
    }
    if (dot(b, b) < dot(c, c)) {
        let old = b;
        b = c;
        c = -old;
        let v_old = vb;
        vb = vc;
        vc = -v_old;
    }
    if (dot(a, a) < dot(b, b)) {
        let old = a;
        a = b;
        b = -old;
        let v_old = va;
        va = vb;
        vb = -v_old;
    }
    // Columns too short to have a direction get one at right angles to the others.
    let longest = length(a);
    var ua = vec3<f32>(1.0, 0.0, 0.0);
    if (longest > 1e-18) {
        ua = a / longest;
    }
    let rest = b - ua * dot(ua, b);
    let second = length(rest);
    var ub = some_normal(ua);
    if (second > 1e-6 * longest && second > 1e-18) {
        ub = rest / second;
    }
    let uc = cross(ua, ub);
    return Svd(mat3x3<f32>(ua, ub, uc), vec3<f32>(longest, dot(ub, b), dot(uc, c)), mat3x3<f32>(va, vb, vc));
}

// u diag(d) w^T.
fn compose(u: mat3x3<f32>, d: vec3<f32>, w: mat3x3<f32>) -> mat3x3<f32> {
    return mat3x3<f32>(u[0] * d.x, u[1] * d.y, u[2] * d.z) * transpose(w);
}

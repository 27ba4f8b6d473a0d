// The steps of expressions: on plain numbers, and on numbers that carry their derivatives by the
// particle's place and velocity. `src/spec/expression/evaluate.rs` has the same in f64.

struct Dual {
    value: f32,
    by_x: vec3<f32>,
    by_v: vec3<f32>,
}

// A value that is none. Made of bits that are known only when it runs: none is no constant.
fn undefined(like: f32) -> f32 {
    return bitcast<f32>(0x7fc00000u | (bitcast<u32>(like) & 1u));
}

// Whether it is no number, by its bits.
fn is_none(a: f32) -> bool {
    return (bitcast<u32>(a) & 0x7fffffffu) > 0x7f800000u;
}

// What is left of an angle within half a half turn, and whether an odd number of half turns went, `offset`
// half turns aside. Within 1e-7 for angles to 2e7: what a device calls sin() is often far coarser. First whole
// thousands of turns go, then half turns, each length in parts of so few bits that their multiples are exact
// (Cody and Waite).
fn within_half_turn(angle: f32, offset: f32) -> vec2<f32> {
    let thousands = round(angle * 1.5542472e-4);
    let a = ((angle - thousands * 6432.0) - thousands * 1.9814453125) - thousands * 3.0923938e-4;
    let turns = round(a * 0.31830988618 - offset) + offset;
    let r = ((a - turns * 3.140625) - turns * 9.67502593994140625e-4) - turns * 1.509957990978376432e-7;
    return vec2<f32>(clamp(r, -2.0, 2.0) + 0.0 * r, f32(i32(floor(turns)) & 1));
}

fn sine_series(r: f32) -> f32 {
    let s = r * r;
    return r + r * s * (-1.6666667e-1 + s * (8.3333333e-3 + s * (-1.9841270e-4 + s * (2.7557319e-6 + s * -2.5052108e-8))));
}

fn sine(a: f32) -> f32 {
    let rest = within_half_turn(a, 0.0);
    return sine_series(rest.x) * (1.0 - 2.0 * rest.y);
}

// -sin of what is left beyond an odd number of quarter turns.
fn cosine(a: f32) -> f32 {
    let rest = within_half_turn(a, 0.5);
    return sine_series(rest.x) * (2.0 * rest.y - 1.0);
}

fn quotient(a: f32, b: f32) -> f32 {
    return select(a / b, undefined(a), b == 0.0);
}

fn logarithm(a: f32) -> f32 {
    return select(log(abs(a)), undefined(a), a <= 0.0);
}

fn root(a: f32) -> f32 {
    return select(sqrt(abs(a)), undefined(a), a < 0.0);
}

// a^b; of a negative base only where the exponent is whole.
fn power(a: f32, b: f32) -> f32 {
    let whole = b == floor(b);
    let odd = whole && fract(0.5 * b) != 0.0;
    let size = exp2(b * log2(abs(a)));
    let signed = select(size, -size, a < 0.0 && odd);
    let at_zero = select(select(undefined(a), 1.0, b == 0.0), 0.0, b > 0.0);
    return select(select(signed, undefined(a), a < 0.0 && !whole), at_zero, a == 0.0);
}

// What is no number is neither the smaller nor the larger: it stays.
fn least(a: f32, b: f32) -> f32 {
    return select(min(a, b), undefined(a), is_none(a) || is_none(b));
}

fn most(a: f32, b: f32) -> f32 {
    return select(max(a, b), undefined(a), is_none(a) || is_none(b));
}

fn noise_at(x: f32, y: f32, z: f32) -> f32 {
    return select(noise(x, y, z), undefined(x), is_none(x) || is_none(y) || is_none(z));
}

fn random_of(a: f32) -> f32 {
    return select(random(a), undefined(a), is_none(a));
}

fn truth(holds: bool) -> f32 {
    return select(0.0, 1.0, holds);
}

// What does not change.
fn level(value: f32) -> Dual {
    return Dual(value, vec3<f32>(0.0), vec3<f32>(0.0));
}

fn chain(a: Dual, value: f32, by: f32) -> Dual {
    return Dual(value, by * a.by_x, by * a.by_v);
}

fn chain2(a: Dual, b: Dual, value: f32, by_a: f32, by_b: f32) -> Dual {
    return Dual(value, by_a * a.by_x + by_b * b.by_x, by_a * a.by_v + by_b * b.by_v);
}

fn add_dual(a: Dual, b: Dual) -> Dual {
    return chain2(a, b, a.value + b.value, 1.0, 1.0);
}

fn subtract_dual(a: Dual, b: Dual) -> Dual {
    return chain2(a, b, a.value - b.value, 1.0, -1.0);
}

fn multiply_dual(a: Dual, b: Dual) -> Dual {
    return chain2(a, b, a.value * b.value, b.value, a.value);
}

fn divide_dual(a: Dual, b: Dual) -> Dual {
    let inverse = select(1.0 / b.value, 0.0, b.value == 0.0);
    return chain2(a, b, quotient(a.value, b.value), inverse, -a.value * inverse * inverse);
}

fn negate_dual(a: Dual) -> Dual {
    return chain(a, -a.value, -1.0);
}

fn sin_dual(a: Dual) -> Dual {
    return chain(a, sine(a.value), cosine(a.value));
}

fn cos_dual(a: Dual) -> Dual {
    return chain(a, cosine(a.value), -sine(a.value));
}

fn exp_dual(a: Dual) -> Dual {
    let value = exp(a.value);
    return chain(a, value, value);
}

fn ln_dual(a: Dual) -> Dual {
    return chain(a, logarithm(a.value), select(1.0 / a.value, 0.0, a.value <= 0.0));
}

// The corner of a root at zero counts as level.
fn sqrt_dual(a: Dual) -> Dual {
    let value = root(a.value);
    return chain(a, value, select(0.5 / value, 0.0, a.value <= 0.0));
}

fn pow_dual(a: Dual, b: Dual) -> Dual {
    let value = power(a.value, b.value);
    let corner = b.value == 0.0 || (a.value == 0.0 && b.value < 1.0);
    let by_a = select(b.value * power(a.value, b.value - 1.0), 0.0, corner);
    return chain2(a, b, value, by_a, select(0.0, value * log(abs(a.value)), a.value > 0.0));
}

fn abs_dual(a: Dual) -> Dual {
    return chain(a, abs(a.value), select(1.0, -1.0, a.value < 0.0));
}

fn choose_dual(which: f32, a: Dual, b: Dual) -> Dual {
    if (which != 0.0) {
        return a;
    }
    return b;
}

fn min_dual(a: Dual, b: Dual) -> Dual {
    let chosen = choose_dual(truth(b.value < a.value), b, a);
    return Dual(least(a.value, b.value), chosen.by_x, chosen.by_v);
}

fn max_dual(a: Dual, b: Dual) -> Dual {
    let chosen = choose_dual(truth(a.value < b.value), b, a);
    return Dual(most(a.value, b.value), chosen.by_x, chosen.by_v);
}

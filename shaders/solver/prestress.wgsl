// What the search for the captured pose's prestress keeps on the grid: conjugate gradients over the
// nodes of the active blocks, planes of vec4, plane v of node k at [v * nodes + k].

const BOUND: u32 = 0u;     // normal of a support, or 0; w: 0 free, 1 held along it, 2 held wholly
const RESIDUAL: u32 = 1u;  // force left over; w: pseudo mass of the node
const DIRECTION: u32 = 2u; // of the next step
const PRODUCT: u32 = 3u;   // stiffness times DIRECTION
const SOLUTION: u32 = 4u;  // displacement; w: what gravity accelerates the pseudo mass by

struct Search {
    // Length of the step along the direction, and how much of the direction the next one keeps.
    alpha: f32,
    beta: f32,
    // Residual times preconditioned residual.
    gamma: f32,
    // Energy gained since the system was set up, twice. It falls as the slow modes settle, which the
    // residual does not.
    gained: f32,
    // Square of the force left over against weight, and the weight that it is measured by.
    left: f32,
    weight: f32,
    // Rounds since the system was set up.
    rounds: u32,
    done: u32,
    // Supports that were let go of, because they would have had to pull.
    released: f32,
}

// What a pass of the search is for, in the immediates' last word. It is read through `steer` with a
// word of a buffer that is under 2^31: lavapipe compiles a pass anew for each value of an immediate
// that alone decides a branch.
const SET_UP: u32 = 0u;
const CURVATURE: u32 = 1u;
const TURN: u32 = 2u;
const ADOPT: u32 = 3u;

fn steer(job: u32, word: u32) -> u32 {
    return job + (word >> 31u);
}

fn hold(v: vec3<f32>, bound: vec4<f32>) -> vec3<f32> {
    if (bound.w == 2.0) {
        return vec3<f32>(0.0);
    }
    return v - bound.xyz * (dot(v, bound.xyz) * bound.w);
}

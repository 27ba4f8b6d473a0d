// Of each substance at each boundary of the segment's substeps.
@group(0) @binding(11) var<storage, read> activations: array<f32>;
// Rows of the deformation that is shown of particles whose F forgets, in the original order.
@group(0) @binding(12) var<storage, read_write> shown: array<vec4<f32>>;

// Of each substance at each boundary of the segment's substeps.
@group(0) @binding(5) var<storage, read> activations: array<f32>;

// Activation of a row of the table, after so many substeps of the run.
fn activation(row: u32, time: u32) -> f32 {
    let rows = arrayLength(&substances);
    let k = (time - params.first_substep) * rows + row;
    return activations[min(k, arrayLength(&activations) - 1u)];
}

//! Inputs that mutations start from: the target's seeds, those of a folder, and each that came to a new class of outcome.

use std::path::{Path, PathBuf};

/// Inputs kept at most: more of them make each one rarer.
const MOST: usize = 1024;

/// A list of inputs, and the folder that it is kept in.
pub struct Corpus {
    inputs: Vec<Vec<u8>>,
    folder: Option<PathBuf>,
}

impl Corpus {
    /// The seeds and the files of a folder, by name, so that equal folders give equal runs.
    pub fn open(seeds: Vec<Vec<u8>>, folder: Option<&Path>) -> Result<Corpus, String> {
        let mut inputs = seeds;
        if let Some(folder) = folder {
            let explain = |error: std::io::Error| format!("cannot use the corpus {}: {error}", folder.display());
            std::fs::create_dir_all(folder).map_err(explain)?;
            let mut files: Vec<PathBuf> = std::fs::read_dir(folder).map_err(explain)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
            files.sort();
            for file in files.into_iter().filter(|file| file.is_file()).take(MOST) {
                inputs.push(std::fs::read(&file).map_err(explain)?);
            }
        }
        Ok(Corpus { inputs, folder: folder.map(Path::to_owned) })
    }

    /// All of them; never none.
    pub fn inputs(&self) -> &[Vec<u8>] {
        &self.inputs
    }

    /// Keeps one more, while there is room.
    pub fn add(&mut self, input: Vec<u8>) -> Result<(), String> {
        if self.inputs.len() >= MOST || self.inputs.contains(&input) {
            return Ok(());
        }
        if let Some(folder) = &self.folder {
            let file = folder.join(&blake3::hash(&input).to_hex()[..16]);
            std::fs::write(&file, &input).map_err(|error| format!("cannot write {}: {error}", file.display()))?;
        }
        self.inputs.push(input);
        Ok(())
    }
}

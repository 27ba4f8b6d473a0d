//! Where versions and results are kept.

use super::flags::Flags;
use std::path::{Path, PathBuf};

/// Name of the folder that is looked for.
const FOLDER: &str = ".phystalk";

/// The store that `--store` names, or the nearest `.phystalk` here or above; none where there is none yet.
pub fn find(flags: &Flags) -> Option<PathBuf> {
    match &flags.store {
        Some(given) => given.is_dir().then(|| given.clone()),
        None => above(&std::env::current_dir().ok()?),
    }
}

fn above(folder: &Path) -> Option<PathBuf> {
    folder.ancestors().map(|a| a.join(FOLDER)).find(|p| p.is_dir())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_store_above_is_found() {
        let root = tempfile::tempdir().unwrap();
        let deep = root.path().join("a/b/c");
        std::fs::create_dir_all(&deep).unwrap();
        assert_eq!(above(&deep).filter(|p| p.starts_with(root.path())), None);
        std::fs::create_dir(root.path().join("a").join(FOLDER)).unwrap();
        assert_eq!(above(&deep), Some(root.path().join("a").join(FOLDER)));
    }
}

//! Paths of files as text, in one reversible form: a path that is UTF-8 stands as it is; any other is `bytes:` and its bytes, of
//! which those that are no UTF-8, and `%`, are percent-encoded (`bytes:caf%E9.splat`).

use std::path::{Path, PathBuf};

/// What marks the encoded form. A path that begins so itself is encoded too.
const PREFIX: &str = "bytes:";

/// A path as text. It is never refused and never loses a byte on Unix.
pub fn encode(path: &Path) -> String {
    if let Some(text) = path.to_str().filter(|text| !text.starts_with(PREFIX)) {
        return text.to_owned();
    }
    let mut text = PREFIX.to_owned();
    for chunk in path.as_os_str().as_encoded_bytes().utf8_chunks() {
        text.push_str(&chunk.valid().replace('%', "%25"));
        chunk.invalid().iter().for_each(|byte| text.push_str(&format!("%{byte:02X}")));
    }
    text
}

/// The path that a text stands for.
pub fn decode(text: &str) -> PathBuf {
    let Some(mut rest) = text.strip_prefix(PREFIX).map(str::as_bytes) else { return PathBuf::from(text) };
    let mut bytes = Vec::with_capacity(rest.len());
    while let [first, tail @ ..] = rest {
        let digits = tail.first_chunk::<2>().filter(|_| *first == b'%').and_then(|two| std::str::from_utf8(two).ok());
        // What is no pair of digits stands for itself.
        match digits.filter(|two| two.bytes().all(|b| b.is_ascii_hexdigit())).and_then(|two| u8::from_str_radix(two, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(*first);
                rest = tail;
            }
        }
    }
    path_of(bytes)
}

#[cfg(unix)]
fn path_of(bytes: Vec<u8>) -> PathBuf {
    use std::os::unix::ffi::OsStringExt;
    std::ffi::OsString::from_vec(bytes).into()
}

#[cfg(not(unix))]
fn path_of(bytes: Vec<u8>) -> PathBuf {
    String::from_utf8_lossy(&bytes).into_owned().into()
}

/// For `serialize_with`: serde refuses paths that are not UTF-8.
pub fn serialize<S: serde::Serializer>(path: &Path, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&encode(path))
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn what_is_utf_8_stands_as_it_is_and_the_rest_can_be_read() {
        assert_eq!(encode(Path::new("a/100 %/vase.splat")), "a/100 %/vase.splat");
        assert_eq!(encode(&path_of(b"a/caf\xe9 100 %.splat".to_vec())), "bytes:a/caf%E9 100 %25.splat");
        assert_eq!(encode(Path::new("bytes:a")), "bytes:bytes:a");
        assert_eq!(decode("bytes:%zz%4"), Path::new("%zz%4"));
    }

    proptest! {
        #[test]
        fn every_path_comes_back(bytes in prop::collection::vec(any::<u8>(), 0..40), marked in any::<bool>()) {
            let path = path_of(if marked { [b"bytes:".to_vec(), bytes].concat() } else { bytes });
            prop_assert_eq!(decode(&encode(&path)), path);
        }

        #[test]
        fn any_text_is_a_path(text in "(bytes:)?[%a-f0-9\u{e9}]{0,12}") {
            let _ = decode(&text);
        }
    }
}

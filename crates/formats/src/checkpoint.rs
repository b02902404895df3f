//! Checkpoint files: bytes that are whole, of the expected layout, and undamaged, or refused.
//!
//! The file begins with a mark and the number of the layout of its content, and ends with the length of the content and an
//! XXH3 checksum of 128 bits over everything before. What the content means is the business of whoever writes it.

use crate::atomic::AtomicFile;
use crate::error::FormatError;
use std::fs;
use std::io::{self, Write};
use std::path::Path;
use xxhash_rust::xxh3::{Xxh3, xxh3_128};

/// First bytes of the file. The last three show a file that was treated as text on its way.
const MAGIC: [u8; 12] = *b"granule\x1a\x00\r\n\xff";
/// Bytes before the content: mark and layout.
const HEAD: usize = MAGIC.len() + 4;
/// Bytes behind the content: its length and the checksum.
const TAIL: usize = 8 + 16;

/// Writes a file: `content` writes its bytes. Under the name there is then the whole file, or what was there before.
///
/// # Errors
/// As [`AtomicFile::create`] and [`AtomicFile::commit`], and what `content` returns.
pub fn write(
    path: impl AsRef<Path>,
    layout: u32,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FormatError> {
    let path = path.as_ref();
    let mut out = Hashing { file: AtomicFile::create(path)?, hash: Xxh3::new(), length: 0 };
    let fill = || {
        out.write_all(&MAGIC)?;
        out.write_all(&layout.to_le_bytes())?;
        out.length = 0;
        content(&mut out)?;
        let length = out.length;
        out.write_all(&length.to_le_bytes())?;
        let checksum = out.hash.digest128().to_le_bytes();
        out.file.write_all(&checksum)
    };
    fill().map_err(FormatError::io(path, "write"))?;
    out.file.commit()
}

/// Reads the content of a file of the given layout.
///
/// # Errors
/// [`FormatError::Io`]; [`FormatError::Refused`] for a file that is no checkpoint, has another layout, is cut short, or whose
/// checksum is wrong.
pub fn read(path: impl AsRef<Path>, layout: u32) -> Result<Vec<u8>, FormatError> {
    let path = path.as_ref();
    let mut bytes = fs::read(path).map_err(FormatError::io(path, "read"))?;
    let refuse = |problem: String| FormatError::refused(path, problem);
    if !bytes.starts_with(&MAGIC) {
        let problem = if bytes.is_empty() { "it is empty" } else { "it is no checkpoint of granule" };
        return Err(refuse(problem.to_string()));
    }
    let number =
        |at: usize| bytes.get(at..at + 8).map(|b| u64::from_le_bytes(b.try_into().unwrap_or_default()));
    let found = bytes.get(MAGIC.len()..HEAD).map(|b| u32::from_le_bytes(b.try_into().unwrap_or_default()));
    match found {
        Some(found) if found != layout => {
            return Err(refuse(format!(
                "it has layout {found}, this program reads layout {layout}: continue with the program that wrote it"
            )));
        }
        _ => {}
    }
    let Some(end) = bytes.len().checked_sub(TAIL).filter(|end| *end >= HEAD) else {
        return Err(refuse("it is cut short".to_string()));
    };
    let checksum = xxh3_128(&bytes[..end + 8]).to_le_bytes();
    if bytes[end + 8..] != checksum {
        // The length stands where it belongs in a whole file only.
        let whole = number(end) == Some((end - HEAD) as u64);
        let problem =
            if whole { "it is damaged: its checksum is wrong" } else { "it is cut short or damaged" };
        return Err(refuse(problem.to_string()));
    }
    if number(end) != Some((end - HEAD) as u64) {
        return Err(refuse("it is damaged: its length is wrong".to_string()));
    }
    bytes.truncate(end);
    bytes.drain(..HEAD);
    Ok(bytes)
}

/// Hashes and counts what goes by.
struct Hashing {
    file: AtomicFile,
    hash: Xxh3,
    length: u64,
}

impl Write for Hashing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.hash.update(&bytes[..written]);
        self.length += written as u64;
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn put(path: &Path, content: &[u8]) {
        write(path, 3, |out| out.write_all(content)).unwrap();
    }

    fn refusal(path: &Path, layout: u32) -> String {
        read(path, layout).unwrap_err().to_string()
    }

    #[test]
    fn the_content_comes_back_and_only_under_its_layout() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        for content in [&b""[..], b"x", &[7; 100_000]] {
            put(&path, content);
            assert_eq!(read(&path, 3).unwrap(), content);
        }
        assert!(
            refusal(&path, 4).contains("has layout 3, this program reads layout 4"),
            "{}",
            refusal(&path, 4)
        );
        fs::write(&path, b"step,time\n0,0\n").unwrap();
        assert!(refusal(&path, 3).ends_with("it is no checkpoint of granule"));
        fs::write(&path, b"").unwrap();
        assert!(refusal(&path, 3).ends_with("it is empty"));
        fs::write(&path, &MAGIC[..]).unwrap();
        assert!(refusal(&path, 3).ends_with("it is cut short"));
        assert!(refusal(&folder.path().join("none"), 3).starts_with("cannot read"));
    }

    #[test]
    fn what_cannot_be_written_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        put(&path, b"old");
        let full = || io::Error::from(io::ErrorKind::StorageFull);
        let error = write(&path, 3, |out| out.write_all(b"new").and_then(|()| Err(full()))).unwrap_err();
        assert!(error.to_string().starts_with("cannot write"), "{error}");
        assert_eq!(read(&path, 3).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    proptest! {
        /// A checksum of 128 bits misses a change by chance once in 3e38.
        #[test]
        fn every_change_is_noticed(content in prop::collection::vec(any::<u8>(), 0..200), at in 0.0..1.0f64, bit in 0..8u8, cut: bool) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("a");
            put(&path, &content);
            let mut bytes = fs::read(&path).unwrap();
            let at = (at * bytes.len() as f64) as usize;
            if cut { bytes.truncate(at) } else { bytes[at] ^= 1 << bit }
            fs::write(&path, &bytes).unwrap();
            prop_assert!(read(&path, 3).is_err());
        }
    }
}

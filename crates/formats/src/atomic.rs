//! Files that are whole at every moment.
//!
//! [`AtomicFile`] is for files that are written once: under its name there is the old content or the new one, never a
//! part. [`GrowingFile`] is for files that get longer during a run: it consists of whole records at every moment at
//! which the program can be interrupted, and a record that a crash tore apart is cut off when the file is opened again.

use crate::error::FormatError;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file that appears under its name when it is complete.
///
/// Until [`AtomicFile::commit`] the content lives in a temporary file in the same folder; dropping it without a
/// commit removes that file and leaves what was there before.
#[derive(Debug)]
pub struct AtomicFile {
    target: PathBuf,
    inner: BufWriter<NamedTempFile>,
}

impl AtomicFile {
    /// Starts a file that will be `target`, in a folder that exists. Its mode is that of any new file: 0666 less the
    /// umask, which is usually 0644.
    ///
    /// # Errors
    /// When the folder does not exist or does not allow new files.
    pub fn create(target: impl AsRef<Path>) -> Result<AtomicFile, FormatError> {
        let target = target.as_ref();
        let mut builder = tempfile::Builder::new();
        builder.prefix(".granule-").suffix(".part");
        #[cfg(unix)]
        let everybody = {
            use std::os::unix::fs::PermissionsExt;
            fs::Permissions::from_mode(0o666)
        };
        #[cfg(unix)]
        builder.permissions(everybody);
        let temporary = builder.tempfile_in(folder(target)).map_err(FormatError::io(target, "create"))?;
        Ok(AtomicFile { target: target.to_path_buf(), inner: BufWriter::with_capacity(1 << 18, temporary) })
    }

    /// Path of the complete file.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Writes everything to the disk and gives the file its name, replacing a file of that name.
    ///
    /// # Errors
    /// When the disk is full or the name cannot be given, for instance because it is a folder. Then nothing changed.
    pub fn commit(self) -> Result<(), FormatError> {
        let AtomicFile { target, inner } = self;
        let finish = || {
            let temporary = inner.into_inner().map_err(|error| error.into_error())?;
            temporary.as_file().sync_all()?;
            temporary.persist(&target).map_err(|error| error.error)?;
            sync_folder(folder(&target))
        };
        finish().map_err(FormatError::io(&target, "write"))
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.inner.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Writes a whole file at once.
///
/// # Errors
/// As [`AtomicFile::create`] and [`AtomicFile::commit`].
pub fn write(target: impl AsRef<Path>, content: &[u8]) -> Result<(), FormatError> {
    write_with(target.as_ref(), |out| out.write_all(content))
}

fn write_with(
    target: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FormatError> {
    let mut file = AtomicFile::create(target)?;
    content(&mut file).map_err(FormatError::io(target, "write"))?;
    file.commit()
}

/// A file to which whole records are appended.
///
/// Every record is handed to the operating system before [`GrowingFile::append`] returns, so that it survives the
/// death of the program; [`GrowingFile::sync`] makes it survive the death of the machine.
#[derive(Debug)]
pub struct GrowingFile {
    path: PathBuf,
    file: File,
    length: u64,
}

impl GrowingFile {
    /// Starts a file whose first record is there from the beginning; a file of that name is replaced.
    ///
    /// # Errors
    /// As [`AtomicFile::commit`].
    pub fn create(
        path: impl AsRef<Path>,
        first: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<GrowingFile, FormatError> {
        let path = path.as_ref();
        write_with(path, first)?;
        let length = fs::metadata(path).map_err(FormatError::io(path, "open"))?.len();
        GrowingFile::open(path, length)
    }

    /// Opens a file, keeping its first `keep` bytes.
    ///
    /// # Errors
    /// When the file is shorter than that or cannot be written.
    pub fn open(path: impl AsRef<Path>, keep: u64) -> Result<GrowingFile, FormatError> {
        let path = path.as_ref();
        let open = || {
            let mut file = OpenOptions::new().write(true).open(path)?;
            if file.metadata()?.len() < keep {
                return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the file became shorter"));
            }
            file.set_len(keep)?;
            file.seek(SeekFrom::Start(keep))?;
            Ok(file)
        };
        let file = open().map_err(FormatError::io(path, "open"))?;
        Ok(GrowingFile { path: path.to_path_buf(), file, length: keep })
    }

    /// Appends a record, in pieces of any size. After an error, such as a full disk, the file ends with the record
    /// before.
    ///
    /// # Errors
    /// When the operating system refuses to write.
    pub fn append(
        &mut self,
        record: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), FormatError> {
        match record(&mut self.file).and_then(|()| self.file.stream_position()) {
            Ok(length) => {
                self.length = length;
                Ok(())
            }
            Err(error) => {
                // The first error is the one to report; if cutting fails too, the next opening cuts.
                let _ = self
                    .file
                    .set_len(self.length)
                    .and_then(|()| self.file.seek(SeekFrom::Start(self.length)));
                Err(FormatError::io(&self.path, "append to")(error))
            }
        }
    }

    /// Bytes of all whole records.
    pub fn length(&self) -> u64 {
        self.length
    }

    /// Waits until everything is on the disk.
    ///
    /// # Errors
    /// When the disk fails.
    pub fn sync(&self) -> Result<(), FormatError> {
        self.file.sync_all().map_err(FormatError::io(&self.path, "write"))
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }
}

/// Compares the beginning of a file that is to be continued at `length` with what it must be, and looks whether a line ends
/// there.
pub(crate) fn continued(path: &Path, head: &[u8], length: u64) -> Result<(), FormatError> {
    let read = || {
        let mut file = File::open(path)?;
        let mut begin = vec![0; head.len()];
        let (mut same, mut last) = (false, [0]);
        if length >= head.len() as u64 && file.metadata()?.len() >= length {
            file.read_exact(&mut begin)?;
            same = begin == head;
            file.seek(SeekFrom::Start(length.saturating_sub(1)))?;
            file.read_exact(&mut last)?;
        }
        Ok(same && last == *b"\n")
    };
    match read().map_err(FormatError::io(path, "read"))? {
        true => Ok(()),
        false => {
            let problem = format!(
                "it is not what this run has written: a file of at least {length} bytes with another beginning"
            );
            Err(FormatError::refused(path, problem))
        }
    }
}

/// Reads a whole file; bytes that are not UTF-8 become `U+FFFD`, which no number contains.
pub(crate) fn read_text(path: &Path) -> Result<String, FormatError> {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|mut file| file.read_to_end(&mut bytes));
    read.map_err(FormatError::io(path, "read"))?;
    Ok(String::from_utf8(bytes)
        .unwrap_or_else(|error| String::from_utf8_lossy(error.as_bytes()).into_owned()))
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes the new name survive the death of the machine, where folders can be synchronised at all.
fn sync_folder(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        Err(error) if !matches!(error.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => {
            Err(error)
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn nothing_is_seen_before_the_commit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write(&path, b"old").unwrap();
        let mut file = AtomicFile::create(&path).unwrap();
        file.write_all(b"new content").unwrap();
        file.flush().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"old");
        file.commit().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new content");
        assert_eq!(names(folder.path()), ["a.txt"]);
    }

    #[test]
    fn a_dropped_file_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        let mut file = AtomicFile::create(folder.path().join("a.txt")).unwrap();
        file.write_all(b"half").unwrap();
        drop(file);
        assert!(names(folder.path()).is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn the_mode_is_that_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        let (plain, ours) = (folder.path().join("plain"), folder.path().join("ours"));
        File::create(&plain).unwrap();
        write(&ours, b"x").unwrap();
        assert_eq!(mode(&ours), mode(&plain));
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("nowhere/a.txt");
        let error = write(&missing, b"x").unwrap_err().to_string();
        assert!(error.starts_with("cannot create `") && error.contains("nowhere/a.txt"), "{error}");
        let error = write(folder.path(), b"x").unwrap_err().to_string();
        assert!(error.starts_with("cannot write `"), "{error}");
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_growing_file_keeps_what_it_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log");
        let mut file = GrowingFile::create(&path, |out| out.write_all(b"head\n")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"head\n");
        file.append(|out| out.write_all(b"one\n")).unwrap();
        // Seen by others without a flush: nothing is kept back in the program.
        assert_eq!(fs::read(&path).unwrap(), b"head\none\n");
        let half_written = file.append(|out| {
            out.write_all(b"half")?;
            Err(io::Error::other("no more"))
        });
        assert!(half_written.is_err());
        assert_eq!(fs::read(&path).unwrap(), b"head\none\n");
        file.append(|out| out.write_all(b"torn")).unwrap();
        file.sync().unwrap();
        drop(file);
        let mut file = GrowingFile::open(&path, 9).unwrap();
        file.append(|out| out.write_all(b"two\n")).unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"head\none\ntwo\n");
        assert!(GrowingFile::open(&path, 1000).is_err());
        assert_eq!(fs::read(&path).unwrap(), b"head\none\ntwo\n");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_full_disk_is_an_error() {
        let path = PathBuf::from("/dev/full");
        let file = OpenOptions::new().write(true).open(&path).unwrap();
        let error = GrowingFile { path, file, length: 0 }.append(|out| out.write_all(b"record")).unwrap_err();
        assert!(error.to_string().starts_with("cannot append to `/dev/full`"), "{error}");
    }
}

//! Files that appear whole or not at all: written beside under another name, then renamed.

use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

use rayon::prelude::*;
use tempfile::NamedTempFile;

use crate::error::{Error, Result};

/// A destination that can be written and wound back.
pub(crate) trait Sink: Write + Seek {}
impl<T: Write + Seek> Sink for T {}

/// Writes a file through `fill`. Until it has returned, and when it fails, `path` stays as it was.
pub(crate) fn write_whole(
    path: &Path,
    fill: impl FnOnce(&mut dyn Sink) -> std::io::Result<()>,
) -> Result<()> {
    written(path, fill).and_then(|beside| put_in_place(beside, path))
}

/// Writes a file that is whole even after a power cut.
pub(crate) fn write_lasting(
    path: &Path,
    fill: impl FnOnce(&mut dyn Sink) -> std::io::Result<()>,
) -> Result<()> {
    let beside = written(path, fill)?;
    beside.as_file().sync_all().map_err(Error::io(path, "write"))?;
    put_in_place(beside, path)?;
    sync_folder(folder_of(path));
    Ok(())
}

/// Sees to it that written files survive a power cut. Files that are gone are passed over.
pub(crate) fn sync_all(paths: &[PathBuf]) -> Result<()> {
    paths.par_iter().try_for_each(|path| sync(path))?;
    if let Some(path) = paths.first() {
        sync_folder(folder_of(path));
    }
    Ok(())
}

fn sync(path: &Path) -> Result<()> {
    match File::options().write(true).open(path) {
        Err(gone) if gone.kind() == std::io::ErrorKind::NotFound => Ok(()),
        opened => opened.and_then(|file| file.sync_all()).map_err(Error::io(path, "write")),
    }
}

/// The same behind whoever writes the files, who seldom has to wait for the disk then.
pub(crate) struct Syncing {
    paths: SyncSender<PathBuf>,
    thread: JoinHandle<Result<()>>,
}

/// Files that may wait for the disk.
const BACKLOG: usize = 64;

impl Syncing {
    /// # Errors
    /// There is no thread to be had.
    pub(crate) fn begin() -> Result<Syncing> {
        let (paths, written) = sync_channel::<PathBuf>(BACKLOG);
        let each = move || written.into_iter().try_for_each(|path| sync(&path));
        let thread =
            std::thread::Builder::new().spawn(each).map_err(Error::io("a thread", "start"))?;
        Ok(Syncing { paths, thread })
    }

    /// Takes files on.
    pub(crate) fn extend(&self, paths: impl IntoIterator<Item = PathBuf>) {
        for path in paths {
            // A thread that has ended says why when it is asked.
            let _ = self.paths.send(path);
        }
    }

    /// Waits until all files that were taken on survive a power cut, their names in `folder` too.
    ///
    /// # Errors
    /// One cannot be written after all.
    pub(crate) fn end(self, folder: &Path) -> Result<()> {
        drop(self.paths);
        self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        sync_folder(folder);
        Ok(())
    }
}

/// The same for the names in a folder, as far as the system can.
pub(crate) fn sync_folder(folder: &Path) {
    // Not every system opens folders, and then it needs no such care.
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

fn written(
    path: &Path,
    fill: impl FnOnce(&mut dyn Sink) -> std::io::Result<()>,
) -> Result<NamedTempFile<File>> {
    let fail = || Error::io(path, "write");
    let mut beside = beside(folder_of(path), ".tmp").map_err(fail())?;
    let mut sink = BufWriter::with_capacity(1 << 18, beside.as_file_mut());
    fill(&mut sink).and_then(|()| sink.flush()).map_err(fail())?;
    drop(sink);
    Ok(beside)
}

fn put_in_place(beside: NamedTempFile<File>, path: &Path) -> Result<()> {
    let renamed = beside.persist(path);
    renamed.map(drop).map_err(|refused| Error::io(path, "write")(refused.error))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}

/// Writes a text file whole.
pub fn write_text(path: &Path, text: &str) -> Result<()> {
    write_whole(path, |sink| sink.write_all(text.as_bytes()))
}

/// A file of another name in the same folder, which goes away unless it is renamed.
pub(crate) fn beside(folder: &Path, suffix: &str) -> std::io::Result<NamedTempFile<File>> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".sungaze-").suffix(suffix);
    // A temporary file is private by default; this one becomes a file like any other.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("report.json");
        write_text(&path, "old").unwrap();
        let broken = |sink: &mut dyn Sink| {
            sink.write_all(b"half of the n")?;
            Err(std::io::Error::from(std::io::ErrorKind::StorageFull))
        };
        let error = write_whole(&path, broken).unwrap_err().to_string();
        assert!(error.contains("report.json: cannot write"), "{error}");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_folder_that_is_not_there_is_reported_with_the_file() {
        let error = write_text(Path::new("/no/such/folder/a.txt"), "").unwrap_err();
        assert!(error.to_string().starts_with("/no/such/folder/a.txt: cannot write"), "{error}");
    }
}

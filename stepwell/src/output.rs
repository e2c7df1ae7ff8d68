//! Files that appear whole or not at all.
//!
//! Everything is written under a hidden name beside its place and then renamed. A disk that cannot
//! be written to is found out by [`OutputFolder::prepare`] and [`OutputFile::prepare`], before the
//! work whose result would be lost.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use tempfile::{Builder, NamedTempFile, TempDir};

/// What a hidden name starts with.
const UNFINISHED: &str = ".stepwell-unfinished-";

/// A folder for results. It and the folders above it are made if they are missing.
pub struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Makes sure that the folder can be written to, and leaves no trace.
    pub fn prepare(path: &Path) -> anyhow::Result<OutputFolder> {
        let folder = OutputFolder {
            path: path.to_owned(),
        };
        if folder.path.exists() && !folder.path.is_dir() {
            bail!(
                "output folder {}: it is a file; choose another folder with -o",
                path.display()
            );
        }
        folder.stage().map_err(|cause| folder.problem(cause))?;
        Ok(folder)
    }

    /// Has `write` fill a hidden folder, and moves its files into place, replacing those of the
    /// same names. If anything fails the folder is left as it was.
    pub fn publish(&self, write: impl FnOnce(&Path) -> anyhow::Result<()>) -> anyhow::Result<()> {
        let (stage, contents) = self.stage().map_err(|cause| self.problem(cause))?;
        write(&contents)?;
        let moved = if contents == stage.path() {
            self.move_files(stage.path())
        } else {
            // The folder is new: one rename brings the uppermost missing folder into place.
            let (existing, missing) = split_at_missing(&self.path);
            let first = missing.components().next();
            first.map_or(Ok(()), |first| {
                fs::rename(stage.path().join(first), existing.join(first))
            })
        };
        moved.map_err(|cause| self.problem(cause))
    }

    /// A hidden folder, and the place in it for the contents: itself where the folder exists, else
    /// a copy of the folders that are missing.
    fn stage(&self) -> io::Result<(TempDir, PathBuf)> {
        let (existing, missing) = split_at_missing(&self.path);
        let stage = Builder::new().prefix(UNFINISHED).tempdir_in(existing)?;
        let contents = stage.path().join(missing);
        fs::create_dir_all(&contents)?;
        // Joining nothing adds a separator.
        let contents = if contents.as_path() == stage.path() {
            stage.path().to_owned()
        } else {
            contents
        };
        Ok((stage, contents))
    }

    /// Renames every file of `stage`, at any depth, into the folder; where one fails, undoes the
    /// others.
    fn move_files(&self, stage: &Path) -> io::Result<()> {
        let mut names = Vec::new();
        files_below(stage, Path::new(""), &mut names)?;
        if let Some(name) = names.iter().find(|name| self.path.join(name).is_dir()) {
            let message = format!("{} in it is a folder", name.display());
            return Err(io::Error::new(io::ErrorKind::IsADirectory, message));
        }
        let former = stage.join("former");
        let mut done = Vec::new();
        for name in &names {
            let (place, aside) = (self.path.join(name), former.join(name));
            let parents = [place.parent(), aside.parent()];
            let made = parents
                .into_iter()
                .flatten()
                .try_for_each(fs::create_dir_all);
            let moved = made
                .and_then(|()| set_aside(&place, &aside))
                .and_then(|()| fs::rename(stage.join(name), &place));
            done.push(name);
            if let Err(error) = moved {
                for name in done {
                    let place = self.path.join(name);
                    // As good as it can be undone: the disk has just failed.
                    let _ = fs::remove_file(&place);
                    let _ = fs::rename(former.join(name), &place);
                }
                return Err(error);
            }
        }
        Ok(())
    }

    fn problem(&self, cause: io::Error) -> anyhow::Error {
        anyhow!(
            "output folder {}: cannot be written to ({}); choose another with -o",
            self.path.display(),
            plain(&cause)
        )
    }
}

/// The paths of all files below `folder/below`, relative to `folder`.
fn files_below(folder: &Path, below: &Path, names: &mut Vec<PathBuf>) -> io::Result<()> {
    for entry in fs::read_dir(folder.join(below))? {
        let entry = entry?;
        let name = below.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            files_below(folder, &name, names)?;
        } else {
            names.push(name);
        }
    }
    Ok(())
}

/// Moves a file out of the way, if it is there.
fn set_aside(file: &Path, to: &Path) -> io::Result<()> {
    match fs::rename(file, to) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// The longest part of `path` that exists, and what is missing behind it.
fn split_at_missing(path: &Path) -> (&Path, &Path) {
    let existing = path
        .ancestors()
        .find(|part| part.as_os_str().is_empty() || part.exists())
        .unwrap_or(Path::new(""));
    let missing = path.strip_prefix(existing).unwrap_or(Path::new(""));
    if existing.as_os_str().is_empty() {
        (Path::new("."), missing)
    } else {
        (existing, missing)
    }
}

/// One file for results.
pub struct OutputFile {
    path: PathBuf,
}

impl OutputFile {
    /// Makes sure that the file can be written, and leaves no trace.
    pub fn prepare(path: &Path) -> anyhow::Result<OutputFile> {
        // A link is followed, so that the file behind it is replaced and not the link.
        let file = OutputFile {
            path: fs::canonicalize(path).unwrap_or_else(|_| path.to_owned()),
        };
        if file.path.is_dir() {
            bail!(
                "output {}: it is a folder; name a file with -o",
                path.display()
            );
        }
        if !file.is_device() {
            file.stage().map_err(|cause| file.problem(cause))?;
        }
        Ok(file)
    }

    /// Has `write` write the file, which appears when all of it is there.
    pub fn publish(
        &self,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> anyhow::Result<()> {
        if self.is_device() {
            let device = File::options().write(true).open(&self.path);
            return device
                .and_then(|mut device| fill(&mut device, write))
                .map_err(|cause| self.problem(cause));
        }
        let mut stage = self.stage().map_err(|cause| self.problem(cause))?;
        fill(stage.as_file_mut(), write).map_err(|cause| self.problem(cause))?;
        match stage.persist(&self.path) {
            Ok(_) => Ok(()),
            Err(failure) => Err(self.problem(failure.error)),
        }
    }

    /// Is it there and no regular file, such as `/dev/null` or a pipe? Those are written to as they
    /// are: a rename would put a file in their place.
    fn is_device(&self) -> bool {
        fs::metadata(&self.path).is_ok_and(|metadata| !metadata.is_file())
    }

    fn stage(&self) -> io::Result<NamedTempFile> {
        let folder = match self.path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        let mut builder = Builder::new();
        builder.prefix(UNFINISHED);
        // Readable by others, as any file is that a person makes; the process's mask applies.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.tempfile_in(folder)
    }

    fn problem(&self, cause: io::Error) -> anyhow::Error {
        anyhow!(
            "output {}: cannot be written ({}); choose another file with -o",
            self.path.display(),
            plain(&cause)
        )
    }
}

/// What the operating system says, without the name of the hidden file, which means nothing to
/// anybody: `tempfile` puts it behind these words.
fn plain(cause: &io::Error) -> String {
    let text = cause.to_string();
    let words = text.split(" at path ").next().unwrap_or_default();
    words.to_owned()
}

fn fill(file: &mut File, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut buffered = BufWriter::new(file);
    write(&mut buffered)?;
    buffered.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    fn write_two(text: &str) -> impl FnOnce(&Path) -> anyhow::Result<()> {
        move |folder| {
            fs::write(folder.join("a"), text)?;
            fs::write(folder.join("b"), text)?;
            Ok(())
        }
    }

    #[test]
    fn folders_appear_with_their_contents_and_files_are_replaced() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("x/y/z");
        let folder = OutputFolder::prepare(&path).unwrap();
        assert!(names(home.path()).is_empty());
        for text in ["one", "two"] {
            folder.publish(write_two(text)).unwrap();
            assert_eq!(names(&path), ["a", "b"]);
            assert_eq!(fs::read_to_string(path.join("b")).unwrap(), text);
        }
        assert_eq!(names(home.path()), ["x"]);
    }

    #[test]
    fn what_fails_leaves_the_folder_as_it_was() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("x/y");
        let folder = OutputFolder::prepare(&path).unwrap();
        let half = |folder: &Path| {
            fs::write(folder.join("a"), "half")?;
            bail!("no more")
        };
        assert!(folder.publish(half).is_err());
        assert!(names(home.path()).is_empty());
        folder.publish(write_two("whole")).unwrap();
        assert!(folder.publish(half).is_err());
        assert_eq!(fs::read_to_string(path.join("a")).unwrap(), "whole");
        // A folder where a file should go.
        fs::remove_file(path.join("b")).unwrap();
        fs::create_dir_all(path.join("b/inside")).unwrap();
        let message = format!("{:#}", folder.publish(write_two("new")).unwrap_err());
        assert!(message.contains("b in it is a folder"), "{message}");
        assert_eq!(fs::read_to_string(path.join("a")).unwrap(), "whole");
        assert_eq!(names(&path), ["a", "b"]);
    }

    #[test]
    fn a_file_in_the_way_of_a_folder_is_named() {
        let home = tempfile::tempdir().unwrap();
        let file = home.path().join("file");
        fs::write(&file, "").unwrap();
        for path in [file.clone(), file.join("folder")] {
            let error = OutputFolder::prepare(&path).err().unwrap();
            let message = format!("{error:#}");
            assert!(
                message.contains("-o") && !message.contains(UNFINISHED),
                "{message}"
            );
        }
        assert_eq!(names(home.path()), ["file"]);
    }

    #[test]
    fn a_file_is_whole_or_as_it_was() {
        let home = tempfile::tempdir().unwrap();
        let path = home.path().join("out.csv");
        let file = OutputFile::prepare(&path).unwrap();
        let half = |out: &mut dyn Write| {
            out.write_all(b"half")?;
            Err(io::Error::other("no more"))
        };
        assert!(file.publish(half).is_err());
        assert!(names(home.path()).is_empty());
        file.publish(|out| out.write_all(b"whole")).unwrap();
        assert!(file.publish(half).is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "whole");
        assert_eq!(names(home.path()), ["out.csv"]);
        assert!(OutputFile::prepare(home.path()).is_err());
        assert!(OutputFile::prepare(&path.join("under a file")).is_err());
    }

    #[cfg(unix)]
    #[test]
    fn devices_stay_and_links_are_followed() {
        use std::os::unix::fs::{FileTypeExt, symlink};
        let null = Path::new("/dev/null");
        let file = OutputFile::prepare(null).unwrap();
        file.publish(|out| out.write_all(b"gone")).unwrap();
        assert!(fs::metadata(null).unwrap().file_type().is_char_device());

        let home = tempfile::tempdir().unwrap();
        let (target, link) = (home.path().join("target"), home.path().join("link"));
        fs::write(&target, "old").unwrap();
        symlink(&target, &link).unwrap();
        let file = OutputFile::prepare(&link).unwrap();
        file.publish(|out| out.write_all(b"new")).unwrap();
        assert_eq!(fs::read_to_string(&target).unwrap(), "new");
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    }
}

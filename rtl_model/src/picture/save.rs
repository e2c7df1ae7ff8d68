//! Pictures into files, whole or not at all.

use std::fs;
use std::io::Cursor;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use image::{ImageFormat, RgbImage};
use thiserror::Error;

/// A picture that could not be saved. No part of it is left behind.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("picture {path}: cannot be written ({cause}); check that its folder exists and has room")]
pub struct SaveError {
    /// The file.
    pub path: PathBuf,
    /// What the operating system or the encoder says.
    pub cause: String,
}

/// Saves `picture` as a PNG file. It is written under another name in the same folder and then
/// renamed, so that `path` holds either what it held before or the whole picture.
///
/// # Errors
/// A folder that is missing, full or not writable.
pub fn save_png(picture: &RgbImage, path: &Path) -> Result<(), SaveError> {
    let failed = |cause: String| SaveError {
        path: path.to_owned(),
        cause,
    };
    let mut content = Cursor::new(Vec::new());
    picture
        .write_to(&mut content, ImageFormat::Png)
        .map_err(|error| failed(error.to_string()))?;
    let unfinished = unfinished_name(path);
    fs::write(&unfinished, content.into_inner())
        .and_then(|()| fs::rename(&unfinished, path))
        .map_err(|error| {
            // It may never have been created; what matters is that it is gone.
            let _ = fs::remove_file(&unfinished);
            failed(error.to_string())
        })
}

/// A hidden name beside `path` that no other process and no other call uses.
fn unfinished_name(path: &Path) -> PathBuf {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    let call = CALLS.fetch_add(1, Ordering::Relaxed);
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.{}-{call}.unfinished", process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    fn names_in(folder: &Path) -> Vec<String> {
        fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect()
    }

    #[test]
    fn a_saved_picture_reads_back_and_replaces_the_old_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        for shade in [3, 200] {
            let picture = RgbImage::from_pixel(5, 4, Rgb([shade, 7, 9]));
            save_png(&picture, &path).unwrap();
            assert_eq!(image::open(&path).unwrap().into_rgb8(), picture);
        }
        assert_eq!(names_in(folder.path()), ["a.png"]);
    }

    #[test]
    fn a_failure_names_the_file_and_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let picture = RgbImage::new(1, 1);
        let nowhere = folder.path().join("missing/a.png");
        let message = save_png(&picture, &nowhere).unwrap_err().to_string();
        assert!(message.contains("a.png"), "{message}");
        // A folder in the way: the rename fails after the picture has been written.
        let occupied = folder.path().join("b.png");
        fs::create_dir_all(occupied.join("inside")).unwrap();
        assert!(save_png(&picture, &occupied).is_err());
        assert_eq!(names_in(folder.path()), ["b.png"]);
    }
}

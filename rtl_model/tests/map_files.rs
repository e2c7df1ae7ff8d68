//! Height maps from files: every format and channel that is read, and every refusal.

use std::fs;
use std::path::{Path, PathBuf};

use image::{DynamicImage, ImageBuffer, Luma, LumaA, Rgb, Rgba};
use rtl_model::maps::{Channel, HeightMap, MapError};
use tempfile::TempDir;

/// Four heights of 8 bits, all different: an orientation that is wrong shows.
const BYTES: [u8; 4] = [0, 10, 200, 255];
/// Four of 16 bits, which differ in both bytes.
const WORDS: [u16; 4] = [0, 0x0123, 0xfedc, 65535];

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

/// A picture saved in the format its name ends in.
fn saved(folder: &TempDir, name: &str, image: impl Into<DynamicImage>) -> PathBuf {
    let path = folder.path().join(name);
    image.into().save(&path).unwrap();
    path
}

fn two_by_two<P: image::Pixel>(pixels: [P; 4]) -> ImageBuffer<P, Vec<P::Subpixel>> {
    ImageBuffer::from_fn(2, 2, |i, j| pixels[(2 * j + i) as usize])
}

fn loaded(path: &Path, channel: Channel) -> HeightMap {
    HeightMap::load(path, channel, false).unwrap()
}

fn refusal(path: &Path, channel: Channel) -> String {
    let message = HeightMap::load(path, channel, false)
        .unwrap_err()
        .to_string();
    assert!(message.contains(&path.display().to_string()), "{message}");
    message
}

fn as_words(bytes: [u8; 4]) -> [u16; 4] {
    bytes.map(u16::from)
}

#[test]
fn grey_files_of_8_bits_are_read_in_every_format() {
    let folder = folder();
    let image = two_by_two(BYTES.map(|height| Luma([height])));
    for name in ["grey.png", "grey.tga", "grey.pgm"] {
        let path = saved(&folder, name, image.clone());
        for channel in [Channel::Grey, Channel::Red] {
            let map = loaded(&path, channel);
            assert_eq!(map.heights(), as_words(BYTES), "{name}");
            assert_eq!((map.size(), map.bits(), map.name()), (2, 8, "grey"));
        }
        assert!(refusal(&path, Channel::Alpha).contains("--channel grey"));
    }
}

#[test]
fn grey_files_of_16_bits_are_read() {
    let folder = folder();
    let image = two_by_two(WORDS.map(|height| Luma([height])));
    for name in ["grey.png", "grey.pgm"] {
        let path = saved(&folder, name, image.clone());
        let map = loaded(&path, Channel::Grey);
        assert_eq!(map.heights(), WORDS, "{name}");
        assert_eq!(map.bits(), 16);
    }
}

#[test]
fn a_colour_image_gives_the_channel_asked_for_and_no_grey() {
    let folder = folder();
    let image = two_by_two(BYTES.map(|height| Rgba([height, 7, 9, 255 - height])));
    for name in ["colour.png", "colour.tga"] {
        let path = saved(&folder, name, image.clone());
        assert_eq!(loaded(&path, Channel::Red).heights(), as_words(BYTES));
        assert_eq!(
            loaded(&path, Channel::Alpha).heights(),
            as_words(BYTES.map(|height| 255 - height))
        );
        let message = refusal(&path, Channel::Grey);
        assert!(
            message.contains("(0, 0) is (0, 7, 9)") && message.contains("alpha channel"),
            "{message}"
        );
    }
    let opaque = two_by_two(BYTES.map(|height| Rgb([height, height, 1])));
    let message = refusal(&saved(&folder, "opaque.png", opaque), Channel::Grey);
    assert!(!message.contains("alpha"), "{message}");
}

#[test]
fn a_colour_image_of_16_bits_keeps_them() {
    let folder = folder();
    let image = two_by_two(WORDS.map(|height| Rgba([height, 1, 2, 65535 - height])));
    let path = saved(&folder, "wide.png", image);
    assert_eq!(loaded(&path, Channel::Red).heights(), WORDS);
    assert_eq!(
        loaded(&path, Channel::Alpha).heights(),
        WORDS.map(|height| 65535 - height)
    );
}

#[test]
fn grey_with_alpha_has_both_channels() {
    let folder = folder();
    let image = two_by_two(BYTES.map(|height| LumaA([height, 255 - height])));
    let path = saved(&folder, "both.png", image);
    assert_eq!(loaded(&path, Channel::Grey).heights(), as_words(BYTES));
    assert_eq!(
        loaded(&path, Channel::Alpha).heights(),
        as_words(BYTES.map(|height| 255 - height))
    );
}

/// An uncompressed TGA of 32 bits, written by hand: blue, green, red, alpha.
fn tga(descriptor: u8, alphas: [u8; 4]) -> Vec<u8> {
    let mut file = vec![0; 18];
    file[2] = 2; // uncompressed true colour
    file[12] = 2; // width
    file[14] = 2; // height
    file[16] = 32; // bits of a pixel
    file[17] = descriptor;
    for alpha in alphas {
        file.extend([1, 2, 3, alpha]);
    }
    file
}

#[test]
fn the_origin_of_a_tga_is_obeyed() {
    let folder = folder();
    let path = folder.path().join("map.tga");
    let [a, b, c, d] = BYTES;
    // Descriptor: 8 bits of alpha, bit 5 = rows from the top, bit 4 = columns from the right.
    for (descriptor, stored) in [
        (0x28, [a, b, c, d]),
        (0x08, [c, d, a, b]),
        (0x38, [b, a, d, c]),
        (0x18, [d, c, b, a]),
    ] {
        fs::write(&path, tga(descriptor, stored)).unwrap();
        let map = loaded(&path, Channel::Alpha);
        assert_eq!(map.heights(), as_words(BYTES), "{descriptor:#x}");
        assert_eq!(loaded(&path, Channel::Red).heights(), [3; 4]);
    }
}

#[test]
fn the_plain_pgm_of_a_text_editor_is_read() {
    let folder = folder();
    let path = folder.path().join("plain.pgm");
    fs::write(&path, "P2\n# by hand\n2 2\n255\n0 10\n200 255\n").unwrap();
    assert_eq!(loaded(&path, Channel::Grey).heights(), as_words(BYTES));
}

#[test]
fn white_can_be_low() {
    let folder = folder();
    let bytes = two_by_two(BYTES.map(|height| Luma([height])));
    let path = saved(&folder, "grey.png", bytes);
    let map = HeightMap::load(&path, Channel::Grey, true).unwrap();
    assert_eq!(map.heights(), as_words(BYTES.map(|height| 255 - height)));
}

#[test]
fn sizes_that_do_not_fit_come_with_those_that_would() {
    let folder = folder();
    for (width, height, expected) in [
        (48, 48, "32 x 32 or 64 x 64"),
        (
            40,
            33,
            "40 x 33 texels are not a square; crop or scale it to 32 x 32",
        ),
        (8192, 1, "1 to 4096"),
    ] {
        let image = ImageBuffer::<Luma<u8>, _>::new(width, height);
        let path = saved(&folder, "size.png", image);
        let message = refusal(&path, Channel::Grey);
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn files_that_are_no_maps_say_why() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);

    assert!(refusal(&at("nowhere.png"), Channel::Grey).contains("no such file"));
    assert!(refusal(folder.path(), Channel::Grey).contains("cannot be read"));

    fs::write(at("text.txt"), "heights").unwrap();
    assert!(refusal(&at("text.txt"), Channel::Grey).contains("not a PNG, TGA or PGM"));
    // A format whose decoder is not built in.
    fs::write(at("photo.jpg"), [0xff, 0xd8, 0xff, 0xe0]).unwrap();
    assert!(refusal(&at("photo.jpg"), Channel::Grey).contains("not a PNG, TGA or PGM"));

    fs::write(at("empty.tga"), []).unwrap();
    assert!(refusal(&at("empty.tga"), Channel::Alpha).contains("damaged"));
    fs::write(at("short.tga"), &tga(0x28, BYTES)[..30]).unwrap();
    assert!(refusal(&at("short.tga"), Channel::Alpha).contains("damaged"));

    fs::write(at("dark.pgm"), "P2\n1 1\n15\n15\n").unwrap();
    assert!(refusal(&at("dark.pgm"), Channel::Grey).contains("declared as 15"));
    fs::write(at("bits.pbm"), "P1\n1 1\n1\n").unwrap();
    assert!(refusal(&at("bits.pbm"), Channel::Grey).contains("declared as 1;"));
}

#[test]
fn the_content_decides_the_format_not_the_name() {
    let folder = folder();
    let image = two_by_two(BYTES.map(|height| Luma([height])));
    let png = saved(&folder, "map.png", image);
    let misnamed = folder.path().join("map.tga");
    fs::rename(png, &misnamed).unwrap();
    assert_eq!(loaded(&misnamed, Channel::Grey).heights(), as_words(BYTES));
}

#[test]
fn channels_are_read_from_their_names() {
    assert_eq!("alpha".parse(), Ok(Channel::Alpha));
    assert_eq!("red".parse(), Ok(Channel::Red));
    assert_eq!("grey".parse(), Ok(Channel::Grey));
    assert!(matches!(
        "blue".parse::<Channel>(),
        Err(MapError::UnknownChannel { .. })
    ));
}

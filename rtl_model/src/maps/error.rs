//! What can be wrong with a height map, and what helps.

use std::path::PathBuf;

use thiserror::Error;

use super::{MAX_SIZE, Pattern};

/// Why there is no height map. Each message names the file or the text, and the way out.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MapError {
    /// No such file.
    #[error(
        "height map {path}: no such file; check the path, or name a map that needs none, such as \
         procedural:rocks:256:1"
    )]
    Missing {
        /// The file.
        path: PathBuf,
    },
    /// The file is there and cannot be read.
    #[error("height map {path}: cannot be read ({cause})")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the operating system says.
        cause: String,
    },
    /// Neither the content nor the name tells a format that is read.
    #[error("height map {path}: not a PNG, TGA or PGM file; convert it to one of these")]
    UnknownFormat {
        /// The file.
        path: PathBuf,
    },
    /// The file's content does not decode.
    #[error("height map {path}: damaged or not supported ({cause}); write it anew as PNG")]
    Undecodable {
        /// The file.
        path: PathBuf,
        /// What the decoder says.
        cause: String,
    },
    /// A PGM whose samples end at another value than 8 or 16 bits do.
    #[error(
        "height map {path}: its greatest sample is declared as {maximum}; rescale it to 255 (8 bits) \
         or 65535 (16 bits)"
    )]
    SampleRange {
        /// The file.
        path: PathBuf,
        /// The value the header declares.
        maximum: u32,
    },
    /// A map that is not a square.
    #[error(
        "height map {name}: {width} x {height} texels are not a square; crop or scale it to \
         {fitting} x {fitting}"
    )]
    NotSquare {
        /// The file, or the name given.
        name: String,
        /// Columns found.
        width: u32,
        /// Rows found.
        height: u32,
        /// The largest fitting size that can be cropped from it.
        fitting: u32,
    },
    /// A square whose side is not a power of two.
    #[error(
        "height map {name}: {size} x {size} texels, and {size} is not a power of two; scale it to \
         {below} x {below} or {above} x {above}"
    )]
    NotPowerOfTwo {
        /// The file, or the name given.
        name: String,
        /// Texels on a side found.
        size: u32,
        /// The nearest fitting size below.
        below: u32,
        /// The nearest fitting size above.
        above: u32,
    },
    /// A side outside 1 to [`MAX_SIZE`].
    #[error("height map {name}: {size} texels on a side; 1 to {MAX_SIZE} are supported")]
    SizeOutOfRange {
        /// The file, or the name given.
        name: String,
        /// Texels on a side found.
        size: u64,
    },
    /// A larger map is asked for that would be smaller.
    #[error(
        "height map {name}: it has {size} texels on a side already and cannot become one of {wanted}; \
         ask for {size} or more"
    )]
    NotLarger {
        /// The map.
        name: String,
        /// Its texels on a side.
        size: u32,
        /// Those asked for.
        wanted: u32,
    },
    /// Not one height for each texel.
    #[error("height map {name}: {found} heights for {size} x {size} texels; give one for each")]
    HeightCount {
        /// The name given.
        name: String,
        /// Texels on a side.
        size: u32,
        /// Heights given.
        found: usize,
    },
    /// A height that does not fit the bits.
    #[error("height map {name}: height {height} at texel ({i}, {j}) does not fit {bits} bits")]
    HeightOutOfRange {
        /// The name given.
        name: String,
        /// The height found.
        height: u16,
        /// Column of its texel.
        i: u32,
        /// Row of its texel.
        j: u32,
        /// Bits of a height of this map.
        bits: u32,
    },
    /// Bits of a height other than 8 or 16.
    #[error("height map {name}: heights of {bits} bits; they have 8 or 16")]
    UnsupportedBits {
        /// The name given.
        name: String,
        /// Bits asked for.
        bits: u32,
    },
    /// The alpha channel of a file that has none.
    #[error(
        "height map {path}: it has no alpha channel; use the channel grey or red (`--channel grey`, \
         or `channel = \"grey\"` in the scene)"
    )]
    NoAlpha {
        /// The file.
        path: PathBuf,
    },
    /// The grey channel of a file in colour.
    #[error(
        "height map {path}: it is in colour, texel ({i}, {j}) is ({red}, {green}, {blue}), so there \
         is no one grey; use {channels} (`--channel red`, or `channel = \"red\"` in the scene)"
    )]
    NotGrey {
        /// The file.
        path: PathBuf,
        /// Column of the first texel that is not grey.
        i: u32,
        /// Its row.
        j: u32,
        /// Its red.
        red: u16,
        /// Its green.
        green: u16,
        /// Its blue.
        blue: u16,
        /// The channels that would do, in words.
        channels: &'static str,
    },
    /// A channel that does not exist.
    #[error("unknown channel `{text}`: it is one of alpha, red, grey")]
    UnknownChannel {
        /// The text found.
        text: String,
    },
    /// A text that starts like a recipe and is none.
    #[error(
        "`{text}`: a procedural map is written procedural:NAME:SIZE:SEED, such as \
         procedural:rocks:256:1"
    )]
    ProceduralSyntax {
        /// The text found.
        text: String,
    },
    /// A recipe's name that does not exist.
    #[error(
        "`{text}`: no procedural map is called `{name}`; there are {}",
        Pattern::list()
    )]
    UnknownPattern {
        /// The text found.
        text: String,
        /// The name in it.
        name: String,
    },
    /// A recipe's size or seed that is not a number.
    #[error("`{text}`: `{found}` is not a {part}; it is a whole number {range}")]
    ProceduralNumber {
        /// The text found.
        text: String,
        /// The part of it that is wrong.
        found: String,
        /// `size` or `seed`.
        part: &'static str,
        /// The numbers that would do, in words.
        range: &'static str,
    },
    /// An empty text where a map should be named.
    #[error("no height map is named: give a file or procedural:NAME:SIZE:SEED")]
    NoName,
}

//! Height maps from files.

use std::fs;
use std::io::{self, Cursor};
use std::path::Path;
use std::str::FromStr;

use image::codecs::png::PngDecoder;
use image::codecs::pnm::PnmDecoder;
use image::codecs::tga::TgaDecoder;
use image::{DynamicImage, ImageBuffer, ImageDecoder, ImageFormat, ImageResult, Rgba};
use serde::Deserialize;

use super::height_map::check_size;
use super::{HeightMap, MapError};

/// Which part of an image is the height.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize)]
#[serde(try_from = "String")]
pub enum Channel {
    /// The alpha channel, which the file must have.
    Alpha,
    /// The red channel; of a grey image its grey.
    Red,
    /// The grey of the image, which must have red, green and blue alike in every texel: a colour has
    /// no one grey, and a weighting nobody asked for would make wrong heights. Alpha is ignored.
    #[default]
    Grey,
}

impl FromStr for Channel {
    type Err = MapError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "alpha" => Ok(Channel::Alpha),
            "red" => Ok(Channel::Red),
            "grey" => Ok(Channel::Grey),
            _ => Err(MapError::UnknownChannel {
                text: text.to_owned(),
            }),
        }
    }
}

impl TryFrom<String> for Channel {
    type Error = MapError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

/// Reads a map in which white is high.
pub(super) fn load(path: &Path, channel: Channel) -> Result<HeightMap, MapError> {
    let content = fs::read(path).map_err(|error| {
        let path = path.to_owned();
        match error.kind() {
            io::ErrorKind::NotFound => MapError::Missing { path },
            _ => MapError::Unreadable {
                path,
                cause: error.to_string(),
            },
        }
    })?;
    let image = decode(path, &content)?;
    let (width, _) = (image.width(), image.height());
    let name = path.file_stem().map_or_else(
        || path.display().to_string(),
        |stem| stem.to_string_lossy().into_owned(),
    );
    let has_alpha = image.color().has_alpha();
    if channel == Channel::Alpha && !has_alpha {
        return Err(MapError::NoAlpha {
            path: path.to_owned(),
        });
    }
    let channel_count = image.color().channel_count();
    let wide = u32::from(image.color().bytes_per_pixel()) / u32::from(channel_count) > 1;
    // Both conversions repeat a grey into red, green and blue, and change no sample.
    let (bits, heights) = if wide {
        (16, extract(path, channel, has_alpha, &image.into_rgba16())?)
    } else {
        (8, extract(path, channel, has_alpha, &image.into_rgba8())?)
    };
    HeightMap::new(&name, width, bits, heights)
}

/// Decodes a file's content, once its size is known to be that of a map.
fn decode(path: &Path, content: &[u8]) -> Result<DynamicImage, MapError> {
    let undecodable = |error: image::ImageError| MapError::Undecodable {
        path: path.to_owned(),
        cause: error.to_string(),
    };
    let ends_in_tga = path
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("tga"));
    let format = match image::guess_format(content) {
        Ok(format) => Some(format),
        Err(_) if ends_in_tga => Some(ImageFormat::Tga),
        Err(_) => None,
    };
    let reader = Cursor::new(content);
    let image: ImageResult<DynamicImage> = match format {
        Some(ImageFormat::Png) => {
            let decoder = PngDecoder::new(reader).map_err(undecodable)?;
            check_dimensions(path, &decoder)?;
            DynamicImage::from_decoder(decoder)
        }
        Some(ImageFormat::Pnm) => {
            let decoder = PnmDecoder::new(reader).map_err(undecodable)?;
            check_dimensions(path, &decoder)?;
            // The decoder hands out samples as they stand, whatever the declared maximum.
            let maximum = decoder.header().maximal_sample();
            if maximum != 255 && maximum != 65_535 {
                return Err(MapError::SampleRange {
                    path: path.to_owned(),
                    maximum,
                });
            }
            DynamicImage::from_decoder(decoder)
        }
        Some(ImageFormat::Tga) => {
            let decoder = TgaDecoder::new(reader).map_err(undecodable)?;
            check_dimensions(path, &decoder)?;
            DynamicImage::from_decoder(decoder)
        }
        _ => {
            return Err(MapError::UnknownFormat {
                path: path.to_owned(),
            });
        }
    };
    image.map_err(undecodable)
}

fn check_dimensions(path: &Path, decoder: &impl ImageDecoder) -> Result<(), MapError> {
    let (width, height) = decoder.dimensions();
    check_size(&path.display().to_string(), width, height)
}

/// The samples of one channel, row by row.
fn extract<Sample>(
    path: &Path,
    channel: Channel,
    has_alpha: bool,
    image: &ImageBuffer<Rgba<Sample>, Vec<Sample>>,
) -> Result<Vec<u16>, MapError>
where
    Sample: Copy + PartialEq + Into<u16>,
    Rgba<Sample>: image::Pixel<Subpixel = Sample>,
{
    let coloured = image
        .enumerate_pixels()
        .find(|(_, _, Rgba([red, green, blue, _]))| red != green || green != blue);
    if let (Channel::Grey, Some((i, j, &Rgba([red, green, blue, _])))) = (channel, coloured) {
        return Err(MapError::NotGrey {
            path: path.to_owned(),
            i,
            j,
            red: red.into(),
            green: green.into(),
            blue: blue.into(),
            channels: if has_alpha {
                "its red or its alpha channel"
            } else {
                "its red channel"
            },
        });
    }
    let component = if channel == Channel::Alpha { 3 } else { 0 };
    Ok(image
        .pixels()
        .map(|pixel| pixel.0[component].into())
        .collect())
}

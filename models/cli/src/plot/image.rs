//! Small images with indexed colours, as data addresses.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use plotters::style::RGBColor;
use png::{BitDepth, ColorType, Encoder};

/// The image as `data:image/png;base64,..`, from a palette index for each pixel, row by row from the top. The first
/// colour of the palette is transparent.
///
/// # Errors
/// An error of the encoder, such as for an image without pixels.
pub fn data_address(width: usize, palette: &[RGBColor], pixels: &[u8]) -> Result<String, String> {
    let height = pixels.len() / width.max(1);
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, width as u32, height as u32);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    let colours: Vec<u8> = palette.iter().flat_map(|c| [c.0, c.1, c.2]).collect();
    encoder.set_palette(colours);
    encoder.set_trns(&[0_u8][..]);
    let written = encoder
        .write_header()
        .and_then(|mut writer| writer.write_image_data(pixels));
    written.map_err(|error| error.to_string())?;
    Ok(format!("data:image/png;base64,{}", STANDARD.encode(file)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_reads_back() {
        let palette = [RGBColor(255, 255, 255), RGBColor(1, 2, 3)];
        let pixels = [0, 1, 1, 1, 0, 1];
        let address = data_address(3, &palette, &pixels).unwrap();
        let text = address.strip_prefix("data:image/png;base64,").unwrap();
        let file = STANDARD.decode(text).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(file))
            .read_info()
            .unwrap();
        let info = reader.info();
        assert_eq!((info.width, info.height), (3, 2));
        assert_eq!(info.palette.as_deref(), Some(&[255, 255, 255, 1, 2, 3][..]));
        let mut frame = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut frame).unwrap();
        assert_eq!(frame, pixels);
    }

    #[test]
    fn a_picture_without_pixels_is_refused() {
        assert!(data_address(0, &[], &[]).is_err());
    }
}

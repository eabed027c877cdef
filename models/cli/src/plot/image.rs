//! Small images with indexed colours, which replace a rectangle of a picture.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use plotters::element::Rectangle;
use plotters::style::{Color, RGBColor};
use png::{BitDepth, ColorType, Encoder};

use super::canvas::message;
use super::contour::Window;
use super::plane::Chart;
use super::style;

/// Colour of the placeholder of an image; no picture has this colour.
const PLACE: RGBColor = RGBColor(1, 2, 3);

/// Draws the placeholder of an image over a rectangle.
///
/// # Errors
/// An error of the drawing library.
pub fn draw_place(chart: &mut Chart<'_, '_>, window: Window) -> Result<(), String> {
    let Window { x, y } = window;
    let place = Rectangle::new([(x[0], y[0]), (x[1], y[1])], PLACE.filled());
    chart.draw_series([place]).map_err(message).map(drop)
}

/// Replaces the placeholder by the image. The drawing library itself could only draw boxes one by one.
///
/// # Errors
/// A picture without the placeholder.
pub fn put(svg: &str, address: &str) -> Result<String, String> {
    let placed = put_image(svg, address);
    placed.ok_or_else(|| "the picture has no placeholder for the image".to_owned())
}

fn put_image(svg: &str, address: &str) -> Option<String> {
    let mark = format!("fill=\"{}\"", style::hex(PLACE));
    let middle = svg.find(&mark)?;
    let start = svg[..middle].rfind('<')?;
    let end = middle + svg[middle..].find("/>")? + 2;
    let attributes = svg[start..middle].strip_prefix("<rect")?;
    let image = format!(
        "<image{attributes}preserveAspectRatio=\"none\" style=\"image-rendering:pixelated\" href=\"{address}\"/>"
    );
    Some([&svg[..start], &image, &svg[end..]].concat())
}

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

    #[test]
    fn an_image_takes_the_place_of_its_rectangle() {
        let svg = "<svg><rect x=\"1\" width=\"2\" opacity=\"1\" fill=\"#010203\" stroke=\"none\"/><g/></svg>";
        let image = put_image(svg, "data:").unwrap();
        assert!(image.starts_with("<svg><image x=\"1\" width=\"2\" opacity=\"1\" preserve"));
        assert!(image.ends_with("href=\"data:\"/><g/></svg>"));
        assert_eq!(put_image("<svg/>", "data:"), None);
    }
}

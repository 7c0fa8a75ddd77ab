//! GeoTIFF with elevation (OGC 19-008r4), such as the tiles of Copernicus DEM.

use super::elevation_grid::{ElevationGrid, GridPlace};
use crate::error::{Error, Result};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use tiff::decoder::{Decoder, DecodingResult};
use tiff::tags::Tag;

/// What is expected of a file.
const EXPECTED: &str = "one band of elevation in degrees of latitude and longitude, north up \
                        (gdalwarp -t_srs EPSG:4326)";
/// The key for the model of coordinates, and its value for latitude and longitude.
const MODEL_TYPE: (u16, u16) = (1024, 2);
/// The key for what a value stands for, and its value for a post; otherwise, it is an area.
const RASTER_TYPE: (u16, u16) = (1025, 2);

type Reader = Decoder<BufReader<File>>;

/// Returns where the posts of a file are.
///
/// # Errors
/// Returns an error that names the file, and what was expected.
pub(super) fn place_of(path: &Path) -> Result<GridPlace> {
    open(path).map(|(_, place)| place)
}

/// Reads a file.
///
/// # Errors
/// Returns an error that names the file, and what was expected.
pub(super) fn read(path: &Path) -> Result<ElevationGrid> {
    let (mut reader, place) = open(path)?;
    let void_m = reader.get_tag_ascii_string(Tag::GdalNodata).ok();
    let void_m = void_m.and_then(|text| text.trim_matches(['\0', ' ']).parse().ok());
    let image = reader.read_image();
    let posts_m: Vec<f32> = match image.map_err(|e| wrong(path, &e.to_string()))? {
        DecodingResult::F32(posts) => posts,
        DecodingResult::F64(posts) => posts.into_iter().map(|m| m as f32).collect(),
        DecodingResult::I16(posts) => posts.into_iter().map(f32::from).collect(),
        DecodingResult::U16(posts) => posts.into_iter().map(f32::from).collect(),
        DecodingResult::I32(posts) => posts.into_iter().map(|m| m as f32).collect(),
        _ => return Err(wrong(path, "values of a type that elevation does not have")),
    };
    if posts_m.len() != place.rows * place.columns {
        return Err(wrong(path, "more than one band"));
    }
    Ok(ElevationGrid::new(place, posts_m, void_m))
}

fn open(path: &Path) -> Result<(Reader, GridPlace)> {
    let file = File::open(path).map_err(Error::io(path))?;
    let mut reader = Decoder::new(BufReader::new(file)).map_err(|e| wrong(path, &e.to_string()))?;
    let place = place(&mut reader).map_err(|problem| wrong(path, &problem))?;
    Ok((reader, place))
}

fn wrong(path: &Path, problem: &str) -> Error {
    Error::content(path, format!("{problem}; expected {EXPECTED}"))
}

fn place(reader: &mut Reader) -> std::result::Result<GridPlace, String> {
    let (columns, rows) = reader.dimensions().map_err(|e| e.to_string())?;
    let mut numbers = |tag| reader.get_tag_f64_vec(tag).ok();
    let step = numbers(Tag::ModelPixelScaleTag);
    let tie = numbers(Tag::ModelTiepointTag);
    let keys = reader.get_tag_u16_vec(Tag::GeoKeyDirectoryTag);
    let (Some(step), Some(tie), Ok(keys)) = (step, tie, keys) else {
        return Err("no place on the globe".to_owned());
    };
    let (&[column_step_deg, row_step_deg, ..], &[column, row, _, east_deg, north_deg, _]) =
        (&*step, &*tie)
    else {
        return Err("a place that is not understood".to_owned());
    };
    // Four numbers a key: its number, where its value is (0: here), how many, the value.
    let (keys, _) = keys.as_chunks();
    let is_set = |(key, value)| keys.contains(&[key, 0, 1, value]);
    if !is_set(MODEL_TYPE) {
        return Err("coordinates that are not latitude and longitude".to_owned());
    }
    if !(column_step_deg > 0.0 && row_step_deg > 0.0 && rows > 1 && columns > 1) {
        return Err("posts without a distance".to_owned());
    }
    // The tie point is a corner of an area, or a post.
    let centre = if is_set(RASTER_TYPE) { 0.0 } else { 0.5 };
    let place = GridPlace {
        north_deg: north_deg + (row - centre) * row_step_deg,
        west_deg: east_deg + (centre - column) * column_step_deg,
        row_step_deg,
        column_step_deg,
        rows: rows as usize,
        columns: columns as usize,
        reach_steps: 1.0,
    };
    let is_there = place.north_deg.is_finite() && place.west_deg.is_finite();
    is_there
        .then_some(place)
        .ok_or_else(|| "a place that is not understood".to_owned())
}

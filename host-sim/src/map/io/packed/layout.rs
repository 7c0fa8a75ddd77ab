//! The whole of a packed map: header, ways, joins, blocks and index.

use super::encode_block::{encode_block, sealed, sized};
use super::plan_view::Place;
use crate::error::Result;
use crate::files::output::{Staged, stage as stage_file};
use crate::map::fusion::map_row::{MapRow, WayRows};
use crate::map::geometry::grid::GRID_M;
use crate::map::geometry::network::Network;
use crate::map::geometry::road_line::{RoadLine, RoadProblem};
use crate::map::geometry::way_name::{WayDirection, WayName};
use estimator_core::roadmap::Tile;
use estimator_core::roadmap::format::{
    HEADER, INDEX_ENTRIES, INDEX_PAGE, JOIN, MAGIC, MOST_CELLS, VERSION, WAY_HEADER,
};
use std::collections::BTreeSet;
use std::path::Path;

/// Longest name of a way, bytes.
const LONGEST_NAME: usize = 255;

/// A way with its cells numbered.
struct NumberedWay<'r> {
    name: &'r WayName,
    is_single: bool,
    rows: Vec<(i32, &'r MapRow)>,
}

/// A block: its first cell, its last cell and its offset.
type BlockPlace = (i32, i32, u32);

/// A join, by the indices of its ways.
struct JoinPlace {
    at_cell: i32,
    to_way: usize,
    to_cell: i32,
}

/// Writes a packed map to a file that appears when it is committed.
///
/// # Errors
/// Returns the error of the file system.
pub fn stage(path: &Path, packed: &[u8]) -> Result<Staged> {
    stage_file(path, |out| out.write_all(packed))
}

/// Returns the packed form of the maps of some ways, whose names are unique. A way without a name is
/// a single road.
///
/// # Errors
/// Says what of the ways does not fit into the format.
pub fn pack(ways: &[WayRows]) -> std::result::Result<Vec<u8>, String> {
    let single = WayName {
        way: "road".to_owned(),
        direction: WayDirection::Forward,
    };
    let mut numbered = ways
        .iter()
        .filter(|way| !way.rows.is_empty())
        .map(|way| numbered(way, &single))
        .collect::<std::result::Result<Vec<_>, _>>()?;
    // The network sorts its ways by name; joins name them by index.
    numbered.sort_by(|a, b| a.name.cmp(b.name));
    if let Some(twice) = numbered
        .windows(2)
        .find(|pair| pair[0].name == pair[1].name)
    {
        return Err(format!(
            "two maps have the way {}; fuse their runs into one map first",
            twice[0].name
        ));
    }
    let joins = joins(&numbered)?;
    write(&numbered, &joins).ok_or_else(|| "the map is larger than 4 GiB".to_owned())
}

fn numbered<'r>(
    way: &'r WayRows,
    single: &'r WayName,
) -> std::result::Result<NumberedWay<'r>, String> {
    let name = way.name.as_ref().unwrap_or(single);
    if name.way.len() > LONGEST_NAME {
        return Err(format!(
            "the name of way {name} has {} bytes; expected at most {LONGEST_NAME}",
            name.way.len()
        ));
    }
    let rows = way.rows.iter().map(|row| {
        let number = (row.distance_m / GRID_M).round();
        let is_cell = (number * GRID_M - row.distance_m).abs() < 0.01;
        // Far within i32, so that sums of cells cannot overflow.
        if is_cell && number.abs() < 1e9 {
            Ok((number as i32, row))
        } else {
            Err(format!(
                "distance_m of way {name} is {}; expected multiples of {GRID_M} m, as `fuse` writes them",
                row.distance_m
            ))
        }
    });
    Ok(NumberedWay {
        name,
        is_single: way.name.is_none(),
        rows: rows.collect::<std::result::Result<_, _>>()?,
    })
}

/// Returns the joins that leave each way. Their cells are within the cells of the ways.
fn joins(ways: &[NumberedWay<'_>]) -> std::result::Result<Vec<Vec<JoinPlace>>, String> {
    let mut of_ways: Vec<Vec<JoinPlace>> = ways.iter().map(|_| Vec::new()).collect();
    // A way of one cell is no line, and joins nothing.
    let mut lines = Vec::new();
    let mut indices = Vec::new();
    for (index, way) in ways
        .iter()
        .enumerate()
        .filter(|(_, way)| way.rows.len() > 1)
    {
        let line = RoadLine::new(way.rows.iter().map(|(_, row)| row.point()).collect());
        let line = line.map_err(|problem: RoadProblem| format!("way {}: {problem}", way.name))?;
        lines.push((way.name.clone(), line));
        indices.push(index);
    }
    let network = Network::new(lines);
    for (index, leaving) in indices.iter().zip(network.joins().leaving()) {
        // A way may end between two cells.
        let cell = |way: usize, at_m: f64| {
            let rows = &ways[way].rows;
            ((at_m / GRID_M).round() as i32).clamp(rows[0].0, rows[rows.len() - 1].0)
        };
        of_ways[*index].extend(leaving.iter().map(|join| JoinPlace {
            at_cell: cell(*index, join.at_m),
            to_way: indices[join.to_way],
            to_cell: cell(indices[join.to_way], join.to_m),
        }));
    }
    Ok(of_ways)
}

/// Returns the bytes of a map; `None` if an offset does not fit.
fn write(ways: &[NumberedWay<'_>], joins: &[Vec<JoinPlace>]) -> Option<Vec<u8>> {
    let lengths = ways
        .iter()
        .map(|way| WAY_HEADER + way.name.way.len() + 4)
        .collect::<Vec<_>>();
    let way_offsets = offsets(HEADER, &lengths)?;
    let joins_start = HEADER + lengths.iter().sum::<usize>();
    let join_lengths: Vec<usize> = joins.iter().map(|of| of.len() * JOIN).collect();
    let join_offsets = offsets(joins_start, &join_lengths)?;
    let blocks_start = joins_start + join_lengths.iter().sum::<usize>();
    let mut blocks = Vec::new();
    let mut tiles = BTreeSet::new();
    let mut places: Vec<Vec<BlockPlace>> = Vec::new();
    for (way, &offset) in ways.iter().zip(&way_offsets) {
        places.push(blocks_of(
            way,
            offset,
            blocks_start,
            &mut blocks,
            &mut tiles,
        )?);
    }
    let blocks_end = blocks_start + blocks.len();
    let pages = pages(&tiles);

    let mut out = vec![0; HEADER];
    for (i, way) in ways.iter().enumerate() {
        let end = places
            .get(i + 1)
            .map_or(u32::try_from(blocks_end).ok()?, |next| next[0].2);
        out.extend(way_record(
            way,
            &places[i],
            end,
            join_offsets[i],
            joins[i].len(),
        )?);
    }
    for join in joins.iter().flatten() {
        out.extend(join_record(join, &way_offsets, &places));
    }
    out.extend(blocks);
    out.extend(pages.iter().flatten());
    let length = u32::try_from(out.len()).ok()?;
    let numbers = [
        u32::from_le_bytes(MAGIC),
        VERSION,
        length,
        (GRID_M * 1000.0) as u32,
        HEADER as u32,
        u32::try_from(ways.len()).ok()?,
        u32::try_from(blocks_start).ok()?,
        u32::try_from(blocks_end).ok()?,
        u32::try_from(blocks_end).ok()?,
        u32::try_from(pages.len()).ok()?,
    ];
    let mut header: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    header.resize(HEADER - 4, 0);
    out[..HEADER].copy_from_slice(&sealed(header));
    Some(out)
}

/// Returns the offset of each part, the first at `start`.
fn offsets(start: usize, lengths: &[usize]) -> Option<Vec<u32>> {
    let mut next = start;
    lengths
        .iter()
        .map(|length| {
            let here = u32::try_from(next).ok();
            next += length;
            here
        })
        .collect()
}

/// Appends the blocks of a way, and enters their tiles.
fn blocks_of(
    way: &NumberedWay<'_>,
    way_offset: u32,
    blocks_start: usize,
    blocks: &mut Vec<u8>,
    tiles: &mut BTreeSet<(Tile, u32)>,
) -> Option<Vec<BlockPlace>> {
    let follows = |a: &(i32, &MapRow), b: &(i32, &MapRow)| b.0 == a.0 + 1;
    let alike = |a: &(i32, &MapRow), b: &(i32, &MapRow)| {
        follows(a, b) && a.1.altitude_m.is_some() == b.1.altitude_m.is_some()
    };
    let mut places = Vec::new();
    let mut index = 0;
    for segment in way.rows.chunk_by(alike) {
        for cells in segment.chunks(MOST_CELLS) {
            index += cells.len();
            let last = cells[cells.len() - 1];
            let next = way.rows.get(index).filter(|next| follows(&last, next));
            let offset = u32::try_from(blocks_start + blocks.len()).ok()?;
            let rows: Vec<MapRow> = cells.iter().map(|(_, row)| **row).collect();
            let next = next.map(|(_, row)| *row);
            blocks.extend(encode_block(way_offset, cells[0].0, &rows, next)?);
            tiles.extend(rows.iter().map(|row| {
                let place = Place::of(row);
                let tile = Tile::of(place.latitude_e6 * 10, place.longitude_e6 * 10);
                (tile, offset)
            }));
            places.push((cells[0].0, last.0, offset));
        }
    }
    Some(places)
}

fn way_record(
    way: &NumberedWay<'_>,
    places: &[BlockPlace],
    end: u32,
    first_join: u32,
    joins: usize,
) -> Option<Vec<u8>> {
    let direction = match (way.is_single, way.name.direction) {
        (true, _) => 2,
        (false, WayDirection::Forward) => 0,
        (false, WayDirection::Backward) => 1,
    };
    let mut out = vec![0, 0, direction, u8::try_from(way.name.way.len()).ok()?];
    out.extend(way.rows[0].0.to_le_bytes());
    out.extend(way.rows[way.rows.len() - 1].0.to_le_bytes());
    out.extend(places[0].2.to_le_bytes());
    out.extend(end.to_le_bytes());
    out.extend(first_join.to_le_bytes());
    out.extend(u32::try_from(joins).ok()?.to_le_bytes());
    out.extend(way.name.way.as_bytes());
    sized(out)
}

fn join_record(join: &JoinPlace, ways: &[u32], places: &[Vec<BlockPlace>]) -> Vec<u8> {
    let of_way = &places[join.to_way];
    let block = of_way.partition_point(|place| place.1 < join.to_cell);
    let mut out = Vec::with_capacity(JOIN);
    out.extend(join.at_cell.to_le_bytes());
    out.extend(ways[join.to_way].to_le_bytes());
    out.extend(join.to_cell.to_le_bytes());
    out.extend(of_way[block.min(of_way.len() - 1)].2.to_le_bytes());
    sealed(out)
}

fn pages(tiles: &BTreeSet<(Tile, u32)>) -> Vec<Vec<u8>> {
    let entries: Vec<_> = tiles.iter().collect();
    entries
        .chunks(INDEX_ENTRIES)
        .map(|entries| {
            let mut page: Vec<u8> = entries
                .iter()
                .flat_map(|(tile, offset)| [tile.key(), *offset])
                .flat_map(u32::to_le_bytes)
                .collect();
            page.resize(INDEX_PAGE - 8, 0);
            page.extend((entries.len() as u32).to_le_bytes());
            sealed(page)
        })
        .collect()
}

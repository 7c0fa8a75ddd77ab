//! Names of SRTM tiles, which tell their place.

/// The south-western corner of a tile, deg.
pub(super) type Corner = (i8, i16);

/// Returns the corner of a name in capitals, such as `N59E017.HGT` or `S34W071.SRTMGL1.HGT.ZIP`.
pub(super) fn corner_of(name: &str) -> Option<Corner> {
    let (place, rest) = name.split_at_checked(7)?;
    let is_tile = rest.starts_with('.')
        && [".HGT", ".HGT.GZ", ".HGT.ZIP"]
            .iter()
            .any(|end| rest.ends_with(end));
    let number = |at: usize, end: usize| place.get(at..end)?.parse::<i16>().ok();
    let latitude = i8::try_from(number(1, 3)?).ok()?;
    let longitude = number(4, 7)?;
    let latitude = match place.get(..1)? {
        "N" => latitude,
        "S" => -latitude,
        _ => return None,
    };
    let longitude = match place.get(3..4)? {
        "E" => longitude,
        "W" => -longitude,
        _ => return None,
    };
    is_tile.then_some((latitude, longitude))
}

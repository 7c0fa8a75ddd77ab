//! Random damage of bytes and text.

use rand::{Rng, RngExt};
use rand_chacha::ChaCha8Rng;

/// Numbers and words that do not belong where they are put.
pub const WORDS: [&str; 16] = [
    "1e308",
    "-1e308",
    "NaN",
    "inf",
    "-inf",
    "1e-320",
    "-0",
    "",
    "9223372036854775808",
    "-1",
    "0x10",
    "1e9",
    "\"",
    "\u{1b}[2J",
    "1,1",
    "99999999",
];

/// Draws one of several values.
///
/// # Panics
///
/// Panics if there are none.
#[must_use]
pub fn pick<'a, T>(from: &'a [T], random: &mut impl Rng) -> &'a T {
    &from[random.random_range(0..from.len())]
}

/// Damages bytes or text.
pub fn damage_bytes(content: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let length = content.len().max(1);
    let at = random.random_range(0..length);
    // Gentle damage is what gets beyond the readers.
    if random.random_bool(0.3) {
        return change_a_digit(content, at, random);
    }
    match random.random_range(0..13) {
        0..3 => {
            for _ in 0..random.random_range(1..8) {
                let bit = random.random_range(0..8 * length);
                if let Some(byte) = content.get_mut(bit / 8) {
                    *byte ^= 1 << (bit % 8);
                }
            }
        }
        3 => content.truncate(at),
        4 => {
            let end = (at + random.random_range(1..2_000)).min(content.len());
            drop(content.drain(at.min(end)..end));
        }
        5 => {
            let end = (at + random.random_range(1..2_000)).min(content.len());
            let block = content[at.min(end)..end].to_vec();
            content.splice(at.min(end)..at.min(end), block);
        }
        6..9 => replace_number(content, at, random),
        9 => swap_columns(content, random),
        10 => content.clear(),
        11 => {
            let noise: Vec<u8> = (0..random.random_range(1..5_000))
                .map(|_| random.random())
                .collect();
            content.splice(at.min(content.len())..at.min(content.len()), noise);
        }
        _ => {
            let open = [b'[', b'{', b'"', b'('][random.random_range(0..4)];
            let nest = vec![open; random.random_range(1..200_000)];
            content.splice(at.min(content.len())..at.min(content.len()), nest);
        }
    }
}

/// Puts a word in place of the number at or behind a place.
fn replace_number(content: &mut Vec<u8>, at: usize, random: &mut ChaCha8Rng) {
    let is_digit = |byte: &u8| byte.is_ascii_digit() || b".-+".contains(byte);
    let Some(begin) = content.iter().skip(at).position(is_digit) else {
        return;
    };
    let begin = at + begin;
    let length = content[begin..]
        .iter()
        .take_while(|byte| is_digit(byte))
        .count();
    let word = pick(&WORDS, random);
    content.splice(begin..begin + length, word.bytes());
}

/// Changes the digit at or behind a place: most often still a number that is possible.
fn change_a_digit(content: &mut [u8], at: usize, random: &mut ChaCha8Rng) {
    let digit = content
        .iter_mut()
        .skip(at)
        .find(|byte| byte.is_ascii_digit());
    if let Some(digit) = digit {
        *digit = random.random_range(b'0'..=b'9');
    }
}

/// Swaps two columns of a table in all rows.
fn swap_columns(content: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let (a, b) = (random.random_range(0..8), random.random_range(0..8));
    let swapped = content.split(|byte| *byte == b'\n').map(|line| {
        let mut fields: Vec<&[u8]> = line.split(|byte| *byte == b',').collect();
        if a < fields.len() && b < fields.len() && line.first() != Some(&b'#') {
            fields.swap(a, b);
        }
        fields.join(&b","[..])
    });
    let header = content
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default()
        .to_vec();
    let mut rows: Vec<Vec<u8>> = swapped.collect();
    rows[0] = header;
    *content = rows.join(&b"\n"[..]);
}

//! Damages the content of a file at random.

use super::commands::{WORDS, pick};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

/// Damages a file.
pub fn damage(content: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let length = content.len().max(1);
    let at = random.random_range(0..length);
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

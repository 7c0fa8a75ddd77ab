//! Names that are spelt like another one, for messages about misspelt names.

/// Returns up to three of `known`, those that are spelt most like `name` first. Case does not count.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let name = name.to_lowercase();
    let mut known: Vec<&str> = known.into_iter().collect();
    known.sort_by_cached_key(|other| strsim::damerau_levenshtein(&name, &other.to_lowercase()));
    known.truncate(3);
    known
}

/// Returns the same as words: "`a`, `b` or `c`".
pub fn nearest_in_words<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = nearest(name, known)
        .iter()
        .map(|other| format!("`{other}`"))
        .collect();
    match quoted.split_last() {
        Some((last, first)) if !first.is_empty() => format!("{} or {last}", first.join(", ")),
        Some((last, _)) => last.clone(),
        None => "none: there are none".to_owned(),
    }
}

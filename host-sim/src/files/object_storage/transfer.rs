//! Objects to files and files to objects, in pieces: memory does not depend on their size.

use super::address::ObjectUrl;
use super::client::{connect, within};
use super::expected::Expected;
use super::problem::{is_unconditional, problem_of};
use crate::error::{Error, Result};
use futures_util::{StreamExt, TryStreamExt, stream};
use object_store::aws::AmazonS3;
use object_store::multipart::MultipartStore;
use object_store::{
    GetOptions, GetRange, ObjectStore, ObjectStoreExt, PutMode, PutOptions, PutPayload,
};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{Read, Write};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Bytes of a piece. A server takes at least 5 MiB, ...
const PIECE: u64 = 8 << 20;
/// ... and at most 10,000 pieces of an object.
const MOST_PIECES: u64 = 10_000;
/// Bytes of an object that is sent at once where the server has to look at what it replaces: that
/// is not possible in pieces.
const MOST_AT_ONCE: u64 = 64 << 20;
/// Pieces that are sent at once.
const AT_ONCE: usize = 3;

/// Time that a signal leaves to take back what was sent.
const LAST_TIME: Duration = Duration::from_secs(3);

/// Objects of which some pieces have arrived, with the names that the server gave to the sendings.
static BEGUN: Mutex<BTreeMap<String, ObjectUrl>> = Mutex::new(BTreeMap::new());

fn begun() -> MutexGuard<'static, BTreeMap<String, ObjectUrl>> {
    BEGUN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes back pieces that have arrived, before a signal ends the program: they would stay, and be
/// paid for.
pub(super) fn take_back() {
    let begun = std::mem::take(&mut *begun());
    if begun.is_empty() {
        return;
    }
    within(LAST_TIME, async {
        for (id, url) in begun {
            if let Ok(store) = connect(&url.bucket) {
                let _ = store.abort_multipart(&url.key, &id).await;
            }
        }
    });
}

/// Copies an object to a file. `progress` gets the bytes of each piece.
pub(super) async fn fetch(
    store: &AmazonS3,
    url: &ObjectUrl,
    (size, e_tag): (u64, Option<&str>),
    path: &Path,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<()> {
    let folder = path.parent().unwrap_or(path);
    let at = |error| url.error(format!("cannot be kept in TMPDIR: {error}"));
    fs::create_dir_all(folder).map_err(at)?;
    let mut file = File::create(path).map_err(at)?;
    let mut start = 0;
    while start < size {
        let end = size.min(start + PIECE);
        let options = GetOptions {
            range: Some(GetRange::Bounded(start..end)),
            // All pieces are of the same object.
            if_match: e_tag.map(str::to_owned),
            ..GetOptions::default()
        };
        let piece = async { store.get_opts(&url.key, options).await?.bytes().await };
        let piece = piece.await.map_err(|error| problem_of(url, &error))?;
        file.write_all(&piece).map_err(at)?;
        progress(piece.len() as u64);
        start = end;
    }
    Ok(())
}

/// Returns the size of a file that takes more than one piece.
pub(super) fn size_if_large(path: &Path) -> Option<u64> {
    let size = fs::metadata(path).ok()?.len();
    (size > PIECE).then_some(size)
}

/// Copies a file to an object, which appears when all of it has arrived. Returns the tag of the
/// object. What it replaces must be what `expected` says; for a large object that is looked at
/// before its first piece and before its last word. `progress` gets the bytes of each piece.
pub(super) async fn send(
    store: &AmazonS3,
    url: &ObjectUrl,
    path: &Path,
    expected: &Expected,
    progress: &dyn Fn(u64),
) -> Result<Option<String>> {
    let mut file = File::open(path).map_err(Error::io(path))?;
    let size = file.metadata().map_err(Error::io(path))?.len();
    let most = if *expected == Expected::Anything {
        PIECE
    } else {
        MOST_AT_ONCE
    };
    if size > most {
        expected.look(store, url).await?;
        return send_in_pieces(store, url, path, (&mut file, size), expected, progress).await;
    }
    let mut content = Vec::new();
    file.read_to_end(&mut content).map_err(Error::io(path))?;
    let e_tag = send_at_once(store, url, content.into(), expected).await?;
    progress(size);
    Ok(e_tag)
}

/// Sends content that the server takes only in place of what is expected.
async fn send_at_once(
    store: &AmazonS3,
    url: &ObjectUrl,
    payload: PutPayload,
    expected: &Expected,
) -> Result<Option<String>> {
    let put = async |mode| {
        let put = store.put_opts(&url.key, payload.clone(), PutOptions::from(mode));
        put.await.map(|put| put.e_tag)
    };
    let error = match put(expected.mode()).await {
        Ok(e_tag) => return Ok(e_tag),
        Err(error) => error,
    };
    if *expected == Expected::Anything {
        return Err(problem_of(url, &error));
    }
    if is_unconditional(&error) {
        expected.look(store, url).await?;
        let put = put(PutMode::Overwrite).await;
        return put.map_err(|error| problem_of(url, &error));
    }
    // The server may have done it, and its reply got lost.
    if let Ok(found) = store.get(&url.key).await {
        let e_tag = found.meta.e_tag.clone();
        let is_sent = |found| payload.iter().flatten().eq(&found);
        if found.bytes().await.is_ok_and(is_sent) {
            return Ok(e_tag);
        }
    }
    Err(problem_of(url, &error))
}

async fn send_in_pieces(
    store: &AmazonS3,
    url: &ObjectUrl,
    path: &Path,
    (file, size): (&mut File, u64),
    expected: &Expected,
    progress: &dyn Fn(u64),
) -> Result<Option<String>> {
    let wrong = |error| problem_of(url, &error);
    let id = store.create_multipart(&url.key).await.map_err(wrong)?;
    let piece_bytes = PIECE.max(size.div_ceil(MOST_PIECES));
    let count = usize::try_from(size.div_ceil(piece_bytes)).unwrap_or(usize::MAX);
    begun().insert(id.clone(), url.clone());
    let (key, id) = (&url.key, &id);
    let sent = async {
        let pieces = (0..count).map(|number| {
            let mut piece = Vec::new();
            let read = Read::by_ref(file).take(piece_bytes).read_to_end(&mut piece);
            async move {
                let bytes = read.map_err(Error::io(path))?;
                let payload = PutPayload::from(piece);
                let put = store.put_part(key, id, number, payload).await;
                progress(bytes as u64);
                put.map_err(wrong)
            }
        });
        let pieces = stream::iter(pieces).buffered(AT_ONCE);
        let pieces = pieces.try_collect().await?;
        expected.look(store, url).await?;
        store
            .complete_multipart(key, id, pieces)
            .await
            .map_err(wrong)
    };
    let sent: Result<_> = sent.await;
    if sent.is_err() {
        // As above. If this fails too, the first error says why.
        let _ = store.abort_multipart(key, id).await;
    }
    begun().remove(id);
    Ok(sent?.e_tag)
}

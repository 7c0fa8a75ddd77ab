//! The folder where objects are files.

use super::address::ObjectUrl;
use super::client::Client;
use super::expected::Expected;
use super::problem::problem_of;
use super::transfer;
use crate::error::{Error, Result};
use crate::files::signals;
use crate::files::temporary::{TemporaryFolder, is_temporary};
use futures_util::{StreamExt, TryStreamExt, stream};
use object_store::path::Path as Key;
use object_store::{ObjectMeta, ObjectStore, ObjectStoreExt};
use std::collections::BTreeMap;
use std::env;
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};

/// The storage that is open: commits of files find it here.
static OPEN: RwLock<Option<Arc<Opened>>> = RwLock::new(None);
/// Objects that are brought at once.
const AT_ONCE: usize = 8;

/// What an address stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// One object.
    Object,
    /// One object that need not exist.
    Maybe,
    /// The same, to be replaced: no other program may do so in between.
    ToReplace,
    /// One object, or all objects below it whose names end so, without a dot. Names that begin with
    /// `.` or `_` are no data.
    Below(&'static [&'static str]),
}

/// An object that was found.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Object {
    url: ObjectUrl,
    /// Its size, bytes.
    pub size: u64,
    e_tag: Option<String>,
}

/// Begins to show progress over so many bytes. What it returns gets the bytes of each piece.
pub type Progress = fn(u64) -> Box<dyn Fn(u64)>;

/// Object storage, open until it is dropped.
#[derive(Debug)]
pub struct ObjectStorage(Arc<Opened>);

#[derive(Debug)]
struct Opened {
    folder: TemporaryFolder,
    client: Client,
    /// Objects that are read and then replaced.
    read: Mutex<BTreeMap<ObjectUrl, Expected>>,
    /// Shows how much of a large object has been sent.
    progress: Progress,
}

impl ObjectStorage {
    /// Opens it, with the credentials of the environment. Nothing is connected yet. `progress` shows
    /// how much of a large object has been sent.
    ///
    /// # Errors
    /// Returns the error of the file system.
    pub fn open(progress: Progress) -> Result<Self> {
        let near = env::temp_dir();
        let opened = Arc::new(Opened {
            folder: TemporaryFolder::create_in(&near).map_err(Error::io(&near))?,
            client: Client::new()?,
            read: Mutex::default(),
            progress,
        });
        signals::before_end(transfer::take_back);
        *OPEN.write().unwrap_or_else(PoisonError::into_inner) = Some(Arc::clone(&opened));
        Ok(Self(opened))
    }

    /// Returns the folder of the files: each is at BUCKET/KEY.
    #[must_use]
    pub fn folder(&self) -> &Path {
        self.0.folder.path()
    }

    /// Returns the path of the file of an object.
    #[must_use]
    pub fn path_of(&self, url: &ObjectUrl) -> PathBuf {
        self.0.path_of(url)
    }

    /// Finds objects.
    ///
    /// # Errors
    /// Returns an error that names the address if nothing is there, or the server cannot be asked.
    pub fn find(&self, url: &ObjectUrl, wanted: Wanted) -> Result<Vec<Object>> {
        self.0.find(url, wanted)
    }

    /// Copies objects to their files. `progress` gets the bytes of each piece.
    ///
    /// # Errors
    /// Returns an error that names the object.
    pub fn fetch(&self, objects: &[Object], progress: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let opened = &*self.0;
        opened.client.wait(async {
            let fetches = objects.iter().map(|object| opened.fetch(object, progress));
            let fetches = stream::iter(fetches).buffer_unordered(AT_ONCE);
            fetches.try_collect().await
        })
    }
}

impl Drop for ObjectStorage {
    fn drop(&mut self) {
        *OPEN.write().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

/// Sends a file that is complete, if it stands for an object. Other files stay as they are.
///
/// # Errors
/// Returns an error that names the object; it is then unchanged.
pub fn send(path: &Path) -> Result<()> {
    on_object(path, Opened::send)
}

/// Brings the object that a file stands for, if there is one and the file is not there yet.
///
/// # Errors
/// Returns an error that names the object.
pub fn bring(path: &Path) -> Result<()> {
    on_object(path, |opened, url| {
        if path.exists() {
            return Ok(());
        }
        for object in opened.find(url, Wanted::Maybe)? {
            opened.client.wait(opened.fetch(&object, &|_| ()))?;
        }
        Ok(())
    })
}

/// Calls `work` with the object that a file stands for, if it does.
fn on_object(path: &Path, work: impl FnOnce(&Opened, &ObjectUrl) -> Result<()>) -> Result<()> {
    let opened = OPEN.read().unwrap_or_else(PoisonError::into_inner).clone();
    let Some(opened) = opened else {
        return Ok(());
    };
    opened
        .url_of(path)
        .map_or(Ok(()), |url| work(&opened, &url))
}

impl Opened {
    fn path_of(&self, url: &ObjectUrl) -> PathBuf {
        let parts = url.key.parts();
        let bucket = self.folder.path().join(&url.bucket);
        parts.fold(bucket, |path, part| path.join(part.as_ref()))
    }

    /// Returns the object of a file in the folder; `None` for other files, and for those that
    /// wait under a temporary name.
    fn url_of(&self, path: &Path) -> Option<ObjectUrl> {
        let inside = path.strip_prefix(self.folder.path()).ok()?;
        let mut names = Vec::new();
        for part in inside.components() {
            match part {
                Component::Normal(name) if !is_temporary(Path::new(name)) => {
                    names.push(name.to_str()?);
                }
                _ => return None,
            }
        }
        let (bucket, key) = names.split_first()?;
        Some(ObjectUrl::of_bucket(
            bucket,
            Key::parse(key.join("/")).ok()?,
        ))
    }

    fn find(&self, url: &ObjectUrl, wanted: Wanted) -> Result<Vec<Object>> {
        let store = self.client.bucket(url)?;
        let object = |found: ObjectMeta| Object {
            url: ObjectUrl::of_bucket(&url.bucket, found.location),
            size: found.size,
            e_tag: found.e_tag,
        };
        if !url.is_folder() {
            let head = self.client.wait(store.head(&url.key));
            match (head, wanted) {
                (Ok(found), _) => {
                    let found = object(found);
                    if wanted == Wanted::ToReplace {
                        self.remember(url, Expected::found(found.e_tag.clone()));
                    }
                    return Ok(vec![found]);
                }
                (Err(object_store::Error::NotFound { .. }), Wanted::Maybe) => {
                    return Ok(Vec::new());
                }
                (Err(object_store::Error::NotFound { .. }), Wanted::ToReplace) => {
                    self.remember(url, Expected::Absent);
                    return Ok(Vec::new());
                }
                (Err(object_store::Error::NotFound { .. }), Wanted::Below(_)) => {}
                (Err(error), _) => return Err(problem_of(url, &error)),
            }
        }
        let Wanted::Below(endings) = wanted else {
            return Err(url.error("is a folder; expected an object"));
        };
        let listed = self.client.wait(store.list(Some(&url.key)).try_collect());
        let mut listed: Vec<ObjectMeta> = listed.map_err(|error| problem_of(url, &error))?;
        listed.retain(|found| is_data(&url.key, &found.location, endings));
        if listed.is_empty() {
            let endings = endings.join(" or .");
            return Err(url.error(format!(
                "there is no such object, and none below it ends in .{endings}; expected some"
            )));
        }
        Ok(listed.into_iter().map(object).collect())
    }

    async fn fetch(&self, object: &Object, progress: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let Object { url, size, e_tag } = object;
        let store = self.client.bucket(url)?;
        let what = (*size, e_tag.as_deref());
        transfer::fetch(&store, url, what, &self.path_of(url), progress).await
    }

    /// Sends a file. One that was read before must not have been replaced by another program.
    fn send(&self, url: &ObjectUrl) -> Result<()> {
        let store = self.client.bucket(url)?;
        let path = self.path_of(url);
        let expected = self.read().get(url).cloned().unwrap_or(Expected::Anything);
        let progress = transfer::size_if_large(&path).map(self.progress);
        let arrived = |bytes| {
            if let Some(progress) = &progress {
                progress(bytes);
            }
        };
        let sending = transfer::send(&store, url, &path, &expected, &arrived);
        let e_tag = self.client.wait(sending)?;
        if expected != Expected::Anything {
            self.remember(url, Expected::found(e_tag));
        }
        Ok(())
    }

    /// Remembers what is at the address of an object that will be replaced.
    fn remember(&self, url: &ObjectUrl, expected: Expected) {
        self.read().insert(url.clone(), expected);
    }

    fn read(&self) -> MutexGuard<'_, BTreeMap<ObjectUrl, Expected>> {
        self.read.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Returns whether the object below a folder is one of the wanted.
fn is_data(folder: &Key, object: &Key, endings: &[&str]) -> bool {
    let Some(below) = object.prefix_match(folder) else {
        return false;
    };
    let is_hidden = |name: &str| name.starts_with(['.', '_']);
    let mut names = below.map(|part| part.as_ref().to_owned());
    let ending = object.extension().unwrap_or_default();
    endings.contains(&ending) && !names.any(|name| is_hidden(&name))
}

//! The clients of the buckets, and the runtime that they need.

use super::address::ObjectUrl;
use super::problem::problem_of;
use crate::error::{Error, Result};
use object_store::aws::{AmazonS3, AmazonS3Builder, AmazonS3ConfigKey};
use object_store::{BackoffConfig, ClientConfigKey, RetryConfig};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use tokio::runtime::{Builder, Runtime};

/// Tries of a request after the first one, ...
const RETRIES: usize = 4;
/// ... within this time, after waits from the first to the last of these.
const RETRY_TIME: Duration = Duration::from_secs(60);
const FIRST_WAIT: Duration = Duration::from_millis(200);
const LONGEST_WAIT: Duration = Duration::from_secs(5);
/// Time of one request, which moves a few megabytes, unless the environment has another one.
const REQUEST_TIME: (&str, &str) = ("AWS_TIMEOUT", "120s");

/// The clients of all buckets that a command uses.
#[derive(Debug)]
pub(super) struct Client {
    runtime: Runtime,
    buckets: Mutex<BTreeMap<String, AmazonS3>>,
}

impl Client {
    pub(super) fn new() -> Result<Self> {
        let runtime = Builder::new_current_thread().enable_all().build();
        // Another library in this process may have chosen one already.
        let _ = rustls::crypto::ring::default_provider().install_default();
        Ok(Self {
            runtime: runtime.map_err(Error::io(Path::new("object storage")))?,
            buckets: Mutex::default(),
        })
    }

    /// Waits for work on objects to end. Several threads may wait at once.
    pub(super) fn wait<T>(&self, work: impl Future<Output = T>) -> T {
        self.runtime.block_on(work)
    }

    /// Returns the client of the bucket of an object.
    pub(super) fn bucket(&self, of: &ObjectUrl) -> Result<AmazonS3> {
        let mut buckets = self.buckets.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = buckets.get(&of.bucket) {
            return Ok(known.clone());
        }
        let made = connect(&of.bucket).map_err(|error| problem_of(of, &error))?;
        buckets.insert(of.bucket.clone(), made.clone());
        Ok(made)
    }
}

/// Runs work on objects where no client is at hand, for at most this time. What it has not done by
/// then is left.
pub(super) fn within(time: Duration, work: impl Future<Output = ()>) {
    if let Ok(runtime) = Builder::new_current_thread().enable_all().build() {
        let _ = runtime.block_on(async { tokio::time::timeout(time, work).await });
    }
}

/// Makes a client from the environment. It connects with its first request.
pub(super) fn connect(bucket: &str) -> object_store::Result<AmazonS3> {
    let mut builder = AmazonS3Builder::from_env().with_bucket_name(bucket);
    let (name, time) = REQUEST_TIME;
    if std::env::var_os(name).is_none() {
        builder = builder.with_config(AmazonS3ConfigKey::Client(ClientConfigKey::Timeout), time);
    }
    builder
        .with_retry(RetryConfig {
            backoff: BackoffConfig {
                init_backoff: FIRST_WAIT,
                max_backoff: LONGEST_WAIT,
                ..BackoffConfig::default()
            },
            max_retries: RETRIES,
            retry_timeout: RETRY_TIME,
        })
        .build()
}

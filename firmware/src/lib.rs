//! What the images of several boards share: no estimator logic of its own.
//!
//! * [`exchange`]: the files that an emulated board and a host exchange; builds everywhere;
//! * `replay`: a drive out of such a file through the estimator; only on emulated boards.

#![no_std]
#![warn(missing_docs)]

pub mod exchange;
#[cfg(target_os = "none")]
pub mod replay;

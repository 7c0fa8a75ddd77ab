//! What the images of several boards share: no estimator logic of its own.
//!
//! * [`exchange`]: the files that an emulated board and a host exchange; builds everywhere;
//! * `recorded`: a drive out of such a file; `replay`: it through the estimator; `budget`: what
//!   that costs, counted by `meter`; only on emulated boards;
//! * `alone`: the estimator and next to nothing else, to see what it adds to an image.

#![no_std]
#![warn(missing_docs)]

#[cfg(target_os = "none")]
pub mod alone;
#[cfg(target_os = "none")]
pub mod budget;
pub mod exchange;
#[cfg(target_os = "none")]
pub mod meter;
#[cfg(target_os = "none")]
pub mod recorded;
#[cfg(target_os = "none")]
pub mod replay;

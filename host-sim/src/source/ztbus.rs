//! ZTBus.

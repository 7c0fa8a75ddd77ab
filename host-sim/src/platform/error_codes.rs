//! Codes of errors of the file system.

/// Code of the error for a folder where a file is expected.
pub const IS_FOLDER: i32 = codes::IS_FOLDER;
/// Codes of the errors for too many open files.
pub const OUT_OF_FILES: [i32; 2] = codes::OUT_OF_FILES;

#[cfg(unix)]
mod codes {
    use nix::errno::Errno;

    pub const IS_FOLDER: i32 = Errno::EISDIR as i32;
    /// Of the process and of the machine.
    pub const OUT_OF_FILES: [i32; 2] = [Errno::EMFILE as i32, Errno::ENFILE as i32];
}

#[cfg(windows)]
mod codes {
    /// `ERROR_ACCESS_DENIED`, which files that may not be read have too.
    pub const IS_FOLDER: i32 = 5;
    /// `ERROR_TOO_MANY_OPEN_FILES`, and that of the C library.
    pub const OUT_OF_FILES: [i32; 2] = [4, 24];
}

/// `errno` of WASI preview 1.
#[cfg(not(any(unix, windows)))]
mod codes {
    pub const IS_FOLDER: i32 = 31;
    /// Of the process and of the machine.
    pub const OUT_OF_FILES: [i32; 2] = [33, 41];
}

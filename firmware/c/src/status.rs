//! What a call returns.

/// What became of a call. All but `OK` leave the caller's objects as they are.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub enum Status {
    /// It is done.
    Ok = 0,
    /// There is nothing to return yet.
    Nothing = 1,
    /// A pointer is null.
    Null = 2,
    /// A pointer is not aligned as its type demands.
    Misaligned = 3,
    /// Memory or buffer are too small.
    TooSmall = 4,
    /// No estimator or map was created here, or it was released, moved or overwritten.
    NotCreated = 5,
    /// There is an estimator or map here already. Release it first.
    AlreadyCreated = 6,
    /// The call interrupts another one on the same object.
    Busy = 7,
    /// A parameter of the vehicle is impossible.
    Vehicle = 8,
    /// The bytes are not a packed vehicle of this version.
    PackedVehicle = 9,
    /// The bytes are not a persistent state of this version.
    PersistentState = 10,
    /// The persistent state is that of another vehicle, or of other parameters.
    OtherVehicle = 11,
    /// No CAN frame has this identifier or length.
    Frame = 12,
    /// There is no signal of this number.
    Signal = 13,
    /// The bytes are not a packed map of this version, or are damaged here.
    Map = 14,
    /// A distance or step is not a positive, finite number.
    Distance = 15,
}

/// Returns the status of a result.
pub(crate) fn status(result: Result<(), Status>) -> Status {
    match result {
        Ok(()) => Status::Ok,
        Err(status) => status,
    }
}

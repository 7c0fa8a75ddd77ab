//! A column of numbers in a batch of rows of a Parquet file, of any numeric type.

use arrow_array::types::{
    ArrowPrimitiveType, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type,
    Int64Type, TimestampMicrosecondType, TimestampMillisecondType, TimestampNanosecondType,
    TimestampSecondType, UInt8Type, UInt16Type, UInt32Type,
};
use arrow_array::{Array, ArrayRef, BooleanArray, Decimal128Array, PrimitiveArray, UInt64Array};
use std::any::Any;

/// A column of numbers. Switches are 0 and 1.
pub struct NumberColumn<'a>(Values<'a>);

enum Values<'a> {
    /// The file lacks the column.
    Absent,
    /// Doubles, none of which is missing.
    Plain(&'a [f64]),
    Float(&'a PrimitiveArray<Float64Type>),
    Single(&'a PrimitiveArray<Float32Type>),
    Whole(&'a PrimitiveArray<Int64Type>),
    Short(&'a PrimitiveArray<Int32Type>),
    Switch(&'a BooleanArray),
    /// Those of types that few files have.
    Converted(Vec<Option<f64>>),
}

impl<'a> NumberColumn<'a> {
    /// Returns the column of these values; `None` if they are not numbers.
    pub(super) fn of(values: &'a ArrayRef) -> Option<Self> {
        let any = values.as_any();
        let float = any.downcast_ref().map(Values::float);
        float
            .or_else(|| any.downcast_ref().map(Values::Single))
            .or_else(|| any.downcast_ref().map(Values::Whole))
            .or_else(|| any.downcast_ref().map(Values::Short))
            .or_else(|| any.downcast_ref().map(Values::Switch))
            .or_else(|| Values::converted(any))
            .map(Self)
    }

    /// Returns a column in which all numbers are missing.
    pub(super) const fn absent() -> Self {
        Self(Values::Absent)
    }

    /// Returns the number of a row; `None` if it is missing.
    #[must_use]
    pub fn at(&self, row: usize) -> Option<f64> {
        fn present<T: ArrowPrimitiveType>(
            array: &PrimitiveArray<T>,
            row: usize,
        ) -> Option<T::Native> {
            (!array.is_null(row)).then(|| array.value(row))
        }
        match &self.0 {
            Values::Absent => None,
            Values::Plain(numbers) => Some(numbers[row]),
            Values::Converted(numbers) => numbers[row],
            Values::Float(array) => present(array, row),
            Values::Single(array) => present(array, row).map(f64::from),
            Values::Whole(array) => present(array, row).map(|value| value as f64),
            Values::Short(array) => present(array, row).map(f64::from),
            Values::Switch(array) => (!array.is_null(row)).then(|| f64::from(array.value(row))),
        }
    }

    /// Returns the numbers of all rows if they are doubles and none is missing, as is usual.
    #[must_use]
    pub const fn plain(&self) -> Option<&'a [f64]> {
        match self.0 {
            Values::Plain(numbers) => Some(numbers),
            _ => None,
        }
    }
}

impl<'a> Values<'a> {
    fn converted(any: &dyn Any) -> Option<Self> {
        fn numbers<T: ArrowPrimitiveType>(any: &dyn Any) -> Option<Vec<Option<f64>>>
        where
            f64: From<T::Native>,
        {
            let array = any.downcast_ref::<PrimitiveArray<T>>()?;
            Some(array.iter().map(|value| value.map(f64::from)).collect())
        }
        // A time since 1970, in its unit.
        fn times<T: ArrowPrimitiveType<Native = i64>>(any: &dyn Any) -> Option<Vec<Option<f64>>> {
            let array = any.downcast_ref::<PrimitiveArray<T>>()?;
            let number = |value| value as f64;
            Some(array.iter().map(|value| value.map(number)).collect())
        }
        numbers::<Int8Type>(any)
            .or_else(|| numbers::<Int16Type>(any))
            .or_else(|| numbers::<UInt8Type>(any))
            .or_else(|| numbers::<UInt16Type>(any))
            .or_else(|| numbers::<UInt32Type>(any))
            .or_else(|| numbers::<Float16Type>(any))
            .or_else(|| times::<TimestampNanosecondType>(any))
            .or_else(|| times::<TimestampMicrosecondType>(any))
            .or_else(|| times::<TimestampMillisecondType>(any))
            .or_else(|| times::<TimestampSecondType>(any))
            .or_else(|| {
                let array = any.downcast_ref::<UInt64Array>()?;
                Some(
                    array
                        .iter()
                        .map(|value| value.map(|value| value as f64))
                        .collect(),
                )
            })
            .or_else(|| {
                let array = any.downcast_ref::<Decimal128Array>()?;
                let factor = 10_f64.powi(array.scale().into());
                let number = |value: i128| value as f64 / factor;
                Some(array.iter().map(|value| value.map(number)).collect())
            })
            .map(Self::Converted)
    }

    fn float(array: &'a PrimitiveArray<Float64Type>) -> Self {
        if array.null_count() == 0 {
            Self::Plain(array.values())
        } else {
            Self::Float(array)
        }
    }
}

// SPDX-License-Identifier: BSD-3-Clause
use crate::{sys, text};
use core::fmt;

/// What the library refused: a code below 0, and its text.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Error(pub(crate) i32);

/// What a call gives that can fail.
pub type Result<T, E = Error> = core::result::Result<T, E>;

impl Error {
    /// The code, as `dpt_result`.
    pub const fn code(self) -> i32 {
        self.0
    }

    /// The name of the code, such as `DPT_E_ARGUMENT`.
    pub fn name(self) -> &'static str {
        // SAFETY: any number is allowed, and the text is a constant.
        unsafe { text::of_constant(sys::dpt_result_name(self.0)) }
    }

    /// One line of English.
    pub fn text(self) -> &'static str {
        // SAFETY: as above.
        unsafe { text::of_constant(sys::dpt_result_text(self.0)) }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        to.write_str(self.text())
    }
}

impl fmt::Debug for Error {
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{}: {}", self.name(), self.text())
    }
}

impl core::error::Error for Error {}

/// The version of the library that runs.
pub fn version() -> &'static str {
    // SAFETY: the text is a constant.
    unsafe { text::of_constant(sys::dpt_version()) }
}

pub(crate) fn check(code: sys::dpt_result) -> Result<()> {
    if code == sys::DPT_OK {
        Ok(())
    } else {
        Err(Error(code))
    }
}

/// A length as the library counts.
pub(crate) fn count_of(length: usize) -> Result<u32> {
    u32::try_from(length).map_err(|_| Error::LIMIT)
}

/// How much room an array has: more than the library can count is not used.
pub(crate) fn room_of(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}

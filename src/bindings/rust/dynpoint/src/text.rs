// SPDX-License-Identifier: BSD-3-Clause
use core::ffi::{c_char, CStr};

/// What is before the first zero, and is UTF-8.
fn of_utf8(bytes: &[u8]) -> &str {
    match core::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(end) => core::str::from_utf8(&bytes[..end.valid_up_to()]).unwrap_or(""),
    }
}

#[allow(dead_code)]
pub(crate) fn of_bytes(bytes: &[u8]) -> &str {
    of_utf8(bytes.split(|&byte| byte == 0).next().unwrap_or(&[]))
}

/// # Safety
/// NULL, or a text that ends in zero and never goes.
pub(crate) unsafe fn of_constant(text: *const c_char) -> &'static str {
    if text.is_null() {
        ""
    } else {
        // SAFETY: as above.
        of_utf8(unsafe { CStr::from_ptr(text) }.to_bytes())
    }
}

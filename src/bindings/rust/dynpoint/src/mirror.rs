// SPDX-License-Identifier: BSD-3-Clause
//! What structs of `plain` have in common.

/// It has the layout of the struct of C, and is known to C by its address. `size:` is of one that begins with its size.
macro_rules! mirror {
    ($plain:ident of $raw:ident, $(size: $size:ident,)? fields: $($field:ident)*) => {
        #[allow(dead_code, unused_mut)]
        impl $plain {
            pub(crate) const fn empty() -> Self {
                // SAFETY: all of it is numbers, and pointers that may be null.
                let mut empty: Self = unsafe { core::mem::zeroed() };
                $(empty.$size = core::mem::size_of::<Self>() as u32;)?
                empty
            }

            pub(crate) const fn raw(&self) -> *const sys::$raw {
                (self as *const Self).cast()
            }

            pub(crate) fn raw_mut(&mut self) -> *mut sys::$raw {
                (self as *mut Self).cast()
            }
        }

        const _: () = {
            use core::mem::{align_of, offset_of, size_of};
            assert!(size_of::<$plain>() == size_of::<sys::$raw>());
            assert!(align_of::<$plain>() == align_of::<sys::$raw>());
            $(assert!(offset_of!($plain, $field) == offset_of!(sys::$raw, $field));)*
        };
    };
}

/// All its pointers are null but in a copy that a call makes.
macro_rules! has_null_pointers {
    ($plain:ident) => {
        // SAFETY: as above.
        unsafe impl Send for $plain {}
        // SAFETY: as above.
        unsafe impl Sync for $plain {}
    };
}

/// The library fills in the defaults.
macro_rules! has_defaults {
    ($plain:ident by $defaults:ident) => {
        impl Default for $plain {
            fn default() -> Self {
                let mut def = Self::empty();
                // SAFETY: it writes as many bytes as the struct has.
                unsafe { sys::$defaults(def.raw_mut(), core::mem::size_of::<Self>()) };
                def
            }
        }
    };
}

/// All of it is 0 by default.
macro_rules! is_empty_by_default {
    ($plain:ident) => {
        impl Default for $plain {
            fn default() -> Self {
                Self::empty()
            }
        }
    };
}

/// Characters, as the text before the first zero.
macro_rules! has_text {
    ($plain:ident, $(#[$comment:meta])* $field:ident) => {
        impl $plain {
            $(#[$comment])*
            pub fn $field(&self) -> &str {
                crate::text::of_bytes(&self.$field)
            }
        }
    };
}

/// A method for a field, to write a def or settings in one expression.
macro_rules! has_setters {
    ($plain:ident, $($(#[$comment:meta])* $field:ident: $type:ty),*) => {
        impl $plain {
            $($(#[$comment])*
            #[must_use]
            pub const fn $field(mut self, $field: $type) -> Self {
                self.$field = $field;
                self
            })*
        }
    };
}

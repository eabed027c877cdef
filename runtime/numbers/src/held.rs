//! References to constants, or owned values of forms loaded at run time.
//!
//! No other file of the runtime names a type that owns memory on the heap; this one does so with the feature `std`
//! only. Neither the runtime nor this package makes an owned value.

use core::fmt;
use core::ops::Deref;

/// A reference to a constant, or an owned value that is freed with its owner.
// NOTE: the pointer is at the same offset in both variants, so that a dereference is one load.
pub enum Held<T: ?Sized + 'static> {
    /// A constant.
    Static(&'static T),
    /// An owned value.
    #[cfg(feature = "std")]
    Owned(std::boxed::Box<T>),
}

impl<T: ?Sized> Held<T> {
    /// The value.
    #[inline(always)]
    pub const fn value(&self) -> &T {
        match self {
            Self::Static(value) => value,
            #[cfg(feature = "std")]
            Self::Owned(value) => value,
        }
    }

    /// Another reference to the value of a constant.
    pub const fn again(&'static self) -> Self {
        Self::Static(self.value())
    }
}

// NOTE: these repeat methods of slices, because constants cannot use `Deref`.
impl<T> Held<[T]> {
    /// Number of elements.
    pub const fn len(&self) -> usize {
        self.value().len()
    }

    /// True if there is no element.
    pub const fn is_empty(&self) -> bool {
        self.value().is_empty()
    }
}

impl<T: ?Sized> Deref for Held<T> {
    type Target = T;

    #[inline(always)]
    fn deref(&self) -> &T {
        self.value()
    }
}

impl<'a, T> IntoIterator for &'a Held<[T]> {
    type Item = &'a T;
    type IntoIter = core::slice::Iter<'a, T>;

    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl fmt::Display for Held<str> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<T: ?Sized> From<&'static T> for Held<T> {
    fn from(value: &'static T) -> Self {
        Self::Static(value)
    }
}

#[cfg(feature = "std")]
impl<T: ?Sized> From<std::boxed::Box<T>> for Held<T> {
    fn from(value: std::boxed::Box<T>) -> Self {
        Self::Owned(value)
    }
}

impl<T: ?Sized + fmt::Debug> fmt::Debug for Held<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

impl<T: ?Sized + PartialEq> PartialEq for Held<T> {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

/// A reference to a constant, or a value that is freed with the last of its owners.
pub enum Shared<T: 'static> {
    /// A constant.
    Static(&'static T),
    /// A value with several owners.
    #[cfg(feature = "std")]
    Counted(std::sync::Arc<T>),
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        match self {
            Self::Static(value) => Self::Static(value),
            #[cfg(feature = "std")]
            Self::Counted(value) => Self::Counted(std::sync::Arc::clone(value)),
        }
    }
}

impl<T> Deref for Shared<T> {
    type Target = T;

    #[inline(always)]
    fn deref(&self) -> &T {
        match self {
            Self::Static(value) => value,
            #[cfg(feature = "std")]
            Self::Counted(value) => value,
        }
    }
}

impl<T> From<&'static T> for Shared<T> {
    fn from(value: &'static T) -> Self {
        Self::Static(value)
    }
}

#[cfg(feature = "std")]
impl<T> From<std::sync::Arc<T>> for Shared<T> {
    fn from(value: std::sync::Arc<T>) -> Self {
        Self::Counted(value)
    }
}

impl<T: fmt::Debug> fmt::Debug for Shared<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        (**self).fmt(f)
    }
}

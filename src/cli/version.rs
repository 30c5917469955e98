//! What `-V` and `--version` tell.

use crate::engine::ida::sundials_version;
use crate::record::hdf5_version;
use std::sync::LazyLock;

static SHORT: LazyLock<String> = LazyLock::new(|| {
    let version = env!("CARGO_PKG_VERSION");
    match env!("FREEPLAY_COMMIT") {
        "" => format!("{version} (commit unknown: built without git)"),
        commit => format!("{version} (commit {commit})"),
    }
});

static LONG: LazyLock<String> = LazyLock::new(|| {
    format!("{}\nSUNDIALS {}\nHDF5 {}", *SHORT, sundials_version(), hdf5_version())
});

/// The program's version, and the commit it is built from.
pub(super) fn short() -> &'static str {
    &SHORT
}

/// The same, and the libraries that it runs with, a line each.
pub(super) fn long() -> &'static str {
    &LONG
}

#!/usr/bin/env bash
# Checks everything: format, lints, documentation, all tests. Sets up what that needs.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

# without its recommended packages Octave has nothing to draw with: gnuplot draws, in FreeSans, and
# ghostscript makes the PNG of it
need_packages "${BUILD_PACKAGES[@]}" hdf5-tools netcdf-bin octave octave-netcdf \
    gnuplot-nox fonts-freefont-otf ghostscript parallel python3-venv chromium
need_rust rustfmt clippy
need_python
need_browser_driver

# The tests run even where a check before them complains, and are the last to speak.
failed=()
cargo fmt --check || failed+=("cargo fmt")
cargo clippy --locked --release --all-targets -- -D warnings || failed+=("cargo clippy")
RUSTDOCFLAGS="-D warnings" cargo doc --locked --release --no-deps || failed+=("cargo doc")
cargo test --locked --release --no-fail-fast || failed+=("cargo test")
if [ ${#failed[@]} -gt 0 ]; then
    (IFS=,; echo "failed: ${failed[*]}" >&2)
    exit 1
fi

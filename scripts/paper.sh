#!/usr/bin/env bash
# Runs the paper's four cases at the paper's tolerances into out/paper, and prints how the largest
# force in joint A compares with the paper's claim. Sets up what that needs.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

need_packages "${BUILD_PACKAGES[@]}" python3-venv
need_rust
need_python

cargo build --locked --release
mkdir -p out/paper
for case in four-bar-ideal four-bar-a four-bar-b four-bar-c; do
    ./target/release/freeplay run "cases/$case.toml" -o "out/paper/$case.h5" --force
done
echo
.venv/bin/python scripts/paper_table.py out/paper

#!/usr/bin/env bash
# Compares all laws of contact and friction on case a and on a slider-crank with clearance at the wrist
# pin: one law changed at a time, five revolutions each. Result files and two tables in out/laws.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

need_packages "${BUILD_PACKAGES[@]}"
need_rust
cargo build --locked --release
python3 scripts/laws.py target/release/freeplay out/laws "$@"

#!/usr/bin/env bash
# Attacks freeplay with changed case files, changes from the command line and result files, and kills
# runs at random moments.
#
#   ./scripts/survive.sh [MUTATIONS] [KILLS]       1000000 and 500 by default
#
# A tenth as many result files as case files are tried. tests/mutations.rs and tests/survive say what
# counts as a fall; the same numbers draw the same mutations. Takes an hour or two of one core.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

need_packages "${BUILD_PACKAGES[@]}" netcdf-bin
need_rust

status=0
FREEPLAY_KILLS=${2:-500} cargo test --locked --release --test survive -- --nocapture at_any_moment || status=1
FREEPLAY_MUTATIONS=${1:-1000000} cargo test --locked --release --test mutations || status=1
exit $status

#!/usr/bin/env bash
# Certifies aimed trials, each held against the motion itself: near dead centres, symmetric drops,
# edges of friction within a step, grazes of 1e-9 to 1e-21 m, two contacts in one instant, rest.
#
#   ./scripts/aimed.sh [TRIALS] [SEED] [FIRST]       2000, 14 and 0 by default
#
# Prints each fall as it comes and a table at the end; the cases that fell are left in out/aimed. The
# same numbers draw the same trials. tests/aimed.rs says what counts as a fall, tests/aimed what is
# drawn and how its truth is known. Takes a quarter of an hour of one core.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

need_packages "${BUILD_PACKAGES[@]}"
need_rust

trials=${1:-2000} seed=${2:-14} first=${3:-0}
folder=$PWD/out/aimed
rm -rf "$folder"
mkdir -p "$folder"
AIMED_TRIALS=$trials AIMED_SEED=$seed AIMED_FIRST=$first AIMED_FALLEN=$folder \
    cargo test --locked --release --test aimed -- --nocapture no_aimed_trial

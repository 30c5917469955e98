#!/usr/bin/env bash
# Makes the certified references that the shipped cases are graded against: tests/data/certified.
# Takes a few minutes; they need to be made again only when the physics or a case changes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."

# case, simulated time (s), time between samples (s)
while read -r case until interval; do
    target/release/freeplay certify "cases/$case.toml" --quiet --force \
        --until "$until" --set "run.sample_interval=$interval" \
        --output "tests/data/certified/$case.h5"
done <<'CASES'
four-bar-ideal       0.012 1e-4
four-bar-a           0.024 2e-4
four-bar-a-friction  0.012 1e-4
four-bar-b           0.012 1e-4
four-bar-c           0.012 1e-4
journal-in-bearing   0.060 5e-4
pendulum             2.0   2e-2
CASES

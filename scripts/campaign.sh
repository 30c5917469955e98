#!/usr/bin/env bash
# Attacks freeplay with random mechanisms, each on both engines at 1e-6, 1e-9 and 1e-12, and with
# random certificates, each held against an integration of other make (scripts/independent.py).
#
#   ./scripts/campaign.sh [MECHANISMS] [SEED] [CERTIFICATES]       2000, 15 and 300 by default
#
# Prints each fall as it comes and a table at the end; the cases that fell are left in out/campaign,
# with the keys that were set. The same numbers draw the same mechanisms. tests/campaign.rs says what
# counts as a fall, tests/campaign/generator.rs what is drawn. Takes an hour or two on two cores.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

need_packages "${BUILD_PACKAGES[@]}" python3-venv
need_rust
need_python

mechanisms=${1:-2000} seed=${2:-15} certificates=${3:-300}
folder=$PWD/out/campaign
rm -rf "$folder"
mkdir -p "$folder/fallen" "$folder/certificates"
cargo build --locked --release

status=0
CAMPAIGN_MECHANISMS=$mechanisms CAMPAIGN_SEED=$seed CAMPAIGN_SAMPLES=20000 CAMPAIGN_FALLEN=$folder/fallen \
    cargo test --locked --release --test campaign -- --nocapture random_mechanisms || status=1

CAMPAIGN_CERTIFICATES=$certificates CAMPAIGN_SEED=$((seed + 1)) CAMPAIGN_CASES=$folder/certificates \
    cargo test --locked --release --test campaign -- --nocapture short_cases
.venv/bin/python scripts/campaign_certificates.py target/release/freeplay "$folder/certificates" || status=1
exit $status

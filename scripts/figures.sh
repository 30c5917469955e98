#!/usr/bin/env bash
# Draws the figures of README.md and docs/paper.md, in docs/figures, from what paper.sh leaves in
# out/paper; runs that first. Sets up what that needs.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

./scripts/paper.sh
need_packages chromium
need_browser_driver

freeplay=target/release/freeplay
out=out/paper

# Into this folder: these runs of this folder, as `freeplay plot` has it.
draw() {
    local into=$1 from=$2
    shift 2
    "$freeplay" plot "$out/four-bar-ideal.h5" "$from"/four-bar-{a,b,c}.h5 -o "$into" --force "$@"
}

draw docs/figures "$out" --only force-A
draw docs/figures/revolution "$out" --over angle --until 0.012 --only \
    clearance-vector-A,torque-crank,angular-acceleration-coupler,angular-acceleration-follower
draw docs/figures/clearance-0.15 "$out/readings/clearance-0.15" --only force-A
draw docs/figures/closed-slowest "$out/readings/closed-slowest" --until 0.012 --only force-A
"$freeplay" plot "$out/four-bar-c.h5" -o docs/figures --force --until 0.018 --only journal-path
"$freeplay" plot --law lankarani-nikravesh,hunt-crossley,lee-wang,gonthier,flores,exact --text outlines \
    -o docs/figures --force
"$freeplay" impact flores kelvin-voigt tsuji -o docs/figures --force
node scripts/frame.mjs "$out/report.html" "#t=12.53&run=four-bar-c" docs/figures/mechanism.png

#!/usr/bin/env bash
# Runs the paper's four cases for five revolutions at the paper's tolerances, and the readings of
# the paper under which its numbers might come nearer. Leaves result files, figures, a report page
# and the table in out/paper, and prints the table. Sets up what that needs.
source "$(dirname "${BASH_SOURCE[0]}")/setup.sh"

need_packages "${BUILD_PACKAGES[@]}" python3-venv
need_rust
need_python
cargo build --locked --release

freeplay=target/release/freeplay
out=out/paper
ideal=$out/four-bar-ideal.h5

# Folder, words, changes to each clearance, how the journals start if not centred
# (docs/paper.md, "Readings").
readings=(
    "diametral|c = 0.5 mm: the 1 mm is diametral|radial=5e-4|"
    "clearance-0.15|c = 0.15 mm|radial=1.5e-4|"
    "clearance-0.1|c = 0.1 mm|radial=1e-4|"
    "internal|K of a journal inside its bearing|normal.stiffness=hertz-internal|"
    "closed-touching|start closed, touching||touching"
    "closed-pressed|start closed, pressed in||pressed"
    "closed-cut|start closed, touching, tension cut|tension=cut|touching"
    "closed-slowest|start closed, slowest impact 1 cm/s|minimum_impact_rate=1e-2|touching"
)

joints_of() {
    case $1 in
        a) echo A ;;
        b) echo A B ;;
        c) echo A B B0 ;;
    esac
}

# Runs a case into a folder, and sums it up beside the result file.
simulate() {
    local case=$1 folder=$2
    shift 2
    "$freeplay" run "cases/$case.toml" -o "$folder/$case.h5" --force --quiet \
        --set run.sampling=adaptive "$@"
    "$freeplay" summary "$folder/$case.h5" --against "$ideal" --json >"$folder/$case.json"
}

# Runs cases a, b and c as one reading has them.
read_as() {
    local name words changes start letter joint change settings started
    IFS='|' read -r name words changes start <<<"$1"
    echo "reading: $words" >&2
    mkdir -p "$out/readings/$name"
    for letter in a b c; do
        settings=()
        for joint in $(joints_of "$letter"); do
            for change in $changes; do
                settings+=(--set "joints.$joint.clearance.$change")
            done
        done
        if [ -n "$start" ]; then
            started=$(.venv/bin/python scripts/closed_start.py "$ideal" \
                "cases/four-bar-$letter.toml" "$start")
            while read -r pose; do settings+=(--set "$pose"); done <<<"$started"
        fi
        simulate "four-bar-$letter" "$out/readings/$name" "${settings[@]}" >/dev/null
    done
    "$freeplay" plot "$ideal" "$out/readings/$name"/four-bar-{a,b,c}.h5 --only force-A \
        -o "$out/readings/$name" --force >/dev/null
}

mkdir -p "$out"
for case in four-bar-ideal four-bar-a four-bar-b four-bar-c; do
    simulate "$case" "$out"
done
runs=("$out"/four-bar-{ideal,a,b,c}.h5)
"$freeplay" plot "${runs[@]}" -o "$out/figures" --force
"$freeplay" report "${runs[@]}" -o "$out/report.html" --force
for reading in "${readings[@]}"; do
    read_as "$reading"
done

table=$(.venv/bin/python scripts/paper_table.py "$out" "${readings[@]}")
echo
echo "$table" | tee "$out/table.txt"

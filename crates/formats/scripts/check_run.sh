#!/usr/bin/env bash
# Runs a scene with VTK output and reads that back with VTK's own reader; also sample frames, bit by bit against a dump.
# Makes a Python environment with the `vtk` package in target/vtk first. Takes another `granule` program as its argument.
set -euo pipefail
cd "$(dirname "$0")/../../.."

folder=target/vtk
python=$folder/venv/bin/python
if ! "$python" -c 'import vtk, numpy' 2>/dev/null; then
    python3 -m venv "$folder/venv"
    "$python" -m pip install --quiet --disable-pip-version-check vtk numpy
fi

granule=${1:-}
if [ -z "$granule" ]; then
    cargo build --quiet --release --package granule-cli
    granule=${CARGO_TARGET_DIR:-target}/release/granule
fi
check=crates/formats/scripts/check_vtp.py

rm -rf "$folder/run"
mkdir -p "$folder/run"
cat >"$folder/run/beads.ron" <<'SCENE'
(
    version: 1,
    gravity: (0, 0, -9.81),
    materials: { "glass": (density: "2500 kg/m^3") },
    bodies: [Fill(material: "glass", radius: Uniform(min: "0.8 mm", max: "1.2 mm"), count: 100, lo: ("-6 mm", "-6 mm", 0), hi: ("6 mm", "6 mm", "20 mm"))],
    walls: { "box": Box(lo: ("-6 mm", "-6 mm", 0), hi: ("6 mm", "6 mm", "30 mm"), material: "glass") },
    contacts: [(between: ("glass", "glass"), normal: LinearSpringDashpot(restitution: 0.8, contact_duration: "0.1 ms"), tangential: TangentialSpring(tangential_restitution: 0.5, friction: 0.4))],
    run: (duration: "20 ms"),
    outputs: [Vtk(path: "beads", every: "5 ms")],
)
SCENE
"$granule" run "$folder/run/beads.ron" --quiet --output "$folder/run/out"
"$python" "$check" "$folder/run/out/beads.pvd" --points 100

cargo run --quiet --release --package granule-formats --example sample_frame -- "$folder/sample" >/dev/null
"$python" "$check" "$folder/sample/raw.pvd" --dump "$folder/sample/frame.dump"
echo "VTK reads what granule writes"

#!/usr/bin/env bash
# smoke.sh BENCH FOLDER: runs the bench on tiny volumes and checks what it writes, not how fast it was.
set -euo pipefail
bench=$1 folder=$2
"$bench" --small --repeat=2 --json="$folder/bench_smoke.json" >"$folder/bench_smoke.txt"
"$bench" --small --list >"$folder/bench_smoke.list"
"$bench" --help | grep -q -- --json
! "$bench" sculpture 2>/dev/null || { echo "an unknown bench was accepted"; exit 1; }
python3 - "$folder/bench_smoke.json" "$folder/bench_smoke.list" "$folder/bench_smoke.txt" <<'END'
import json, sys

report = json.load(open(sys.argv[1]))
listed = open(sys.argv[2]).read().split()
text = open(sys.argv[3]).read()

def why_not(name):
    """Whether the table says something else than a time."""
    line = next(line.split() for line in text.splitlines() if line.split()[:1] == [name])
    return len(line) > 1 and not line[1][0].isdigit()

rows = {row["name"]: row for row in report["benchmarks"]}
assert len(rows) == len(report["benchmarks"]), "two rows have one name"
for key in ("date", "num_cpus", "mhz_per_cpu", "cpu_scaling_enabled", "caches", "load_avg", "library_build_type", "cpu_model"):
    assert key in report["context"], key
for name in listed:
    assert name in text, f"{name} is listed, but not in the table"
    assert name in rows or why_not(name), f"{name} is listed, but was not measured"
for name, row in rows.items():
    assert name in listed, f"{name} was measured, but is not listed"
    for key in ("run_name", "run_type", "repetitions", "threads", "iterations", "real_time", "cpu_time", "time_unit", "min", "median", "max", "primitives"):
        assert key in row, f"{name} has no {key}"
    assert 0 <= row["min"] <= row["median"] <= row["max"] and row["time_unit"] == "ms", row

wanted = [f"extract/edge_points/{t}/48/generic/threads:{n}" for t in ("uint8", "int16", "uint16", "float") for n in (1, 2)]
wanted += [f"extract/{what}/generic/threads:{n}" for what in ("foot_points/head64", "marching_cubes/uint8/48") for n in (1, 2)]
wanted += ["extract/isovalue/ct48/212.5", "extract/dirty/head64/r8", "extract/memory/uint8/48",
           "read/tck/10k/lines", "read/trk/10k/lines"]
spheres, views = ("4k", "8k", "14k"), [f"{ct}/{view}" for ct in ("ct32", "ct48") for view in ("fit", "4x")]
wanted += [f"render/mesh/{what}/threads:{n}" for what in [*spheres, *views] for n in (1, 2)]
wanted += [f"render/raycast/{what}/threads:{n}" for what in views for n in (1, 2)]
wanted += [f"render/{method}/{what}/generic/threads:{n}" for method in ("points", "pullpush", "discs")
           for what in [*spheres, "25k", *views] for n in (1, 2)]
wanted += [f"render/exact/{what}/generic/threads:{n}" for what in views for n in (1, 2)]
wanted += [f"render/together/{what}/threads:1" for what in
           ("points", "points+ribbons/one_pyramid", "points+tubes", "exact+tubes/translucent", "trees-1/triangles",
            "trees-1/pullpush", "trees-10/exact")]
wanted += [f"process/isorender_{method}/ct48.vti/threads:{n}" for method in ("mesh", "exact") for n in (1, 2)]
wanted += [f"sculpt/hand/ball64/r6{seen}/threads:{n}" for n in (1, 2) for seen in ("", "/x-ray-under", "/x-ray-over")]
wanted += [f"render/{copies}/{mode}/threads:1" for copies in ("moving/20", "forest/30") for mode in ("all", "selected", "detail")]
drawn_by = next((name.rsplit("/", 1)[1] for name in listed if name.startswith("render/gl_points/")), None)
if drawn_by:
    wanted += [f"render/gl_{method}/{what}/{drawn_by}" for method in ("points", "pullpush") for what in [*spheres, "25k"]]
    wanted += [f"render/gl_mesh/{what}/{drawn_by}" for what in spheres]
for name in wanted:
    assert name in rows, f"{name} is missing"

edge = rows["extract/edge_points/uint8/48/generic/threads:1"]
assert edge["primitives"] > 0 and edge["ratio_vs_marching_cubes"] > 0
assert "scaling" in rows["extract/edge_points/uint8/48/generic/threads:2"]
assert rows["extract/isovalue/ct48/212.5"]["ratio_vs_full"] > 0
assert rows["extract/dirty/head64/r8"]["brick_time_vs_full"] > 0
assert rows["read/tck/10k/lines"]["ratio_vs_copy"] > 0 and rows["read/trk/10k/lines"]["primitives"] == 10000
assert rows["extract/memory/uint8/48"]["peak_bytes"] > 48**3
peer = rows.get("extract/vtkFlyingEdges3D/uint8/48/threads:1")
if peer:
    assert edge["ratio_vs_vtkFlyingEdges3D"] > 0
    assert peer["primitives"] == edge["primitives"], "VTK finds another number of points"
files = rows.get("extract/vti_to_points/uint8/48")
if files:
    assert files["primitives"] == edge["primitives"], "the file gives another number of points"
if "extract/volumeToMesh/head64/threads:1" in rows:
    assert rows["extract/foot_points/head64/generic/threads:1"]["ratio_vs_volumeToMesh"] > 0

# Every edge point is a vertex of the mesh. The largest sphere is put together from pieces: as many as in one.
for what in spheres:
    points = rows[f"render/points/{what}/generic/threads:1"]["primitives"]
    triangles = rows[f"render/mesh/{what}/threads:1"]["primitives"]
    assert abs(triangles - 2 * points) < 0.01 * points, f"{points} points and {triangles} triangles are not closed"
assert rows["render/points/25k/generic/threads:1"]["primitives"] == 26606
assert rows["render/pullpush/25k/generic/threads:1"]["ratio_vs_1M"] > 0
assert rows["render/discs/25k/generic/threads:1"]["ratio_vs_pullpush"] > 0

if drawn_by:
    pull = rows[f"render/gl_pullpush/4k/{drawn_by}"]
    assert all(pull[key] > 0 for key in ("project_ms", "pull_ms", "push_ms", "finish_ms")), pull
    assert "draw_ms" not in pull and rows[f"render/gl_mesh/4k/{drawn_by}"]["draw_ms"] > 0
    assert rows["render/pullpush/4k/generic/threads:1"]["covered_pixels"] == pull["covered_pixels"]
    assert f"limit of render/gl_pullpush/25k/{drawn_by}" in text

# VTK and all methods show the same thing, from the same place.
for what in [*spheres, *views]:
    mesh = rows[f"render/mesh/{what}/threads:1"]
    others = [name for name in rows if f"/{what}/" in name and name.startswith("render/")]
    for name in others:
        near = 0.3 if "points" in name or "gaussians" in name else 0.06 if "pullpush" in name or "splats" in name else 0.01
        ours, theirs = mesh["covered_pixels"], rows[name]["covered_pixels"]
        assert abs(ours - theirs) <= near * ours, f"{name} covers {theirs} pixels, a mesh {ours}"
    peer = rows.get(f"render/vtk_frame/{what}/threads:1")
    assert not peer or mesh["ratio_vs_vtk_frame"] > 0 and mesh["primitives"] == peer["primitives"]
exact = rows["render/exact/ct48/fit/generic/threads:2"]
assert exact["ratio_vs_raycast"] > 0 and exact["ratio_vs_pullpush"] > 0 and exact["scaling"] > 0
if "process/vtk_picture/ct48.vti/threads:2" in rows:
    assert rows["process/isorender_exact/ct48.vti/threads:2"]["ratio_vs_vtk_process"] > 0
END

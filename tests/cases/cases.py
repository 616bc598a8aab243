#!/usr/bin/env python3
"""Small inputs that once came out wrong, from ../shared/cases: each is opened by isorender or isosculpt, and what comes out is
compared with what is right. cases.py BIN FOLDER; exit status 77 when the folder is not there."""
import json
import os
import subprocess
import sys
import tempfile

BIN, FOLDER = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
FAILED = []
PHANTOM = [(9, 10, 12), (30, 12, 14), (10, 28, 20)]  # the centres of three balls, voxels


class Run:
    """One run of a program: status, standard error, and the object of --json."""

    def __init__(self, program, *options):
        done = subprocess.run([os.path.join(BIN, program), *options], capture_output=True, timeout=300, check=False)
        self.status, self.error = done.returncode, done.stderr.decode(errors="replace")
        self.out = done.stdout.decode(errors="replace")

    def json(self):
        return json.loads(self.out)


def case(path):
    return os.path.join(FOLDER, path)


def draw(*options):
    return Run("isorender", *options, "x.png", "--samples", "1", "--json")


def check(name, good, *what):
    if not good:
        FAILED.append(name)
        print("FAILED:", name, *(str(w)[:300] for w in what))


def near(a, b, tolerance):
    return len(a) == len(b) and all(abs(x - y) <= tolerance for x, y in zip(a, b))


def mesh_of(*options):
    """Vertices and triangles of the mesh that isorender extracts or reads."""
    done = Run("isorender", *options, "--no-image", "--mesh", "x.obj", "--quiet")
    if done.status:
        return done, [], []
    vertices, faces = [], []
    with open("x.obj", encoding="utf-8") as file:
        for line in file:
            words = line.split()
            if words and words[0] == "v":
                vertices.append(tuple(float(w) for w in words[1:4]))
            elif words and words[0] == "f":
                faces.append(tuple(int(w.split("/")[0]) - 1 for w in words[1:4]))
    return done, vertices, faces


def pieces(vertices, faces):
    """The middle of each connected piece of a mesh, in the order of x."""
    root = list(range(len(vertices)))

    def find(i):
        while root[i] != i:
            root[i] = root[root[i]]
            i = root[i]
        return i

    for a, b, c in faces:
        root[find(a)] = root[find(b)] = find(c)
    boxes = {}
    for i, vertex in enumerate(vertices):
        low, high = boxes.setdefault(find(i), (list(vertex), list(vertex)))
        for k in range(3):
            low[k], high[k] = min(low[k], vertex[k]), max(high[k], vertex[k])
    return sorted(tuple((a + b) / 2 for a, b in zip(low, high)) for low, high in boxes.values())


def phantom(name, scale=(1, 1, 1), origin=(0, 0, 0), tolerance=0.3, options=()):
    """Whether a volume shows the three balls, at their places in mm."""
    done, vertices, faces = mesh_of(case(name), *options)
    wanted = sorted(tuple(o + s * c for o, s, c in zip(origin, scale, ball)) for ball in PHANTOM)
    found = pieces(vertices, faces)
    good = len(found) == 3 and all(near(f, w, tolerance * max(map(abs, scale))) for f, w in zip(found, wanted))
    check(name, good, done.status, done.error, found)


def points(name, count, *more):
    done = draw(case(name), *more)
    good = done.status == 0 and done.json()["primitives"]["points"] == count
    check(name, good, done.status, done.error)
    return done


def surface(name, count, box=None):
    done = draw("--surface", case(name))
    good = done.status == 0 and done.json()["objects"][0]["triangles"] == count
    if good and box:
        good = near(done.json()["objects"][0]["bounds_world"], box, 1e-3)
    check(name, good, done.status, done.error, done.out[:200] if done.status == 0 else "")


def refused(name, status, words, *options):
    done = draw(*(options or (case(name),)))
    check(name, done.status == status and done.error.count("\n") == 1 and words in done.error, done.status, done.error)


def covered(name, least):
    done = draw(case(name))
    share = done.json()["image"]["covered"] / done.json()["image"]["samples"] / 1024 ** 2 if done.status == 0 else 0
    check(name, share >= least, done.status, done.error, share)



def meshes():
    for name in ("continued_faces.obj", "face_rows_too_long.ply", "bom.stl", "capitals.stl", "CUBE.STL"):
        surface(name, 12)
    for name, camera, scale, right in (("concave_c.obj", "top", 0.02, 76), ("real/mesh/concave_polygon.obj", "left", 0.002, 0.2455)):
        done = draw("--surface", case(name), "--camera", camera, "--mm-per-pixel", str(scale))
        value = done.json()["image"]["covered"] * scale ** 2 if done.status == 0 else 0
        check(name, abs(value - right) < 0.01 * right, done.status, done.error, value)
    done = draw("--surface", case("real/mesh/wallhole.obj"))
    check("real/mesh/wallhole.obj", done.status == 0, done.status, done.error)
    for name in ("CUBE.STL", "cube_mesh.obj", "real/mesh/unit_cube.STL", "real/mesh/featuretype.STL"):
        done = draw(case(name))
        check(name + " as input", done.status == 0 and "triangles" in done.out, done.status, done.error)
    surface("real/mesh/fuze.ply", 1000)
    surface("real/mesh/fuze_ascii.ply", 1000, [-0.0364, 0.0362, -0.0367, 0.0368, 0.0040, 0.2191])
    surface("real/mesh/box_longline.obj", 944)
    surface("real/mesh/negative_indices.obj", 12)
    surface("real/mesh/cubevt.obj", 12)
    surface("real/mesh/two_objects_mixed_case_names.stl", 24)
    done = draw("--surface", case("polygons.vtk"))
    check("polygons.vtk", done.status == 0, done.status, done.error)
    refused("no_area.obj", 6, "", "--surface", case("no_area.obj"))
    refused("bad_number.obj", 3, "line 2", "--surface", case("bad_number.obj"))
    refused("real/mesh/box_UTF16BE.obj", 3, "UTF-16", "--surface", case("real/mesh/box_UTF16BE.obj"))
    refused("real/mesh/issue623.ply", 3, "", "--surface", case("real/mesh/issue623.ply"))
    done = Run("isosculpt", "--open", case("collinear.stl"), "--headless", "--voxel-size", ".5", "--output", "x.obj", "--quiet")
    vertices, faces = [], []
    if done.status == 0:
        with open("x.obj", encoding="utf-8") as file:
            rows = [line.split() for line in file]
        vertices = [tuple(map(float, r[1:4])) for r in rows if r and r[0] == "v"]
        faces = [tuple(int(w.split("/")[0]) - 1 for w in r[1:4]) for r in rows if r and r[0] == "f"]
    check("collinear.stl", len(pieces(vertices, faces)) == 1, done.status, done.error, len(pieces(vertices, faces)))


def clouds():
    points("bom.xyz", 400)
    points("bom_body.ply", 400)
    points("decimal_commas.txt", 400)
    points("real/points/autzen-bmx-cc.txt", 103)
    points("quoted_names.txt", 400)
    for name in ("wall_x.xyz", "wall_x_rough.xyz", "plate_z.stl"):
        covered(name, 0.1)
    covered("depth_camera.ply", 0.2)
    for name in ("rgb_all_zero.las", "real/points/spec_3.las", "real/points/utm17.las", "real/points/autzen-point-format-3.las",
                 "real/points/synthetic_test.las"):
        done = draw(case(name))
        check(name, done.status == 0 and "colour" in done.error, done.status, done.error)
    for name in ("diffuse_colours.ply", "real/points/pond.0.ply"):
        done = Run("isorender", "--info", case(name))
        check(name, "colours     of the file" in done.out, done.out)
    done = Run("isorender", "--info", case("extra_bytes.las"))
    check("extra_bytes.las", "reflectance: 5 .. 8.99" in done.out, done.out)
    a, b = draw(case("surfels_2dgs.ply")), draw(case("surfels_2dgs_as_3dgs.ply"))
    check("surfels_2dgs.ply", a.status == 0 and a.json()["image"]["hash"] == b.json()["image"]["hash"], a.status, a.error)
    done = Run("isorender", "--info", case("real/points/extrabytes.las"))
    check("real/points/extrabytes.las", "Colors" in done.out and "Time" in done.out, done.out)


def lines():
    for name in ("NEURON.SWC", "TRACK.TCK"):
        done = draw(case(name))
        check(name, done.status == 0, done.status, done.error)
    done = draw(case("soma_bounds.swc"))
    check("soma_bounds.swc", done.status == 0 and near(done.json()["bounds_world"], [-10, 10, -10, 41, -10, 10], 1e-3),
          done.status, done.error, done.out[:400])


def volumes():
    for name, options in (("imagej_zct.tif", ("--component", "1")), ("two_positions.ome.tif", ())):
        phantom(name, (0.0007, 0.0008, 0.0009), options=options)
    done = draw(case("float16.tif"))
    check("float16.tif", done.status in (0, 6) and "kind of numbers" not in done.error, done.status, done.error)
    done = Run("isorender", "--info", case("real/tiff/random-fp16-pred3.tiff"))
    check("real/tiff/random-fp16-pred3.tiff", done.status == 0, done.status, done.error)
    phantom("bdv.h5", (0.0007, 0.0008, 0.0028))
    phantom("transposed_shards.zarr")
    done, vertices, faces = mesh_of(case("phantom.mnc"))
    found, wanted = pieces(vertices, faces), sorted([(-1.3, -2.0, 26.6), (-16.0, -3.6, 32.2), (-2.0, -16.4, 49.0)])
    check("phantom.mnc", len(found) == 3 and all(near(f, w, 0.8) for f, w in zip(found, wanted)), done.status, done.error, found)
    for name, low, high in (("real/minc/small.mnc", 0.1185, 92.8769), ("real/minc/minc2_1_scale.mnc", 0.2083, 0.2094)):
        done = Run("isorender", "--info", case(name))
        numbers = [float(w) for line in done.out.splitlines() if line.split()[:1] == ["range"] for w in line.split()[1::2]]
        check(name, near(numbers, [low, high], 1e-4), done.status, done.error, numbers)
    for name in ("dicom_neighbour", "dicom_two_times"):
        done = Run("isorender", "--info", case(name))
        check(name, done.status == 0 and " 32" in done.out and "note" in done.error, done.status, done.error, done.out)
    done = Run("isorender", "--info", case("real/dicom/mixed/CT_small.dcm"))
    check("real/dicom/mixed/CT_small.dcm", done.status == 0 and "128" in done.out and "-896" in done.out, done.status, done.error)
    done = Run("isorender", case("scan {1}.mha"))
    check("scan {1}.mha", done.status == 0 and os.path.exists("scan {1}.png"), done.status, done.error)


def shown(name, *words, status=0, options=()):
    """Whether --info of a file of other projects ends with this status and says these words."""
    done = Run("isorender", "--info", case("real/" + name), *options)
    said = done.out + done.error
    good = done.status == status and all(word in said for word in words) and (status == 0 or done.error.count("\n") == 1)
    check("real/" + name, good, words, done.status, done.error, done.out)


def others():
    """What the other rows of real/INDEX.tsv expect."""
    shown("points/1.2-with-color.las", "points      1065", "bounds      635619.85 848899.7 406.58", "638982.55 853535.43", "colours     of the file")
    shown("points/epsg_4326.las", "degrees of longitude and latitude")
    shown("points/unregistered_extra_bytes.las", "points      4")
    shown("points/train-1000.ply", "as 3-D Gaussians")
    shown("mesh/points_agisoft.xyz", "points      100", "bounds      665171.375", "colours     of the file")
    shown("dicom/mixed", "1 file is left out: ExplVR_BigEndNoMeta.dcm", "range       -896 .. 1167")
    shown("dicom/rtdose.dcm", "10 x 10 x 15", "range       0.795 .. 1.254")
    shown("dicom/eCT_Supplemental.dcm", "512 x 512 x 2", "range       -1024 .. 172")
    shown("dicom/MR_small_expb.dcm", "range       127 .. 2145")
    shown("dicom/image_dfl.dcm", "the whole data set is deflated", status=3)
    shown("nrrd/BallBinary30x30x30.nii.gz", "range       0 .. 257")
    shown("nrrd/BallBinary30x30x30_byteskip_minus_one_nifti.nhdr", "range       0 .. 257")
    shown("nrrd/BallBinary30x30x30_nifti.nhdr", "a 'byte skip' may be missing")
    shown("tiff/4D-series.ome.tif", "439 x 167 x 5", "the first of 7 times is read")
    shown("tiff/time-series.ome.tif", "7 times of a single slice: they are taken as slices")
    shown("tiff/multi-channel-z-series.ome.tif", "439 x 167 x 5", "component 0 of 3")
    surface("real/mesh/multibody.stl", 32)
    refused("real/mesh/Wuson.ply", 3, "Created", "--surface", case("real/mesh/Wuson.ply"))
    for name in ("1.0_0", "1.0_1", "1.1_0", "1.1_1", "1.2_0", "1.2_1", "1.2_2", "1.2_3"):
        shown("points/las_permutations/%s.las" % name, "points      1\n",
              "colours     of the file" if name in ("1.2_2", "1.2_3") else "colours     none")
    shown("points/las_permutations/1.2-no-points.las", "promises 1065 points", status=3)
    for name in ("blosc", "blosc_transpose", "bz2", "gzip", "none", "none_transpose", "zstd"):
        shown("zarr/zarrs_v3/array_%s.zarr" % name, "range       0 .. 99")
    for name in ("blosc", "bz2", "gzip", "none", "zlib", "zstd"):
        shown("zarr/zarrs_python/array_%s.zarr" % name, "range       0 .. 99")
    for name in ("zarrs_v3/array_pcodec.zarr", "zarrs_v3/array_zfpy.zarr", "zarrs_python/array_adler32.zarr", "zarrs_python/array_fletcher32.zarr"):
        shown("zarr/" + name, "the codec \"numcodecs.", "is not supported", status=3)
    shown("zarr/zarrs_v3/array_optional.zarr/array", "\"optional\" is not supported", status=3)
    for name in ("v2/data.zarr/3d.chunked.i2", "v2/data.zarr/3d.chunked.mixed.i2.F", "v3/data.zarr/3d.chunked.mixed.i2.C"):
        shown("zarr/zarrita_" + name, "3 x 3 x 3, int16")
    shown("zarr/zarrita_v3/data.zarr/3d.chunked.compressed.sharded.i2", "4 x 4 x 4, int16")
    shown("zarr/zarrita_v2/data.zarr/1d.contiguous.i4", "no shape of 2 to 8 axes", status=3)
    shown("zarr/zarrita_v3/data.zarr/3d.contiguous.delta.i4.mixed", "\"numcodecs.delta\" is not supported", status=3)


def main():
    if not os.path.isdir(FOLDER):
        print("skipped:", FOLDER, "is not there")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as work:
        os.chdir(work)
        for part in (meshes, clouds, lines, volumes, others):
            part()
    print("%d cases failed" % len(FAILED))
    sys.exit(1 if FAILED else 0)


main()

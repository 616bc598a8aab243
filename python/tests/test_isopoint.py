"""Tests of the package. python3 -m unittest; ISORENDER: the program, which pictures are held against; ROOT: the source."""
import gc
import itertools
import os
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zlib

import numpy as np

import isopoint

ISORENDER = os.environ.get("ISORENDER", "isorender")
ROOT = os.environ.get("ROOT", ".")
SANITIZED = "ASAN_OPTIONS" in os.environ  # which takes time and memory of its own
PALETTE = "E5DCC8"  # of isorender's first surface


def bumpy(n=64, dtype=np.uint8):
    g = np.linspace(-1, 1, n)
    z, y, x = g[:, None, None], g[None, :, None], g[None, None, :]
    return np.clip(128 + (0.7 + 0.1 * np.sin(9 * x) - np.sqrt(z * z + 1.5 * y * y + 2 * x * x)) * 300, 0, 255).astype(dtype)


def idat(png):
    """The pixels of a PNG as they are compressed."""
    at, found = 8, b""
    while at < len(png):
        size, name = struct.unpack(">I4s", png[at:at + 8])
        if name == b"IDAT":
            found += png[at + 8:at + 8 + size]
        at += size + 12
    return found


def cancelled_after(seconds, call):
    """Sends SIGINT so much later; how long the call then goes on."""
    sent = []

    def send():
        sent.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    timer = threading.Timer(seconds, send)
    timer.start()
    try:
        call()
    except KeyboardInterrupt:
        return time.monotonic() - sent[0]
    finally:
        timer.cancel()
    return None


class Arrays(unittest.TestCase):
    def test_not_copied(self):
        for dtype in (np.uint8, np.int16, np.uint16, np.float32):
            a = bumpy(40, dtype)[:, :30, :20]
            for lent, axes in itertools.product((a, a.copy(), np.asfortranarray(a), a.transpose(2, 1, 0), a[::-1],
                                                 a[:, ::-1, ::-1], a[:, :, ::-1], a[3:-2, ::2, 1:]),
                                                ("zyx", "xyz", "yzx")):
                v = isopoint.Volume(lent, axes=axes)
                self.assertTrue(np.shares_memory(v.array, lent), (dtype, axes, lent.strides))
                self.assertEqual(v.array.ctypes.data, lent.ctypes.data)
                self.assertEqual(v.shape, lent.shape)

    def test_converted(self):
        a = bumpy(dtype=np.float64)
        wanted = isopoint.Surface(a.astype(np.uint8), 128).mesh()
        for lent in (a.astype(np.uint8)[:, :, ::1], a.astype(">i2"), a.astype(np.int32), a.astype(np.int64),
                     np.floor(a), np.floor(a).astype(np.float16), np.repeat(a.astype(np.uint8), 2, 2)[:, :, ::2]):
            mesh = isopoint.Surface(lent, 128).mesh()
            self.assertEqual(len(mesh.triangles), len(wanted.triangles), lent.dtype)
        self.assertGreater(len(isopoint.Surface(a > 100, 0.5).mesh().triangles), 0)
        self.assertEqual(isopoint.Volume(a.astype(np.int64)).array.dtype, np.uint16)

    def test_layouts_are_at_the_same_place(self):
        a = bumpy()
        a[:20] = 0  # not symmetric
        place = dict(spacing=(1, 2, 3), origin=(10, -20, 5), direction=[[0, 1, 0], [-1, 0, 0], [0, 0, 1]])
        base = isopoint.Surface(a, 128, **place)
        picture = base.render(size=(200, 200)).array
        for lent, axes in ((np.asfortranarray(a.T), "xyz"), (np.ascontiguousarray(a.T), "xyz"),
                           (np.asfortranarray(a), "zyx"), (a[::-1].copy()[::-1], "zyx"),
                           (a[:, ::-1, ::-1].copy()[:, ::-1, ::-1], "zyx"), (a.transpose(1, 0, 2).copy(), "yzx"),
                           (np.pad(a, 3)[3:-3, 3:-3, 3:-3], "zyx")):
            surface = isopoint.Surface(lent, 128, axes=axes, **place)
            self.assertTrue(np.allclose(surface.bounds(), base.bounds(), atol=1e-5))
            different = (surface.render(size=(200, 200)).array != picture).any(-1).sum()
            self.assertLessEqual(different, 8, (axes, lent.strides))
            self.assertAlmostEqual(surface.measure()["volume"] / base.measure()["volume"], 1, 4)

    def test_changes(self):
        for axes, flip in (("zyx", 1), ("xyz", 1), ("yxz", -1)):
            a = bumpy()[::flip]
            s = isopoint.Surface(a, 100, axes=axes)
            first = s.render(size=(100, 100)).array.copy()
            s.isovalue = 150
            self.assertTrue((s.render(size=(100, 100)).array != first).any())
            s.isovalue = 100
            self.assertTrue((s.render(size=(100, 100)).array == first).all())
            a[5:30, 20:50, 31:] = 0
            s.volume.changed((5, 20, 31), (30, 50, 64))
            fresh = isopoint.Surface(a.copy() if flip > 0 else a, 100, axes=axes)
            self.assertEqual(len(s.mesh().triangles), len(fresh.mesh().triangles))
            self.assertTrue((s.render(size=(100, 100)).array == fresh.render(size=(100, 100)).array).all())

    def test_refused(self):
        a = bumpy(20)
        for wrong in (lambda: isopoint.Volume(a[0]), lambda: isopoint.Volume(a, axes="zzx"),
                      lambda: isopoint.Volume(a.astype(complex)), lambda: isopoint.Volume(a[:0]),
                      lambda: isopoint.Volume(a, spacing=(1, 2)), lambda: isopoint.Volume(a, spacing=(0, 1, 1)),
                      lambda: isopoint.Surface(a, float("nan")), lambda: isopoint.Surface(a, 128, color="red"),
                      lambda: isopoint.Surface(a, 128, opacity=2), lambda: isopoint.Surface(a, 128).render(samples=3),
                      lambda: isopoint.Surface(a, 128).render(camera="above"),
                      lambda: isopoint.Surface(a, 128).render(method="best"), lambda: isopoint.render([a]),
                      lambda: isopoint.Surface(a, 128).render().depth,
                      lambda: isopoint.Lines([[[0, 0, 0], [1, 1, 1]]], radii=[1])):
            with self.assertRaises((isopoint.Error, ValueError)) as caught:
                wrong()
            self.assertIsInstance(caught.exception, ValueError)


class Pictures(unittest.TestCase):
    def test_same_as_isorender(self):
        """The same compressed bytes: 5 views x 3 methods x 3 volumes."""
        views = (([], {}), (["--camera", "iso", "--samples", "4"], dict(camera="iso", samples=4)),
                 (["--azimuth", "33", "--elevation", "12", "--zoom", "1.5", "--orthographic"],
                  dict(camera=isopoint.Camera(azimuth=33, elevation=12, zoom=1.5, orthographic=True))),
                 (["--resolution", "700x300", "--camera", "left", "--background", "203040"],
                  dict(size=(700, 300), camera="left", background="203040")),
                 (["--camera-position=-90,-80,70", "--camera-focal-point", "32,32,32", "--no-background"],
                  dict(camera=isopoint.Camera(position=(-90, -80, 70), focal_point=(32, 32, 32)), transparent=True)))
        with tempfile.TemporaryDirectory() as folder:
            nrrd = os.path.join(ROOT, "volumes/stent.nrrd")
            opened = isopoint.Volume.open(nrrd)
            ball, floats = bumpy(64), bumpy(48, np.float32)[:, :40]
            ball.tofile(f"{folder}/ball.raw")
            floats.tofile(f"{folder}/floats.raw")
            volumes = ((["--raw", "64x64x64:uint8", "--isovalue", "128", f"{folder}/ball.raw"], isopoint.Volume(ball), 128),
                       (["--raw", "48x40x48:float32", "--spacing", "1,2,1.5", "--isovalue", "90", f"{folder}/floats.raw"],
                        isopoint.Volume(floats, spacing=(1, 2, 1.5)), 90),
                       (["--isovalue", "600", nrrd], opened, 600))
            for (command, volume, isovalue), (options, how), method in itertools.product(
                    volumes, views, ("exact", "mesh", "pullpush")):
                path = f"{folder}/picture.png"
                subprocess.run([ISORENDER, "-q", "--fit", "box", "--method", method, *options, *command[:-1], "-o", path, command[-1]],
                               check=True)
                with open(path, "rb") as stream:
                    theirs = stream.read()
                ours = isopoint.Surface(volume, isovalue, color=PALETTE).render(method=method, **how)._repr_png_()
                self.assertEqual(zlib.crc32(idat(ours)), zlib.crc32(idat(theirs)), (method, options, command))

    @unittest.skipIf(SANITIZED, "sanitizers take memory of their own")
    def test_memory(self):
        """A picture of 4 million samples takes less than 32 MB beside the surface's cells, and any number of samples less
        than 300 MB."""
        def kib(name):
            with open("/proc/self/status", encoding="ascii") as lines:
                return next(int(line.split()[1]) for line in lines if line.startswith(name))
        s = isopoint.Surface(bumpy(96), 128)
        s.bounds()
        for size, samples, most in (((1024, 1024), 4, 32), ((4000, 160), 64, 300)):
            try:
                with open("/proc/self/clear_refs", "w", encoding="ascii") as refs:
                    refs.write("5")  # the peak becomes what is taken now
            except OSError:
                self.skipTest("the peak cannot be set")
            before = kib("VmRSS")
            s.render(size=size, samples=samples)
            self.assertLess(kib("VmHWM") - before, most << 10, size)

    def test_filter(self):
        """The smooth surface is isorender's, and another one than the trilinear."""
        with tempfile.TemporaryDirectory() as folder:
            ball, path = bumpy(32), f"{folder}/picture.png"
            ball.tofile(f"{folder}/ball.raw")
            subprocess.run([ISORENDER, "-q", "--fit", "box", "--raw", "32x32x32:uint8", "--isovalue", "128", "-o", path,
                            "--reconstruction-filter", "cubic", f"{folder}/ball.raw"], check=True)
            with open(path, "rb") as stream:
                theirs = stream.read()
        surface = isopoint.Surface(isopoint.Volume(ball), 128, color=PALETTE)
        self.assertEqual(idat(surface.render(filter="cubic")._repr_png_()), idat(theirs))
        self.assertNotEqual(idat(surface.render()._repr_png_()), idat(theirs))
        with self.assertRaises(ValueError):
            surface.render(filter="soft")

    def test_numbers(self):
        s = isopoint.Surface(bumpy(), 128)
        g = isopoint.Glyphs([[10, 10, 10], [50, 50, 50]], radius=4, color="FF0000")
        p = isopoint.render([s, g], size=(120, 90), aov=True)
        self.assertEqual(p.array.shape, (90, 120, 4))
        self.assertEqual(set(np.unique(p.ids())), {0, 1, 2})
        self.assertEqual((np.isfinite(p.depth) == (p.coverage > 0)).all(), True)
        self.assertTrue(np.allclose(np.linalg.norm(p.normal[p.coverage == 1], axis=1), 1, atol=1e-3))
        self.assertEqual(p.size, (120, 90))
        self.assertEqual(isopoint.render(s, size=(120, 90), camera=p.camera).size, (120, 90))
        again = isopoint.render([s, g], size=(120, 90), camera=p.camera)
        self.assertTrue((again.array == p.array).all())
        self.assertEqual(p.compare(again)["pixels_differing"], 0)

    def test_things(self):
        rng = np.random.default_rng(1)
        t = np.linspace(0, 20, 200)
        curve = np.stack([32 + 20 * np.cos(t), 32 + 20 * np.sin(t), 3 * t], 1)
        s = isopoint.Surface(bumpy(), 128, opacity=0.3)
        mesh = isopoint.Surface(bumpy(), 200).mesh()
        labels = np.zeros((30, 30, 30), np.uint8)
        labels[5:15, 5:15, 5:15], labels[15:25, 5:15, 5:15] = 1, 2
        at = rng.normal(0, 20, (4000, 3))
        at *= 20 / np.linalg.norm(at, axis=1)[:, None]
        axes = np.tile(np.eye(3) * 2, (50, 1, 1))
        for things, options in (([s, isopoint.Lines([curve], radius=1), isopoint.Glyphs(curve[::40], radius=3)], {}),
                                ([isopoint.MeshItem(mesh.vertices, mesh.triangles, color="20C040")], {}),
                                ([isopoint.Labels(labels, i, color=c) for i, c in ((1, "FF0000"), (2, "0000FF"))], {}),
                                ([isopoint.Cloud(at, origin=(5e6, 0, 0))], dict(method="splats-flat")),
                                ([isopoint.Gaussians(at[:50], axes, opacities=np.full(50, 0.5))], {}),
                                ([isopoint.Surface(bumpy(), 128)], dict(look=isopoint.Look(glass=isopoint.Glass()))),
                                ([isopoint.Surface(bumpy(), 128, color_by=isopoint.ColorBy("curvature"))], {}),
                                ([isopoint.Surface(bumpy(), 128)], dict(clip="x<30", cap="surface", occlusion=True,
                                                                         look=isopoint.Look(outline=1, shadow=True))),
                                ([isopoint.Surface(bumpy(), 128)], dict(camera=isopoint.Camera(orthographic=True),
                                                                         marks=("scale", "anatomical")))):
            picture = isopoint.render(things, size=(150, 100), **options)
            self.assertGreater(len(np.unique(picture.array.reshape(-1, 4), axis=0)), 20, things)

    def test_lines_of_a_mesh(self):
        """A tube and a leaf become lines, as wide as they were; a tetrahedron stays, and alone is refused."""
        around = np.linspace(0, 2 * np.pi, 12, endpoint=False)
        tube = np.array([[np.cos(a), np.sin(a), z] for z in range(20) for a in around])
        sides = [[r * 12 + i, r * 12 + (i + 1) % 12] for r in range(19) for i in range(12)]
        faces = [t for a, b in sides for t in ((a, b, b + 12), (a, b + 12, a + 12))]
        leaf = np.array([[9, 0, 0], [8, 0, 2], [10, 0, 2], [8, 0, 5], [10, 0, 5], [9, 0, 8]])
        solid = np.array([[20, 0, 0], [25, 0, 0], [20, 5, 0], [20, 0, 5]])
        blades, sharp = np.array([[0, 2, 1], [1, 2, 4], [1, 4, 3], [3, 4, 5]]), np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
        vertices, triangles = np.concatenate([tube, leaf, solid]), np.concatenate([faces, blades + 240, sharp + 246])
        made = isopoint.Lines.of_mesh(vertices, triangles, color="306030")
        self.assertEqual([type(thing) for thing in made], [isopoint.Lines, isopoint.Lines, isopoint.MeshItem])
        self.assertTrue(np.allclose(made[0].bounds()[1], [1, 1, 20], atol=0.05), made[0].bounds())
        self.assertTrue(np.allclose(made[1].bounds()[0][0], 8, atol=0.05), made[1].bounds())
        self.assertGreater(len(np.unique(isopoint.render(made, size=(99, 99)).array.reshape(-1, 4), axis=0)), 20)
        with self.assertRaisesRegex(isopoint.EmptySurface, "not made of thin branches"):
            isopoint.Lines.of_mesh(solid, sharp)

    def test_looks_are_changed(self):
        a = isopoint.Surface(bumpy(), 128)
        b = isopoint.Surface(bumpy(), 128, color="3060C0", opacity=0.25)
        a.color, a.opacity = "3060C0", 0.25
        self.assertTrue((a.render(size=(99, 99)).array == b.render(size=(99, 99)).array).all())
        a.opacity = 0
        self.assertTrue((a.render(size=(99, 99)).array == 255).all())
        a.opacity, a.color = 1, None
        plain = isopoint.Surface(bumpy(), 128)
        self.assertTrue((a.render(size=(99, 99)).array == plain.render(size=(99, 99)).array).all())

    def test_files(self):
        s = isopoint.Surface(bumpy(), 128)
        with tempfile.TemporaryDirectory() as folder:
            p = s.render(size=(50, 50))
            p.save(f"{folder}/a.png")
            with open(f"{folder}/a.png", "rb") as stream:
                self.assertEqual(stream.read(), p._repr_png_())
            self.assertTrue((isopoint.Picture.read(f"{folder}/a.png").array == p.array).all())
            s.save_mesh(f"{folder}/a.ply")
            s.save_points(f"{folder}/p.ply")
            self.assertGreater(isopoint.MeshItem.read(f"{folder}/a.ply").bounds()[1][0], 0)
            self.assertEqual(len(isopoint.Cloud.read(f"{folder}/p.ply").points()), len(s.points()))
            with self.assertRaises(FileNotFoundError if False else OSError):
                p.save(f"{folder}/none/a.png")
            with self.assertRaises(isopoint.FileError):
                isopoint.Volume.open(f"{folder}/none.nrrd")

    def test_parts(self):
        a = bumpy(64)
        s = isopoint.Surface(a, 128, color=PALETTE)
        whole = s.render(size=(200, 200), samples=1)
        keys = isopoint.Keys(a.shape, 128, whole.camera, size=(200, 200), samples=1, color=PALETTE)
        for z in range(0, 64, 16):
            lo, hi = max(z - 1, 0), min(z + 18, 64)
            keys.draw(isopoint.Volume(a[lo:hi]), (lo, 0, 0), (z, 0, 0), (z + 16, 64, 64))
        self.assertTrue((keys.show().array == whole.array).all())

    def test_scene(self):
        with tempfile.TemporaryDirectory() as folder:
            bumpy().tofile(f"{folder}/a.raw")
            scene = isopoint.Scene("a.raw", raw="64x64x64:uint8", isovalue=128, azimuth=30, color=PALETTE, fit="box")
            scene._folder = folder
            ours = isopoint.Surface(bumpy(), 128, color=PALETTE).render(camera=isopoint.Camera(azimuth=30)).array
            os.environ["ISORENDER"] = ISORENDER
            self.assertTrue((scene.render().array == ours).all())
            scene.save(f"{folder}/a.json")
            loaded = isopoint.Scene.load(f"{folder}/a.json")
            self.assertIn(("azimuth", "30"), loaded.options)
            self.assertTrue((loaded.render().array == ours).all())
            self.assertEqual(loaded.render(resolution="70x40").size, (70, 40))
            subprocess.run([ISORENDER, "-q", f"{folder}/a.json", "-o", f"{folder}/b.png"], check=True)
            self.assertTrue((isopoint.Scene.load(f"{folder}/b.png").render().array == ours).all())
            with self.assertRaises(isopoint.UsageError):
                isopoint.Scene("a.raw", colour_of_sky="blue").render()
            with self.assertRaises(isopoint.FileError):
                isopoint.Scene.load(f"{folder}/a.raw")


class Outputs(unittest.TestCase):
    def test_views_outlive_what_they_are_of(self):
        def make():
            s = isopoint.Surface(bumpy().copy(), 128)
            return s.mesh().vertices, s.render(size=(64, 64), aov=True).depth, s.points().positions, s.volume.array
        arrays = make()
        copies = [a.copy() for a in arrays]
        gc.collect()
        [bumpy() for _ in range(20)]
        for a, b in zip(arrays, copies):
            self.assertTrue((a == b).all())

    def test_meshes(self):
        s = isopoint.Surface(bumpy(), 128)
        m, p = s.mesh(), s.points()
        self.assertFalse(m.vertices.flags.owndata or m.triangles.flags.owndata)
        self.assertEqual(m.triangles.max() + 1, len(m.vertices))
        self.assertEqual(s.measure()["euler"], 2)
        corners = m.vertices[m.triangles].astype(float)
        volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        self.assertAlmostEqual(volume / s.measure()["volume"], 1, 5)
        self.assertEqual(len(p), len(p.radii))
        vertices, faces = m.to_napari()
        self.assertTrue((vertices[:, 0] == m.vertices[:, 2]).all())

    def test_meshes_for_files(self):
        """The same triangles as isorender writes: fewer, smooth, closed, hollow."""
        makings = ((["--smooth-mesh", "7"], dict(smooth=7)), (["--decimate", "10%"], dict(keep=0.1)),
                   (["--decimate", "0.2"], dict(deviation=0.2)), (["--closed"], dict(closed=True)),
                   (["--hollow", "3", "--drain", "5", "--up", "y"], dict(hollow=3, drain=5, up=(0, 1, 0))),
                   (["--hollow", "4", "--smooth-mesh", "2", "--decimate", "30%"], dict(hollow=4, smooth=2, keep=0.3)))
        with tempfile.TemporaryDirectory() as folder:
            bumpy(64).tofile(f"{folder}/ball.raw")
            s, written = isopoint.Surface(bumpy(64), 40), []
            for options, how in makings:
                subprocess.run([ISORENDER, "-q", "--raw", "64x64x64:uint8", "--isovalue", "40", "--no-image", *options,
                                "--mesh", f"{folder}/theirs.stl", f"{folder}/ball.raw"], check=True)
                s.save_mesh(f"{folder}/ours.stl", **how)
                with open(f"{folder}/theirs.stl", "rb") as theirs, open(f"{folder}/ours.stl", "rb") as ours:
                    written.append(theirs.read()[80:])  # behind the comment
                    self.assertTrue(ours.read()[80:] == written[-1], options)
                self.assertEqual(len(s.mesh(**how).triangles), int.from_bytes(written[-1][:4], "little"))
            self.assertEqual(len(set(written)), len(makings))
        with self.assertRaises(TypeError):
            s.mesh(hole=1)
        with self.assertRaises(isopoint.UsageError):
            s.mesh(keep=2)

    def test_vtk(self):
        try:
            from vtkmodules.vtkFiltersCore import vtkMassProperties
        except ImportError:
            self.skipTest("VTK is not there")
        s = isopoint.Surface(bumpy(), 128)
        mesh = s.mesh()
        properties = vtkMassProperties()
        properties.SetInputData(mesh.to_vtk())
        self.assertAlmostEqual(properties.GetSurfaceArea() / s.measure()["area"], 1, 6)

    def test_far(self):
        a, place = bumpy(), dict(spacing=(0.1, 0.1, 0.1))
        near, far = isopoint.Surface(a, 128, **place), isopoint.Surface(a, 128, origin=(0, 5e6, 0), **place)
        self.assertTrue((far.mesh(origin=(0, 5e6, 0)).vertices == near.mesh().vertices).all())
        self.assertTrue((far.points(origin=(0, 5e6, 0)).positions == near.points().positions).all())

    def test_histogram(self):
        a = bumpy()
        counts, edges = isopoint.Volume(a).histogram()
        self.assertEqual(len(edges), len(counts) + 1)
        self.assertTrue(edges[0] < isopoint.Volume(a).suggest() < edges[-1])


class Sculpting(unittest.TestCase):
    def test_strokes(self):
        with tempfile.TemporaryDirectory() as folder:
            s = isopoint.Sculpt(shape=(96, 96, 96), radius=30, journal=f"{folder}/a.strokes")
            first = s.surface.measure()["volume"]
            self.assertAlmostEqual(first / (4 / 3 * np.pi * 30**3), 1, 2)
            self.assertGreater(s.stroke(isopoint.Brush(8, symmetry="x"), [[30, 0, 0], [25, 15, 5]]), 0)
            second = s.surface.measure()["volume"]
            self.assertGreater(second, first)
            s.undo()
            self.assertEqual((s.undo_count, s.redo_count, s.surface.measure()["volume"]), (0, 1, first))
            s.redo()
            with self.assertRaises(isopoint.UsageError):
                s.redo()
            self.assertEqual(s.surface.measure()["volume"], second)
            picture = s.surface.render(size=(64, 64)).array
            del s
            gc.collect()
            again = isopoint.Sculpt.replay(f"{folder}/a.strokes")
            self.assertTrue((again.surface.render(size=(64, 64)).array == picture).all())

    def test_solids(self):
        """Sessions begin with solids of known volumes, which replay; what is none is refused."""
        wanted = {"sphere": 4 / 3 * np.pi * 8000, "box": 24000, "cylinder": np.pi * 400 * 20, "torus": 2 * np.pi**2 * 15 * 25}
        sizes = {"sphere": (40, 0, 0), "box": (40, 30, 20), "cylinder": (40, 0, 20), "torus": (40, 0, 10)}
        for name, size in sizes.items():
            volume = isopoint.Sculpt(solid=name, size=size, voxel=0.5).surface.measure()["volume"]
            self.assertAlmostEqual(volume / wanted[name], 1, 2)
        with tempfile.TemporaryDirectory() as folder:
            made = isopoint.Sculpt(solid="box", size=(40, 30, 20), round=4, voxel=1, journal=f"{folder}/a.strokes")
            made.stroke(isopoint.Brush(8, "mask"), [[20, 0, 0]])
            made.stroke(isopoint.Brush(3, "blur-mask"), [[0, 0, 0]])
            made.stroke(isopoint.Brush(6, "carve"), [[20, 0, 0], [0, 0, 10]])
            volume = made.surface.measure()["volume"]
            del made
            gc.collect()
            self.assertEqual(isopoint.Sculpt.replay(f"{folder}/a.strokes").surface.measure()["volume"], volume)
        for solid, size, more in (("box", (4, 4, 4), {"round": 3}), ("torus", (4, 0, 3), {}), ("stamp", (4, 4, 4), {}),
                                  ("box", (4, -4, 4), {}), ("box", (90, 90, 1), {"voxel": 1}), ("box", (4, 4, 4), {"radius": 2})):
            with self.assertRaises(isopoint.UsageError):
                isopoint.Sculpt(solid=solid, size=size, **more)

    def test_radial_and_trim(self):
        """Six images are six strokes; a plane halves a ball; what outlines nothing is refused and leaves nothing behind."""
        ball = isopoint.Sculpt(shape=(96, 96, 96), radius=30)
        whole = ball.surface.measure()["volume"]
        ball.stroke(isopoint.Brush(4), [[30, 2, 5]])
        one = ball.surface.measure()["volume"] - whole
        ball.undo()
        brush = isopoint.Brush(4, radial=6, radial_axis="y")
        ball.stroke(brush, [[30, 2, 5]])
        self.assertEqual(ball.strokes[0].brush, brush)
        self.assertAlmostEqual((ball.surface.measure()["volume"] - whole) / (6 * one), 1, 1)
        ball.undo()
        ball.stroke(isopoint.Brush(1, "trim-plane"), [[0, -9, 0], [0, 9, 0]], [0, 0, 1])
        self.assertAlmostEqual(ball.surface.measure()["volume"] / whole, 0.5, 2)
        with self.assertRaises(isopoint.UsageError):
            ball.stroke(isopoint.Brush(1, "trim-lasso"), [[0, -9, 0], [0, 9, 0]], [0, 0, 1])
        self.assertEqual(ball.undo_count, 1)
        with self.assertRaises(isopoint.UsageError):
            ball.stroke(isopoint.Brush(4, radial=33), [[30, 2, 5]])
        with self.assertRaises(isopoint.UsageError):
            ball.stroke(isopoint.Brush(4, radial=3, radial_axis="w"), [[30, 2, 5]])

    def test_pictures_of_heights(self):
        """A grey .png weighs what a brush does: half of a white one does half of it; colours are refused."""
        def png(path, rows, kind, bits):
            def chunk(name, data):
                return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
            header = struct.pack(">IIBBBBB", len(rows[0]) * 8 // bits // (3 if kind == 2 else 1), len(rows), bits, kind, 0, 0, 0)
            with open(path, "wb") as file:
                file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
                           + chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))) + chunk(b"IEND", b""))

        def grown(path):
            ball = isopoint.Sculpt(shape=(96, 96, 96), radius=30)
            before = ball.surface.measure()["volume"]
            ball.set_stamp(path)
            brush = isopoint.Brush(8, "inflate", falloff="constant", strength=1, alpha="fixed")
            for _ in range(4):
                ball.stroke(brush, [[0, -30, 0]], [0, -1, 0])
            self.assertEqual(ball.strokes[0].brush, brush)
            return ball.surface.measure()["volume"] - before

        with tempfile.TemporaryDirectory() as folder:
            png(f"{folder}/white.png", [b"\xff" * 16] * 16, 0, 8)
            png(f"{folder}/half.png", [b"\xff\xff" * 8 + b"\0\0" * 8] * 16, 0, 16)
            png(f"{folder}/color.png", [b"\xff" * 48] * 16, 2, 8)
            white, half = grown(f"{folder}/white.png"), grown(f"{folder}/half.png")
            self.assertGreater(white, 50)
            self.assertTrue(0.45 < half / white < 0.55, (half, white))
            with self.assertRaises(isopoint.Error):
                grown(f"{folder}/color.png")
            with self.assertRaises(isopoint.UsageError):
                isopoint.Sculpt(shape=(96, 96, 96)).stroke(isopoint.Brush(8, "inflate", alpha="fixed"), [[0, 0, 0]])

    def test_edits(self):
        """Edits of past strokes give what drawing the edited strokes gives."""
        def field(*strokes):
            made = isopoint.Sculpt(shape=(96, 96, 96), radius=30)
            for brush, at in strokes:
                made.stroke(brush, at)
            return made

        def same(a, b):
            pictures = [x.surface.render(size=(128, 128)).array for x in (a, b)]
            return (pictures[0] == pictures[1]).all() and a.surface.measure()["triangles"] == b.surface.measure()["triangles"]

        bump, dent = isopoint.Brush(8, symmetry="x"), isopoint.Brush(6, "carve", strength=0.5, color="#40a0c0")
        a, b, c = (bump, [[25, 0, 15], [22, 15, 15]]), (dent, [[20, 5, 20]]), (isopoint.Brush(9, "inflate", strength=1), [[20, 5, 24]])
        s = field(a, b, c)
        self.assertEqual([(x.number, x.muted, x.brush, x.samples) for x in s.strokes],
                         [(1, False, bump, 2), (2, False, dent, 1), (3, False, c[0], 1)])
        wide = isopoint.Brush(10, "carve", strength=0.5)
        s.edit(2, wide)
        self.assertTrue(same(s, field(a, (wide, b[1]), c)))
        self.assertFalse(same(s, field(a, b, c)))
        s.undo()
        s.mute(1, 2)
        s.unmute(2)
        self.assertTrue(same(s, field(b, c)))
        self.assertEqual([x.muted for x in s.strokes], [True, False, False])
        s.unmute(1)
        positions, normals = s.path(2)
        self.assertEqual(positions.shape, normals.shape)
        s.set_path(2, positions + (0, 0, 1.5))
        np.testing.assert_array_equal(s.path(2)[0], positions + (0, 0, 1.5))
        np.testing.assert_array_equal(s.path(2)[1], normals)
        s.reseat(2, 3)
        s.undo()
        s.undo()
        np.testing.assert_array_equal(s.path(2)[0], positions)
        s.move(3, before=1)
        self.assertEqual([x.number for x in s.strokes], [3, 1, 2])
        self.assertTrue(same(s, field(c, a, b)))
        s.move(3)
        s.delete(1)
        self.assertTrue(same(s, field(b, c)))
        for wrong in (lambda: s.mute(9), lambda: s.delete(0), lambda: s.move(2, before=2), lambda: s.path(9), lambda: s.set_path(2, [[0, 0, 0]] * 99), lambda: s.reseat(9), lambda: s.edit(2, isopoint.Brush(-1))):
            with self.assertRaises(isopoint.UsageError):
                wrong()
        self.assertTrue(same(s, field(b, c)))

    def test_of_volume(self):
        v = isopoint.Volume(bumpy(40))
        s = isopoint.Sculpt.from_volume(v, 128)
        self.assertAlmostEqual(s.surface.measure()["volume"] / isopoint.Surface(v, 128).measure()["volume"], 1, 1)
        with self.assertRaises(AttributeError):
            s.volume.array


class Cancelling(unittest.TestCase):
    def test_progress(self):
        s = isopoint.Surface(bumpy(128), 128)
        told = []
        wanted = s.render(size=(300, 300), method="raycast", samples=16, progress=told.append).array.copy()
        self.assertEqual(told, sorted(told))
        with self.assertRaises(isopoint.FileError):
            s.render(size=(900, 900), method="raycast", samples=16, progress=lambda fraction: True)
        with self.assertRaises(ZeroDivisionError):
            s.render(size=(900, 900), method="raycast", samples=16, progress=lambda fraction: 1 / 0)
        self.assertTrue((s.render(size=(300, 300), method="raycast", samples=16).array == wanted).all())

    def test_interrupted(self):
        s = isopoint.Surface(bumpy(128), 128)
        wanted = s.render(size=(200, 200), samples=1).array.copy()
        for options in (dict(size=(4000, 4000), samples=64), dict(size=(3000, 3000), samples=4, method="raycast"),
                        dict(size=(3000, 3000), samples=4, look=isopoint.Look(glass=isopoint.Glass()))):
            late = cancelled_after(0.4, lambda: s.render(**options))
            print(options, "interrupted after", late)
            self.assertTrue(late is None or late < (10 if SANITIZED else 2), (options, late))  # (0.5 on a machine at rest)
            self.assertTrue((s.render(size=(200, 200), samples=1).array == wanted).all())

    def test_threads(self):
        """Threads share a volume, and different volumes at once."""
        s, own = isopoint.Surface(bumpy(), 128), [isopoint.Surface(bumpy(), 128) for _ in range(2)]
        want = s.render(size=(200, 200)).array.copy()
        good = []

        def work(i):
            for k in range(5):
                good.append((isopoint.render(s if k % 2 else own[i % 2], size=(200, 200)).array == want).all())

        threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
        [t.start() for t in threads]
        [t.join() for t in threads]
        self.assertEqual(good, [True] * 20)

    def test_fork(self):
        s = isopoint.Surface(bumpy(), 128, threads=2)
        want = s.render(size=(100, 100)).array.copy()
        child = os.fork()
        if child == 0:
            good = (s.render(size=(100, 100)).array == want).all()
            del s
            gc.collect()
            own = isopoint.Surface(bumpy(), 128, threads=2)
            good &= (own.render(size=(100, 100)).array == want).all()
            os._exit(0 if good else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_collected_in_any_order(self):
        for order in itertools.permutations(range(3)):
            v = isopoint.Volume(bumpy(30), threads=2)
            s = isopoint.Surface(v, 128)
            kept = [v, s, s.render(size=(20, 20))]
            del v, s
            for i in order:
                kept[i] = None
                gc.collect()

    def test_cycles(self):
        """Garbage that refers to itself is taken apart in any order: a volume must not go before its surfaces."""
        for _ in range(20):
            things = [isopoint.Surface(bumpy(30), 128, threads=2) for _ in range(3)]
            for a, b in itertools.product(things, things):
                setattr(a, f"other{id(b)}", b)
                setattr(b.volume, f"surface{id(a)}", a)
                b.volume._handle_of = a._handle
            things[0].mesh()
            del things, a, b
            gc.collect()

    def test_exit(self):
        """The interpreter ends without hanging or crashing, also with cycles and with a thread at work."""
        code = ("import sys, threading, numpy as np, isopoint\n"
                "a = np.zeros((90, 90, 90), np.uint8); a[20:70, 20:70, 20:70] = 255\n"
                "s = isopoint.Surface(a, 128, threads=2); s.me = s; s.render(size=(50, 50)); sculpt = isopoint.Sculpt()\n"
                "t = threading.Thread(target=lambda: s.render(size=(2000, 2000), samples=16), daemon=True); t.start()\n")
        for _ in range(3):
            self.assertEqual(subprocess.run([sys.executable, "-c", code], timeout=60).returncode, 0)


if __name__ == "__main__":
    unittest.main()

"""What is drawn: surfaces of volumes, clouds of points, lines, glyphs and meshes."""
from __future__ import annotations

import os
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any, Dict, Iterable, Iterator, Optional, Sequence, Tuple, Union

import numpy as np

from ._core import Array, Color, Floats, Locked, Path, Progress, call, lent, one_of, owned, rgb, usage, vec3, view
from ._native import ffi, lib
from ._volume import Volume

Box = Tuple[Tuple[float, float, float], Tuple[float, float, float]]
_PRIMITIVES = {"auto": lib.ISO_PRIMITIVE_AUTO, "edge": lib.ISO_PRIMITIVE_EDGE, "foot": lib.ISO_PRIMITIVE_FOOT,
               "foot-iterated": lib.ISO_PRIMITIVE_FOOT_ITERATED}
_GLYPHS = {"sphere": lib.ISO_GLYPH_SPHERE, "cone": lib.ISO_GLYPH_CONE, "cylinder": lib.ISO_GLYPH_CYLINDER,
           "arrow": lib.ISO_GLYPH_ARROW, "ellipsoid": lib.ISO_GLYPH_ELLIPSOID, "disc": lib.ISO_GLYPH_DISC,
           "box": lib.ISO_GLYPH_BOX}
_SOURCES = {"volume": lib.ISO_COLOR_BY_VOLUME, "curvature": lib.ISO_COLOR_BY_CURVATURE,
            "distance": lib.ISO_COLOR_BY_DISTANCE, "depth": lib.ISO_COLOR_BY_DEPTH, "normal": lib.ISO_COLOR_BY_NORMAL}


def _box(box: Any) -> Box:
    return (box.lo.x, box.lo.y, box.lo.z), (box.hi.x, box.hi.y, box.hi.z)


def _making(given: "Dict[str, Any]") -> Any:
    """The iso_surface_mesh_opts of the keywords of Surface.mesh."""
    names = [name for name, _ in ffi.typeof("iso_surface_mesh_opts").fields]
    unknown = set(given) - set(names)
    if unknown:
        raise TypeError(f"{', '.join(sorted(unknown))}: a mesh is made with {', '.join(names)}")
    if "up" in given:
        given = {**given, "up": tuple(vec3(given["up"], "up"))}
    return ffi.new("iso_surface_mesh_opts *", given)


class Mesh:
    """A closed or open triangle mesh. `vertices` and `normals` (n, 3) float32, `triangles` (m, 3) uint32: views of the
    library's memory. World positions are `vertices` + `origin`."""

    def __init__(self, mesh: Any, origin: Sequence[float]) -> None:
        v, t = int(mesh.vertex_count), int(mesh.triangle_count)
        self.vertices = view(mesh.positions, (v, 3), "<f4", mesh)
        self.normals = view(mesh.normals, (v, 3), "<f4", mesh)
        self.triangles = view(mesh.triangles, (t, 3), "<u4", mesh)
        self.origin = np.array(origin, float)

    def to_vtk(self) -> Any:
        """A vtkPolyData that shares vertices and normals."""
        from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray  # type: ignore[import]
        from vtkmodules.vtkCommonCore import vtkPoints  # type: ignore[import]
        from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData  # type: ignore[import]
        data, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
        points.SetData(numpy_to_vtk(self._world()))
        offsets = np.arange(0, 3 * len(self.triangles) + 1, 3, dtype=np.int64)
        cells.SetData(numpy_to_vtkIdTypeArray(offsets, deep=True),
                      numpy_to_vtkIdTypeArray(self.triangles.astype(np.int64).ravel(), deep=True))
        normals = numpy_to_vtk(self.normals)
        normals.SetName("Normals")
        data.SetPoints(points)
        data.SetPolys(cells)
        data.GetPointData().SetNormals(normals)
        return data

    def to_pyvista(self) -> Any:
        """A pyvista.PolyData."""
        import pyvista  # type: ignore[import]
        return pyvista.wrap(self.to_vtk())

    def to_napari(self) -> Tuple[Array, Array]:
        """Vertices and faces for napari's add_surface, z y x."""
        return self._world()[:, ::-1], self.triangles

    def _world(self) -> Array:
        world: Array = self.vertices + self.origin if self.origin.any() else self.vertices
        return world


class Points:
    """Points of a surface: `positions` and `normals` (n, 3), `radii` (n), float32. World positions are `positions` +
    `origin`."""

    def __init__(self, rows: Array, origin: Sequence[float]) -> None:
        self.positions, self.normals, self.radii = rows[:, :3], rows[:, 3:6], rows[:, 6]
        self.origin = np.array(origin, float)

    def __len__(self) -> int:
        return len(self.positions)


@dataclass
class ColorBy:
    """What a surface is coloured by: "volume" (the values of `volume`), "curvature", "distance" (from the isosurface of
    `volume` at `isovalue`), "depth" or "normal". `range` None: of what is there."""
    source: str
    volume: Optional[Volume] = None
    isovalue: float = 0.0
    colormap: Optional[str] = None
    range: Optional[Tuple[float, float]] = None

    def _opts(self, surface: int, keep: "list[Any]") -> "Dict[str, Any]":
        name = ffi.new("char[]", self.colormap.encode()) if self.colormap else ffi.NULL
        keep.append(name)
        return {"surface": surface, "source": one_of(_SOURCES, self.source, "color_by"), "isovalue": self.isovalue,
                "volume": self.volume._handle if self.volume else ffi.NULL, "colormap": name,
                "range": list(self.range or (0.0, 0.0))}


class Thing:
    """Anything that `render` draws. `color` ("RRGGBB" or three numbers; None: one of a small palette) and `opacity`
    (0 .. 1) can be changed between pictures."""
    _handle: Any
    _set_look: Any

    def _look(self, color: Optional[Color], opacity: float) -> None:
        call(self._set_look, self._handle, rgb(color), float(opacity))
        self._color, self._opacity = color, float(opacity)

    @property
    def color(self) -> Optional[Color]:
        return self._color

    @color.setter
    def color(self, color: Optional[Color]) -> None:
        self._look(color, self._opacity)

    @property
    def opacity(self) -> float:
        return self._opacity

    @opacity.setter
    def opacity(self, opacity: float) -> None:
        self._look(self._color, opacity)

    def render(self, **options: Any) -> Any:
        """A picture of this alone: see `render`."""
        from ._picture import render
        return render([self], **options)

    def _repr_png_(self) -> bytes:
        return bytes(self.render(size=(512, 512))._repr_png_())


class _Surfaces(Thing, Locked):
    """An iso_surface: of a volume or a cloud."""
    _set_look = lib.iso_surface_set_look
    color_by: Optional[ColorBy] = None
    volume: Optional[Volume] = None

    @contextmanager
    def _working(self, progress: Optional[Progress] = None) -> Iterator[None]:
        if self.volume is None:
            with self._lock:
                yield
        else:
            with self.volume._working(progress):
                yield

    def bounds(self) -> Box:
        """The least and the greatest corner of the box around it, mm."""
        box = ffi.new("iso_box *")
        with self._working():
            call(lib.iso_surface_bounds, self._handle, box)
        return _box(box)

    def points(self, *, origin: Floats = (0, 0, 0), progress: Optional[Progress] = None) -> Points:
        """Its points, relative to `origin`: give one nearby where the world's coordinates are large."""
        count = ffi.new("size_t *")
        with self._working(progress):
            call(lib.iso_surface_set_origin, self._handle, vec3(origin, "origin"))
            call(lib.iso_surface_points, self._handle, ffi.NULL, 0, count)
            rows = np.empty((int(count[0]), 7), np.float32)
            call(lib.iso_surface_points, self._handle, ffi.cast("iso_surface_point *", rows.ctypes.data), len(rows),
                 count)
        return Points(rows, origin)

    def save_points(self, path: Path) -> None:
        """Writes the points as .ply."""
        with self._working():
            call(lib.iso_surface_write_points, self._handle, os.fsencode(path))

    def trim(self) -> None:
        """Gives back the memory of points, meshes and cells; they are computed again when they are needed."""
        with self._working():
            lib.iso_surface_trim(self._handle)


class Surface(_Surfaces):
    """The isosurface of a volume, or of an array with the arguments of Volume, at an isovalue (None: a suggested one).

    `primitive`, the kind of its points: "auto", "edge", "foot" or "foot-iterated"."""

    volume: Volume

    def __init__(self, volume: Any, isovalue: Optional[float] = None, *, color: Optional[Color] = None,
                 opacity: float = 1.0, primitive: str = "auto", color_by: Optional[ColorBy] = None,
                 **place: Any) -> None:
        self.volume = volume if isinstance(volume, Volume) else Volume(volume, **place)
        if place and isinstance(volume, Volume):
            raise usage(f"{', '.join(place)}: the volume has its place already")
        self._isovalue = self.volume.suggest() if isovalue is None else float(isovalue)
        self.color_by = color_by
        self._create({"isovalue": self._isovalue, "primitive": one_of(_PRIMITIVES, primitive, "primitive")})
        self._look(color, opacity)

    def _create(self, options: "Dict[str, Any]") -> None:
        made = ffi.new("iso_surface **")
        with self.volume._working(None):
            call(lib.iso_surface_create, self.volume._handle, ffi.new("iso_surface_opts *", options), made)
        self._handle = owned(made[0], "iso_surface_destroy", self.volume._handle)
        self._lock = self.volume._lock

    @property
    def isovalue(self) -> float:
        """May be changed; points, meshes and cells follow at their next use."""
        return self._isovalue

    @isovalue.setter
    def isovalue(self, value: float) -> None:
        with self._lock:
            call(lib.iso_surface_set_isovalue, self._handle, float(value))
        self._isovalue = float(value)

    def mesh(self, *, origin: Floats = (0, 0, 0), progress: Optional[Progress] = None, **making: Any) -> Mesh:
        """The Marching Cubes mesh, welded; `origin` as of `points`. `making`, in this order: `closed`=True caps the
        solid at the volume's border; `hollow` leaves a wall of so many mm, closed, with two holes `drain` mm wide
        along `up` (default z); `smooth`: iterations of Taubin's filter; `keep` joins triangles until this share of
        them is left, `deviation` as long as the surface moves by about so many mm at most."""
        mesh = ffi.gc(ffi.new("iso_mesh *"), lib.iso_mesh_free)
        with self._working(progress):
            call(lib.iso_surface_set_origin, self._handle, vec3(origin, "origin"))
            call(lib.iso_surface_mesh_with, self._handle, _making(making), mesh)
        return Mesh(mesh, origin)

    def measure(self, progress: Optional[Progress] = None) -> "Dict[str, float]":
        """The mesh in numbers: area (mm2), volume (mm3; NaN: it is open), pieces, euler, open_edges .."""
        m = ffi.new("iso_mesh_measures *")
        with self._working(progress):
            call(lib.iso_surface_measure, self._handle, m)
        return {name: getattr(m, name) for name, _ in ffi.typeof("iso_mesh_measures").fields}

    def save_mesh(self, path: Path, **making: Any) -> None:
        """Writes the mesh as .ply, .stl, .obj, .vtp, .glb or .3mf; `making` as of `mesh`."""
        with self._working():
            call(lib.iso_surface_write_mesh_with, self._handle, _making(making), os.fsencode(path))


class Labels(Surface):
    """The smooth surface around voxels with one of some labels (0 .. 65535) of a segmentation."""

    def __init__(self, volume: Any, labels: Union[int, Sequence[int]], *, color: Optional[Color] = None,
                 opacity: float = 1.0, **place: Any) -> None:
        self.volume = volume if isinstance(volume, Volume) else Volume(volume, **place)
        self.labels = [int(labels)] if isinstance(labels, (int, np.integer)) else [int(i) for i in labels]
        self._isovalue = 0.0
        numbers = ffi.new("int[]", self.labels)
        self._create({"labels": numbers, "label_count": len(self.labels)})
        self._look(color, opacity)


class Cloud(_Surfaces):
    """Points without a volume, such as a scan, drawn as discs. Positions (n, 3) are relative to `origin` (doubles).
    Normals and radii that are not given are estimated; `radius` is that of all discs, mm; `opacities` are 0 .. 1."""

    def __init__(self, positions: Any, *, normals: Any = None, radii: Any = None, colors: Any = None,
                 opacities: Any = None, origin: Floats = (0, 0, 0), radius: float = 0.0,
                 color: Optional[Color] = None, opacity: float = 1.0, threads: int = 0) -> None:
        self._of_arrays(positions, None, normals, radii, colors, opacities, origin,
                        {"radius": radius, "threads": threads}, color, opacity)

    def _of_arrays(self, positions: Any, axes: Any, normals: Any, radii: Any, colors: Any, opacities: Any,
                   origin: Floats, options: "Dict[str, Any]", color: Optional[Color], opacity: float) -> None:
        Locked.__init__(self)
        keep: "list[Any]" = []
        n = len(positions)
        arrays = ffi.new("iso_cloud_arrays *", {
            "count": n, "positions": lent(positions, 3, "<f4", keep, "positions"), "origin": vec3(origin, "origin"),
            "normals": lent(normals, 3, "<f4", keep, "normals", n), "radii": lent(radii, 0, "<f4", keep, "radii", n),
            "axes": lent(axes if axes is None else np.reshape(axes, (-1, 9)), 9, "<f4", keep, "axes", n),
            "colors": lent(colors, 3, "u1", keep, "colors", n),
            "opacities": lent(opacities, 0, "<f4", keep, "opacities", n)})
        made = ffi.new("iso_surface **")
        call(lib.iso_surface_of_cloud, arrays, ffi.new("iso_surface_cloud_opts *", options), made)
        self._take(made[0], color, opacity)

    def _take(self, handle: Any, color: Optional[Color], opacity: float) -> None:
        self._handle = owned(handle, "iso_surface_destroy")
        self._look(color, opacity)

    @classmethod
    def read(cls, path: Path, *, radius: float = 0.0, color: Optional[Color] = None, opacity: float = 1.0,
             threads: int = 0) -> "Cloud":
        """Points of a file: .ply, .las, .laz, .pcd, .xyz, .csv and others."""
        made = ffi.new("iso_surface **")
        opts = ffi.new("iso_surface_cloud_opts *", {"radius": radius, "threads": threads,
                                                    "gaussians_as_discs": not issubclass(cls, Gaussians)})
        call(lib.iso_surface_read_cloud, os.fsencode(path), opts, made)
        cloud = cls.__new__(cls)
        Locked.__init__(cloud)
        cloud._take(made[0], color, opacity)
        return cloud


class Gaussians(Cloud):
    """3-D Gaussians, which are the first thing of their picture. `axes` (n, 3, 3): the axes of each, with its standard
    deviations (mm) as lengths; `opacities` at their centres, 0 .. 1."""

    def __init__(self, positions: Any, axes: Any, *, opacities: Any = None, colors: Any = None,
                 origin: Floats = (0, 0, 0), color: Optional[Color] = None, threads: int = 0) -> None:
        self._of_arrays(positions, axes, None, None, colors, opacities, origin, {"threads": threads}, color, 1.0)


class _Shapes(Thing):
    """An iso_shape_set. It copies its arrays."""
    _set_look = lib.iso_shape_set_set_look

    def _make(self, function: Any, arrays: Any, options: "Dict[str, Any]", color: Optional[Color],
              opacity: float) -> None:
        made = ffi.new("iso_shape_set **")
        paint = rgb(color)
        call(function, arrays, ffi.new("iso_shape_set_opts *", {**options, "color": paint}), made)
        self._handle = owned(made[0], "iso_shape_set_destroy")
        self._look(color, opacity)

    @classmethod
    def _read(cls, function: Any, path: Path, options: "Dict[str, Any]", color: Optional[Color],
              opacity: float) -> Any:
        shapes = cls.__new__(cls)
        shapes._make(function, os.fsencode(path), options, color, opacity)
        return shapes

    def bounds(self) -> Box:
        """The least and the greatest corner of the box around it, mm."""
        return _box(lib.iso_shape_set_bounds(self._handle))


def _lent_mesh(vertices: Any, triangles: Any, keep: "list[Any]") -> Any:
    """An iso_mesh that borrows arrays, which `keep` keeps alive."""
    positions = np.ascontiguousarray(vertices, np.float32)
    corners = np.ascontiguousarray(triangles, np.uint32)
    if positions.ndim != 2 or positions.shape[1] != 3 or corners.ndim != 2 or corners.shape[1] != 3:
        raise usage(f"a mesh of arrays of shapes {positions.shape} and {corners.shape}: (n, 3) and (m, 3) are wanted")
    keep += [positions, corners]
    return ffi.new("iso_mesh *", {"positions": ffi.cast("float(*)[3]", positions.ctypes.data),
                                  "triangles": ffi.cast("uint32_t(*)[3]", corners.ctypes.data),
                                  "vertex_count": len(positions), "triangle_count": len(corners)})


class Lines(_Shapes):
    """Lines as tubes or ribbons. `lines`: arrays (n, 3) of vertices, mm. `radii` and `colors` are of all vertices, one
    after the other; `radius` mm, 0: chosen."""

    def __init__(self, lines: Iterable[Any], *, radius: float = 0.0, radii: Any = None, colors: Any = None,
                 ribbons: bool = False, color: Optional[Color] = None, opacity: float = 1.0) -> None:
        parts = [np.asarray(line, np.float32).reshape(-1, 3) for line in lines]
        starts = np.concatenate([[0], np.cumsum([len(p) for p in parts])])
        keep: "list[Any]" = []
        n = int(starts[-1])
        arrays = ffi.new("iso_line_arrays *", {
            "vertices": lent(np.concatenate(parts) if parts else np.empty((0, 3)), 3, "<f4", keep, "lines"),
            "starts": lent(starts, 0, "uintp", keep, "starts"), "line_count": len(parts),
            "radii": lent(radii, 0, "<f4", keep, "radii", n), "colors": lent(colors, 3, "u1", keep, "colors", n)})
        self._make(lib.iso_shape_set_of_lines, arrays, {"radius": radius, "ribbons": ribbons}, color, opacity)

    @classmethod
    def read(cls, path: Path, *, radius: float = 0.0, ribbons: bool = False, color: Optional[Color] = None,
             opacity: float = 1.0) -> "Lines":
        """Lines of a file: .tck, .trk, .swc, .vtk, .vtp and others."""
        lines: Lines = cls._read(lib.iso_shape_set_read_lines, path, {"radius": radius, "ribbons": ribbons}, color,
                                 opacity)
        return lines

    @classmethod
    def of_mesh(cls, vertices: Any, triangles: Any, *, color: Optional[Color] = None,
                opacity: float = 1.0) -> "list[Thing]":
        """A mesh of thin branches (a tree, vessels, neurites) as what can be drawn instead: Lines of its tubes, Lines of
        its leaves, which are ribbons, and a MeshItem of the pieces that are neither, those of them that there are.
        Vertices (n, 3) in mm, triangles (m, 3). EmptySurface: no piece is made of thin branches or is a leaf."""
        keep: "list[Any]" = []
        made = ffi.new("iso_branches *")
        call(lib.iso_branches_of_mesh, _lent_mesh(vertices, triangles, keep), made)
        things: "list[Thing]" = []
        try:
            for arrays, ribbons in ((made.tubes, False), (made.ribbons, True)):
                if arrays.line_count:
                    lines = cls.__new__(cls)
                    lines._make(lib.iso_shape_set_of_lines, ffi.addressof(arrays), {"ribbons": ribbons}, color, opacity)
                    things.append(lines)
            if made.rest.triangle_count:
                rest = MeshItem.__new__(MeshItem)
                rest._make(lib.iso_shape_set_of_mesh, ffi.addressof(made.rest), {}, color, opacity)
                things.append(rest)
        finally:
            lib.iso_branches_free(made)
        return things


class Glyphs(_Shapes):
    """A shape at each point: "sphere", "cone", "cylinder", "arrow", "ellipsoid", "disc" or "box". Positions,
    `directions` (n, 3) and half `axes` (n, 3, 3) are in mm."""

    def __init__(self, positions: Any, *, shape: str = "sphere", radii: Any = None, radius: float = 0.0,
                 directions: Any = None, axes: Any = None, colors: Any = None, color: Optional[Color] = None,
                 opacity: float = 1.0) -> None:
        keep: "list[Any]" = []
        n = len(positions)
        arrays = ffi.new("iso_glyph_arrays *", {
            "positions": lent(positions, 3, "<f4", keep, "positions"), "count": n,
            "radii": lent(radii, 0, "<f4", keep, "radii", n),
            "directions": lent(directions, 3, "<f4", keep, "directions", n),
            "axes": lent(axes if axes is None else np.reshape(axes, (-1, 9)), 9, "<f4", keep, "axes", n),
            "colors": lent(colors, 3, "u1", keep, "colors", n)})
        self._make(lib.iso_shape_set_of_glyphs, arrays, {"radius": radius, "glyph": one_of(_GLYPHS, shape, "shape")},
                   color, opacity)

    @classmethod
    def read(cls, path: Path, *, shape: str = "sphere", radius: float = 0.0, color: Optional[Color] = None,
             opacity: float = 1.0) -> "Glyphs":
        """Points of a file, or atoms of a molecule: .csv, .ply, .vtp, .pdb and others."""
        glyphs: Glyphs = cls._read(lib.iso_shape_set_read_glyphs, path,
                                   {"radius": radius, "glyph": one_of(_GLYPHS, shape, "shape")}, color, opacity)
        return glyphs


class MeshItem(_Shapes):
    """A triangle mesh beside surfaces: vertices (n, 3) in mm, triangles (m, 3)."""

    def __init__(self, vertices: Any, triangles: Any, *, color: Optional[Color] = None, opacity: float = 1.0) -> None:
        keep: "list[Any]" = []
        self._make(lib.iso_shape_set_of_mesh, _lent_mesh(vertices, triangles, keep), {}, color, opacity)

    @classmethod
    def read(cls, path: Path, *, color: Optional[Color] = None, opacity: float = 1.0) -> "MeshItem":
        """A mesh of a file: .stl, .obj, .ply, .off, .vtk or .vtp."""
        mesh: MeshItem = cls._read(lib.iso_shape_set_read_mesh, path, {}, color, opacity)
        return mesh

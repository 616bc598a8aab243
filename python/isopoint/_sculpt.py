"""Sculpting: a level set under brushes."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Iterable, Optional, Sequence, Union

import numpy as np

from ._core import Color, Floats, Path, call, one_of, owned, rgb, usage, vec3
from ._native import ffi, lib
from ._things import Surface
from ._volume import Volume

_TOOLS = {name.replace("_", "-").lower(): getattr(lib, "ISO_TOOL_" + name) for name in
          ("ADD", "CARVE", "BLEND_ADD", "BLEND_CARVE", "SMOOTH", "INFLATE", "DEFLATE", "FLATTEN", "SCRAPE", "FILL",
           "CLAY", "PINCH", "CREASE", "SNAKE_HOOK", "MOVE", "MASK", "UNMASK", "CLEAR_MASK", "INVERT_MASK", "BLUR_MASK", "MASK_VOXELS",
           "PAINT",
           "TRIM_PLANE", "TRIM_LASSO", "CROP_LASSO")}
_SOLIDS = {name.lower(): getattr(lib, "ISO_SOLID_" + name) for name in
           ("SPHERE", "BOX", "CAPSULE", "CYLINDER", "TORUS", "STAMP")}
_ALPHAS = {name.lower(): getattr(lib, "ISO_ALPHA_" + name) for name in ("NONE", "FIXED", "FOLLOWS")}
_AXES = {axis: axis.encode() for axis in "xyz"}
_FALLOFFS = {name.lower(): getattr(lib, "ISO_FALLOFF_" + name) for name in ("SMOOTH", "LINEAR", "CONSTANT")}


@dataclass
class Brush:
    """A brush. `tool`: "add", "carve", "blend-add", "blend-carve", "smooth", "inflate", "deflate", "flatten",
    "scrape", "fill", "clay", "pinch", "crease", "snake-hook", "move", "mask", "unmask", "clear-mask", "invert-mask",
    "blur-mask" (its border, over the radius), "paint", "trim-plane", "trim-lasso" or "crop-lasso"; `shape` of the first four: "sphere", "box", "capsule",
    "cylinder", "torus" or "stamp". Sizes in mm; `aspect` and `spacing` in radii; 0 means the usual. `symmetry`: "x",
    "yz" .., mirrored at planes through `mirror`; `radial`: that many images (2 to 32), turned around the `radial_axis`
    through it; `repeat`: (8, 3) are three rows of eight images, moved by multiples of the two vectors `repeat_by`. `color`: "#rrggbb", of the surface that "paint", the first four, "inflate", "fill" and "clay" make; None: it
    has no paint. The last three tools act when the stroke ends: they remove what is to the right of the line from its first
    position to its last, in the outline of its positions, or outside of that, for a viewer whom its normals point to. `alpha`, of "smooth" to "clay":
    "fixed" or "follows", if the greys of the picture that `Sculpt.set_stamp` has set weigh what they do, upright or turned along
    the stroke."""
    radius: float
    tool: str = "add"
    shape: str = "sphere"
    falloff: str = "smooth"
    strength: float = 0.0
    aspect: float = 0.0
    blend: float = 0.0
    spacing: float = 0.0
    symmetry: str = ""
    mirror: Floats = (0.0, 0.0, 0.0)
    pressure_radius: bool = False
    pressure_strength: bool = False
    color: Optional[Color] = None
    radial: int = 0
    radial_axis: str = "z"
    repeat: Sequence[int] = (0, 0)
    repeat_by: Sequence[Floats] = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    alpha: str = "none"

    @classmethod
    def _of(cls, b: Any) -> "Brush":
        def name(names: "dict[str, int]", value: int) -> str:
            return next(n for n, v in names.items() if v == value)
        return cls(b.radius, name(_TOOLS, b.tool), name(_SOLIDS, b.shape), name(_FALLOFFS, b.falloff), b.strength, b.aspect,
                   b.blend, b.spacing, "".join(a for i, a in enumerate("xyz") if b.symmetry >> i & 1),
                   (b.mirror.x, b.mirror.y, b.mirror.z), b.pressure_radius, b.pressure_strength,
                   "#%02x%02x%02x" % (b.color.r, b.color.g, b.color.b) if b.has_color else None,
                   b.radial, (b.radial_axis if b.radial_axis != b"\0" else b"z").decode(),
                   (b.repeat[0], b.repeat[1]), tuple((p.x, p.y, p.z) for p in b.repeat_by),
                   name(_ALPHAS, b.alpha))

    def _made(self) -> Any:
        return ffi.new("iso_brush *", {
            "tool": one_of(_TOOLS, self.tool, "tool"), "shape": one_of(_SOLIDS, self.shape, "shape"),
            "falloff": one_of(_FALLOFFS, self.falloff, "falloff"), "radius": self.radius, "strength": self.strength,
            "aspect": self.aspect, "blend": self.blend, "spacing": self.spacing, "mirror": vec3(self.mirror, "mirror"),
            "symmetry": sum(1 << "xyz".index(a) for a in set(self.symmetry)), "pressure_radius": self.pressure_radius,
            "pressure_strength": self.pressure_strength, "has_color": self.color is not None,
            "repeat": [int(n) for n in self.repeat], "repeat_by": [vec3(p, "repeat_by") for p in self.repeat_by],
            "alpha": one_of(_ALPHAS, self.alpha, "alpha"), "color": rgb(self.color or "000000")[0], "radial": self.radial, "radial_axis": one_of(_AXES, self.radial_axis,
                                                                                                 "radial_axis")})


@dataclass(frozen=True)
class Stroke:
    """A past stroke of a `Sculpt`: its number, from 1 as strokes begin; whether it is left out; its brush; its number of
    positions."""
    number: int
    muted: bool
    brush: Brush
    samples: int


class Sculpt:
    """A ball at the world's origin, to be sculpted. `shape` of its grid (z, y, x), voxels of `voxel` mm; `radius` mm, 0: a
    quarter of the grid. With a `size` (x, y, z) of its bounding box in mm it is a `solid` instead: "sphere", "box", "capsule",
    "cylinder" or "torus" (a ring of x, whose tube has the diameter z) along z, a box or cylinder with edges of the radius `round`,
    in a grid that suits it. `journal`: a stroke file, which keeps every stroke; it must not exist yet."""

    def __init__(self, *, voxel: float = 0.0, shape: Sequence[int] = (0, 0, 0), radius: float = 0.0,
                 solid: str = "sphere", size: Optional[Floats] = None, round: float = 0.0,
                 journal: Optional[Path] = None, threads: int = 0) -> None:
        self._create(lib.iso_sculpt_create, {"voxel_size": voxel, "dims": [int(n) for n in reversed(shape)],
                                             "radius": radius, "threads": threads,
                                             "solid": one_of(_SOLIDS, solid, "solid"), "round": round,
                                             "size": vec3((0, 0, 0) if size is None else size, "size")},
                     journal=journal)

    def _create(self, function: Any, options: "dict[str, Any]", *arguments: Any,
                journal: Optional[Path] = None) -> None:
        path = ffi.new("char[]", os.fsencode(journal)) if journal is not None else ffi.NULL
        made = ffi.new("iso_sculpt **")
        call(function, *arguments, ffi.new("iso_sculpt_opts *", {**options, "journal": path}), made)
        self._handle = owned(made[0], "iso_sculpt_destroy", to_the_last=True)  # (which completes the journal)
        borrowed = lib.iso_sculpt_volume(self._handle)
        self.volume = Volume._of(owned(borrowed, "iso_volume_destroy", self._handle))
        self.surface = Surface(self.volume, 0.0)

    @classmethod
    def _of(cls, function: Any, options: "dict[str, Any]", *arguments: Any) -> "Sculpt":
        sculpt = cls.__new__(cls)
        sculpt._create(function, options, *arguments)
        return sculpt

    @classmethod
    def from_volume(cls, volume: Volume, isovalue: float, *, voxel: float = 0.0, threads: int = 0) -> "Sculpt":
        """The solid that a volume has at an isovalue, of cubes of `voxel` mm (0: its smallest spacing)."""
        with volume._lock:
            return cls._of(lib.iso_sculpt_from_volume, {"voxel_size": voxel, "threads": threads}, volume._handle,
                           float(isovalue))

    @classmethod
    def replay(cls, path: Path, *, threads: int = 0) -> "Sculpt":
        """Plays a stroke file, and leaves it as it is."""
        return cls._of(lib.iso_sculpt_replay, {"threads": threads}, os.fsencode(path))

    @classmethod
    def resume(cls, path: Path, *, threads: int = 0) -> "Sculpt":
        """Plays a stroke file, and appends further strokes to it."""
        return cls._of(lib.iso_sculpt_resume, {"threads": threads}, os.fsencode(path))

    def stroke(self, brush: Brush, positions: Any, normals: Any = None, *,
               pressures: Union[float, Iterable[float]] = 1.0) -> int:
        """One stroke along positions (n, 3), mm; `normals`: unit vectors out of the solid, z by default. Returns the number
        of bricks that it edited while it was drawn. A stroke that fails or is interrupted leaves nothing behind."""
        at = np.atleast_2d(np.asarray(positions, float))
        up = np.broadcast_to(np.asarray((0, 0, 1) if normals is None else normals, float), at.shape)
        weights = np.broadcast_to(np.asarray(pressures, float), at.shape[:1])
        if at.ndim != 2 or at.shape[1] != 3 or not len(at):
            raise usage(f"a stroke along positions of shape {at.shape}: (n, 3) are wanted")
        stats = ffi.new("iso_edit_stats *")
        samples = [ffi.new("iso_sample *", [list(p), list(n), w, 0.0]) for p, n, w in zip(at, up, weights)]
        with self.volume._lock:
            call(lib.iso_sculpt_begin, self._handle, brush._made(), samples[0], stats)
            try:
                for sample in samples[1:]:
                    call(lib.iso_sculpt_sample, self._handle, sample, stats)
            except BaseException:
                lib.iso_sculpt_cancel(self._handle, ffi.NULL)
                raise
            try:
                call(lib.iso_sculpt_end, self._handle)
            except BaseException:
                lib.iso_sculpt_cancel(self._handle, ffi.NULL)
                raise
        return int(stats.edited)

    @property
    def strokes(self) -> "list[Stroke]":
        """The strokes that the field is made of, in the order in which they are drawn. None are known (and none can be
        edited) of a session that was resumed at a snapshot beside its stroke file."""
        out = ffi.new("iso_sculpt_stroke *")
        strokes = []
        with self.volume._lock:
            for i in range(lib.iso_sculpt_stroke_count(self._handle)):
                call(lib.iso_sculpt_get_stroke, self._handle, i, out)
                strokes.append(Stroke(out.number, out.muted, Brush._of(out.brush), out.samples))
        return strokes

    def edit(self, number: int, brush: Brush) -> None:
        """Gives a past stroke another brush. The field is then that of drawing all strokes anew, to the bit; an edit can
        be undone, and is in the journal. The same holds for `mute`, `unmute`, `delete` and `move`, which act on the strokes
        with the numbers `first` to `last` (by default `first` only)."""
        with self.volume._lock:
            call(lib.iso_sculpt_edit, self._handle, number, brush._made())

    def mute(self, first: int, last: Optional[int] = None) -> None:
        """Leaves strokes out."""
        with self.volume._lock:
            call(lib.iso_sculpt_mute, self._handle, first, last or first, True)

    def unmute(self, first: int, last: Optional[int] = None) -> None:
        """Draws strokes again that were left out."""
        with self.volume._lock:
            call(lib.iso_sculpt_mute, self._handle, first, last or first, False)

    def delete(self, first: int, last: Optional[int] = None) -> None:
        """Removes strokes."""
        with self.volume._lock:
            call(lib.iso_sculpt_delete, self._handle, first, last or first)

    def move(self, first: int, last: Optional[int] = None, *, before: int = 0) -> None:
        """Moves strokes: they are drawn before the stroke `before`, or (0) last."""
        with self.volume._lock:
            call(lib.iso_sculpt_move, self._handle, first, last or first, before)

    def path(self, number: int) -> "tuple[np.ndarray[Any, Any], np.ndarray[Any, Any]]":
        """The positions and normals of a past stroke, (n, 3) each, mm."""
        at, count = ffi.new("const iso_sample **"), ffi.new("size_t *")
        with self.volume._lock:
            call(lib.iso_sculpt_get_path, self._handle, number, at, count)
            numbers = np.frombuffer(bytes(ffi.buffer(at[0], count[0] * ffi.sizeof("iso_sample"))), float).reshape(-1, 8)
        return numbers[:, :3].copy(), numbers[:, 3:6].copy()

    def set_path(self, number: int, positions: Any, normals: Any = None) -> None:
        """Moves the path of a past stroke: as many positions as it has, and normals (None: it keeps its own)."""
        positions = np.asarray(positions, float)
        at, count = ffi.new("const iso_sample **"), ffi.new("size_t *")
        with self.volume._lock:
            call(lib.iso_sculpt_get_path, self._handle, number, at, count)
            if positions.shape != (count[0], 3):
                raise usage(f"stroke {number} has {count[0]} positions, not {positions.shape}")
            samples = ffi.new("iso_sample[]", count[0])
            ffi.memmove(samples, at[0], count[0] * ffi.sizeof("iso_sample"))
            numbers = np.frombuffer(ffi.buffer(samples), float).reshape(-1, 8)
            numbers[:, :3] = positions
            if normals is not None:
                numbers[:, 3:6] = normals
            call(lib.iso_sculpt_set_path, self._handle, number, samples, count[0])

    def reseat(self, first: int, last: Optional[int] = None) -> None:
        """Moves strokes along with the surface that edits of earlier strokes have moved from under them."""
        with self.volume._lock:
            call(lib.iso_sculpt_reseat, self._handle, first, last or first)

    def freeze(self, volume: Volume, isovalue: float) -> None:
        """Freezes the voxels in the solid that a volume has at an isovalue, as a stroke of its own, which can be undone; a
        stroke file keeps where they are."""
        with self.volume._lock, volume._lock:
            call(lib.iso_sculpt_freeze, self._handle, volume._handle, float(isovalue))

    def undo(self) -> None:
        """Undoes the last stroke or edit, exactly."""
        with self.volume._lock:
            call(lib.iso_sculpt_undo, self._handle)

    def redo(self) -> None:
        """Redoes the stroke or edit that was undone last, exactly."""
        with self.volume._lock:
            call(lib.iso_sculpt_redo, self._handle)

    @property
    def undo_count(self) -> int:
        """The number of strokes and edits that can be undone."""
        return int(lib.iso_sculpt_undo_count(self._handle))

    @property
    def redo_count(self) -> int:
        """The number of strokes and edits that can be redone."""
        return int(lib.iso_sculpt_redo_count(self._handle))

    def set_stamp(self, path: Path) -> None:
        """Sets the stamp: for the shape "stamp" the inside of a mesh (.stl, .obj, .ply), for a brush with `alpha` the greys
        of a picture (.png)."""
        with self.volume._lock:
            call(lib.iso_sculpt_set_stamp, self._handle, os.fsencode(path))

    def save_vdb(self, path: Path, name: str = "surface") -> None:
        """Writes the level set as .vdb."""
        with self.volume._lock:
            call(lib.iso_volume_write_vdb, self.volume._handle, os.fsencode(path), name.encode())

    def _repr_png_(self) -> bytes:
        return self.surface._repr_png_()

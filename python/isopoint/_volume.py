"""Volumes: arrays and files."""
from __future__ import annotations

import os
from contextlib import contextmanager
from typing import Any, Dict, Iterator, Optional, Sequence, Tuple

import numpy as np

from ._core import Array, FileError, Floats, Locked, Path, Progress, call, owned, telling, usage, vec3, view
from ._native import ffi, lib

_TYPES: "Dict[Any, Any]" = {np.dtype("u1"): lib.ISO_UINT8, np.dtype("<i2"): lib.ISO_INT16, np.dtype("<u2"): lib.ISO_UINT16,
          np.dtype("<f4"): lib.ISO_FLOAT32}
_KINDS: "Dict[Any, np.dtype[Any]]" = {number: kind for kind, number in _TYPES.items()}


def _storable(array: Array) -> Array:
    """The array in one of the types that the library stores: as it is, or a copy that loses as little as possible."""
    if array.dtype.newbyteorder("=") in _TYPES:
        return array if array.dtype.isnative else array.astype(array.dtype.newbyteorder("="))
    if array.dtype == np.bool_:
        return array.view(np.uint8)
    if array.dtype.kind in "iu" and array.size:
        low, high = int(array.min()), int(array.max())
        if low >= 0 and high <= 65535:
            return array.astype(np.uint16)
        return array.astype(np.int16 if low >= -32768 and high <= 32767 else np.float32)
    if array.dtype.kind == "f":
        return array.astype(np.float32)
    raise usage(f"an array of {array.dtype}: numbers are wanted")


class _Layout:
    """How an array lies in memory: `order`, its own axes from the fastest to the slowest, as numbers of x, y, z; and
    which of them run backwards. What cannot be lent as it lies is copied."""

    def __init__(self, array: Array, axes: str) -> None:
        self.axes = axes
        self.array = array
        if not self._find():
            self.array = np.ascontiguousarray(array)
            self._find()

    def _find(self) -> bool:
        size, strides, shape = self.array.itemsize, self.array.strides, self.array.shape
        at = [self.axes.index(a) for a in "xyz"]
        self.order = sorted(range(3), key=lambda a: (shape[at[a]] == 1, abs(strides[at[a]])))
        self.place = [at[a] for a in self.order]
        self.dims = [shape[p] for p in self.place]
        self.flips = [strides[p] < 0 for p in self.place]
        # (the stride of an axis with one voxel says nothing)
        steps = [abs(strides[p]) // size if n > 1 else 0 for p, n in zip(self.place, self.dims)]
        dense = [1, self.dims[0], max(self.dims[0], steps[1]) * self.dims[1]]
        self.steps = [s or d for s, d in zip(steps, dense)]
        return (0 not in shape and all(s % size == 0 for s in strides) and self.steps[0] == 1
                and self.steps[1] >= self.dims[0] and self.steps[2] >= self.steps[1] * self.dims[1])

    @property
    def first(self) -> int:
        """The address of the voxel that is the first in memory."""
        back = sum((n - 1) * self.array.strides[p] for p, n, f in zip(self.place, self.dims, self.flips) if f)
        return int(self.array.ctypes.data) + back

    def box(self, lo: Sequence[int], hi: Sequence[int]) -> Tuple["list[int]", "list[int]"]:
        """The voxels array[lo[0]:hi[0], ...] in the library's order, both ends included."""
        first, last = [], []
        for p, n, f in zip(self.place, self.dims, self.flips):
            a, b = int(lo[p]), int(hi[p]) - 1
            first.append(n - 1 - b if f else a)
            last.append(n - 1 - a if f else b)
        return first, last


class Volume(Locked):
    """A numpy array, or a file, with its place in the world.

    The array is not copied if it is of uint8, int16, uint16 or float32 and its fastest axis is dense, in whatever
    order its axes are and in whatever direction they run: keep it as long as the volume, and tell changes by
    `changed`. Other numbers are converted.

    `axes` names the array's axes: "zyx" is array[z, y, x], as SimpleITK, tifffile, zarr and h5py give it; "xyz" is
    array[x, y, z], as nibabel gives it. `spacing` (mm) and `origin` (mm, of voxel 0, 0, 0) are in the order x, y, z;
    the columns of `direction`, 3 x 3, are the directions of x, y and z in the world. `scale` and `offset` make
    physical values of stored ones; isovalues are physical. Of a `level_set` the values are distances in mm, negative
    inside. `threads`: 0 is one for each processor. A volume may be used by several threads, one after the other."""

    array: Array
    """The voxels: the array that was given or its copy; of a file a read-only view, [z, y, x]."""

    def __init__(self, array: Any, *, spacing: Optional[Floats] = None, origin: Optional[Floats] = None,
                 direction: Any = None, axes: str = "zyx", scale: float = 1.0, offset: float = 0.0,
                 level_set: bool = False, threads: int = 0) -> None:
        super().__init__()
        data = np.asarray(array)
        if data.ndim != 3:
            raise usage(f"an array of {data.ndim} dimensions: a volume has 3")
        if sorted(axes) != ["x", "y", "z"]:
            raise usage(f'axes "{axes}": "zyx" or "xyz" is wanted')
        if 0 in data.shape:
            raise usage(f"an array of shape {data.shape} has no voxels")
        layout = _Layout(_storable(data), axes)
        where = np.array(vec3(spacing if spacing is not None else (1, 1, 1), "spacing"))
        start = np.array(vec3(origin if origin is not None else (0, 0, 0), "origin"))
        columns = np.array(np.eye(3) if direction is None else direction, float).reshape(3, 3)[:, layout.order].copy()
        for i in range(3):
            if layout.flips[i]:
                start += columns[:, i] * where[layout.order[i]] * (layout.dims[i] - 1)
                columns[:, i] *= -1
        place = ffi.new("iso_transform *", {"origin": list(start), "spacing": [where[a] for a in layout.order],
                                            "direction": list(columns.ravel())})
        opts = ffi.new("iso_lend_opts *", {
            "dims": layout.dims, "type": _TYPES[layout.array.dtype.newbyteorder("=")], "scale": scale,
            "offset": offset, "data": ffi.cast("void *", layout.first), "stride_y": layout.steps[1],
            "stride_z": layout.steps[2], "transform": place, "level_set": level_set, "threads": threads})
        made = ffi.new("iso_volume **")
        try:
            call(lib.iso_volume_lend, opts, made)
        except FileError as failure:  # the format of what was given, not of a file
            raise usage(str(failure)) from None
        self._handle = owned(made[0], "iso_volume_destroy", layout.array)
        self._layout: Optional[_Layout] = layout
        self.array = layout.array

    @classmethod
    def _of(cls, handle: Any) -> "Volume":
        """A volume of the library's, dense or sparse."""
        volume = cls.__new__(cls)
        Locked.__init__(volume)
        volume._handle, volume._layout = handle, None
        seen = ffi.new("iso_voxels *")
        if lib.iso_volume_voxels(handle, seen, ffi.NULL) == lib.ISO_OK:
            kind = _KINDS[seen.type]
            x, y, z = seen.dims
            steps = (seen.stride_z * kind.itemsize, seen.stride_y * kind.itemsize, kind.itemsize)
            volume.array = view(seen.data, (z, y, x), kind.str, handle, True, steps)
        return volume

    @classmethod
    def open(cls, path: Path, *, grid: Optional[str] = None, series: Optional[str] = None, component: int = 0,
             level: int = 0, spacing: Optional[Floats] = None, max_memory: int = 0, threads: int = 0,
             progress: Optional[Progress] = None) -> "Volume":
        """Reads a file, such as NRRD, MetaImage, DICOM or raw; which others depends on how the library was built.
        `grid`, `series`, `component` and `level` choose among several. `progress` is called with 0 .. 1, and cancels
        by returning True."""
        texts = [ffi.new("char[]", t.encode()) if t else ffi.NULL for t in (grid, series)]
        made = ffi.new("iso_volume **")
        with telling(progress) as context:
            opts = ffi.new("iso_open_opts *", {
                "grid": texts[0], "series": texts[1], "component": component, "level": level,
                "spacing": vec3(spacing or (0, 0, 0), "spacing"), "max_memory": max_memory, "threads": threads,
                "progress": lib.isopoint_progress, "progress_context": context})
            call(lib.iso_volume_open, os.fsencode(path), opts, made)
        return cls._of(owned(made[0], "iso_volume_destroy"))

    @classmethod
    def from_nibabel(cls, image: Any, **options: Any) -> "Volume":
        """A nibabel image, of which stored values are not converted; in LPS, as the world is."""
        if len(image.shape) != 3:
            raise usage(f"an image of shape {tuple(image.shape)}: choose one of its volumes (image.slicer)")
        affine = np.diag([-1.0, -1.0, 1.0, 1.0]) @ np.asarray(image.affine, float)
        spacing = np.linalg.norm(affine[:3, :3], axis=0)
        stored = image.dataobj
        slope, inter = (float(getattr(stored, name, usual)) for name, usual in (("slope", 1.0), ("inter", 0.0)))
        if slope > 0 and hasattr(stored, "get_unscaled"):
            data = stored.get_unscaled()
        else:
            data, slope, inter = np.asanyarray(stored), 1.0, 0.0
        return cls(data, axes="xyz", spacing=spacing.tolist(), origin=affine[:3, 3].tolist(),
                   direction=affine[:3, :3] / spacing, scale=slope, offset=inter, **options)

    @classmethod
    def from_sitk(cls, image: Any, **options: Any) -> "Volume":
        """A SimpleITK image of three dimensions, whose voxels are not copied."""
        import SimpleITK  # type: ignore[import]
        array = SimpleITK.GetArrayViewFromImage(image)
        array.flags.writeable = False
        return cls(array, spacing=image.GetSpacing(), origin=image.GetOrigin(),
                   direction=np.reshape(image.GetDirection(), (3, 3)), **options)

    @contextmanager
    def _working(self, progress: Optional[Progress]) -> Iterator[None]:
        """Uses the volume, and lets `progress` and Ctrl-C cancel."""
        with self._lock, telling(progress) as context:
            lib.iso_volume_set_progress(self._handle, lib.isopoint_progress, context)
            try:
                yield
            finally:
                lib.iso_volume_set_progress(self._handle, ffi.NULL, ffi.NULL)

    @property
    def shape(self) -> Tuple[int, ...]:
        """Of the array; of a file (z, y, x)."""
        if self._layout is not None:
            return tuple(self._layout.array.shape)
        x, y, z = lib.iso_volume_describe(self._handle).dims
        return z, y, x

    @property
    def format(self) -> str:
        """The format of the file, such as "nrrd"; of an array "lent"."""
        return str(ffi.string(lib.iso_volume_describe(self._handle).format).decode())

    def suggest(self, progress: Optional[Progress] = None) -> float:
        """An isovalue that divides the histogram (Otsu's); 0 of a level set."""
        value = ffi.new("double *")
        with self._working(progress):
            call(lib.iso_volume_suggest, self._handle, value)
        return float(value[0])

    def histogram(self, progress: Optional[Progress] = None) -> Tuple[Array, Array]:
        """Counts and edges of 256 bins, as numpy.histogram gives them, of physical values without padding."""
        h = ffi.new("iso_histogram *")
        with self._working(progress):
            call(lib.iso_volume_histogram, self._handle, h)
        counts = np.array(list(h.bins), np.int64)
        return counts, h.low + h.width * np.arange(len(counts) + 1)

    def changed(self, lo: Optional[Sequence[int]] = None, hi: Optional[Sequence[int]] = None) -> None:
        """Tells that voxels array[lo[0]:hi[0], lo[1]:hi[1], lo[2]:hi[2]] have changed (all by default). Surfaces
        follow at their next use, by what changed."""
        if self._layout is None:
            raise usage("only arrays change")
        first, last = self._layout.box(lo if lo is not None else (0, 0, 0), hi if hi is not None else self.shape)
        with self._lock:
            call(lib.iso_volume_changed, self._handle, first, last)

    def __repr__(self) -> str:
        kind = _KINDS[lib.iso_volume_describe(self._handle).type]
        return f"<isopoint.Volume {self.format} {' x '.join(map(str, self.shape))} {kind}>"

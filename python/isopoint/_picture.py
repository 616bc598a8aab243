"""Pictures, and how they are taken."""
from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Dict, Iterable, List, Optional, Sequence, Tuple, Union

import numpy as np

from ._core import (Array, Color, Floats, Locked, Path, Progress, all_locked, call, one_of, owned, rgb, telling,
                    usage, vec3, view)
from ._native import ffi, lib
from ._things import Thing, _Shapes, _Surfaces
from ._volume import Volume

_SIDES = {"front": lib.ISO_FRONT, "back": lib.ISO_BACK, "left": lib.ISO_LEFT, "right": lib.ISO_RIGHT,
          "top": lib.ISO_TOP, "bottom": lib.ISO_BOTTOM, "iso": lib.ISO_ISOMETRIC}
_CAPS = {"none": lib.ISO_CUT_CAP_NONE, "surface": lib.ISO_CUT_CAP_SURFACE, "slice": lib.ISO_CUT_CAP_SLICE}
_FILTERS = {"linear": lib.ISO_FILTER_LINEAR, "cubic": lib.ISO_FILTER_CUBIC,
            "interpolating": lib.ISO_FILTER_INTERPOLATING}
_TRANSPARENCIES = {"sorted": lib.ISO_TRANSPARENCY_SORTED, "groups": lib.ISO_TRANSPARENCY_GROUPS,
                   "nearest": lib.ISO_TRANSPARENCY_NEAREST}
_REFRACTIONS = {"auto": lib.ISO_REFRACTION_AUTO, "none": lib.ISO_REFRACTION_NONE,
                "single": lib.ISO_REFRACTION_SINGLE, "layers": lib.ISO_REFRACTION_LAYERS,
                "two-sided": lib.ISO_REFRACTION_TWO_SIDED, "traced": lib.ISO_REFRACTION_TRACED}
_MARKS = ("scale", "orientation", "anatomical")


@dataclass
class Camera:
    """A view from a side, turned (degrees) and enlarged, which shows everything; or, with `position`, a camera as VTK's
    (mm), of which `view_angle` is the full vertical angle and `parallel_scale` half the height of the picture."""
    side: str = "front"
    azimuth: float = 0.0
    elevation: float = 0.0
    zoom: float = 1.0
    view_angle: float = 30.0
    orthographic: bool = False
    turns: int = 1
    """Everything fits into so many views, evenly spaced in azimuth: the framing of a turntable."""
    up: Floats = (0.0, 0.0, 1.0)
    position: Optional[Floats] = None
    focal_point: Floats = (0.0, 0.0, 0.0)
    view_up: Floats = (0.0, 0.0, 1.0)
    parallel_scale: float = 1.0

    def _fit(self, keep: "List[Any]") -> "Dict[str, Any]":
        up = ffi.new("iso_vec3 *", vec3(self.up, "up"))
        keep.append(up)
        return {"direction": one_of(_SIDES, self.side, "camera"), "azimuth": self.azimuth, "up": up,
                "elevation": self.elevation, "zoom": self.zoom, "turns": self.turns, "view_angle": self.view_angle,
                "orthographic": self.orthographic}

    def _fixed(self) -> Any:
        """An iso_camera; NULL: it is fitted."""
        if self.position is None:
            return ffi.NULL
        return ffi.new("iso_camera *", [vec3(self.position, "position"), vec3(self.focal_point, "focal_point"),
                                        vec3(self.view_up, "view_up"), self.view_angle, self.orthographic,
                                        self.parallel_scale])

    @classmethod
    def _of(cls, c: Any) -> "Camera":
        p, f, u = ((v.x, v.y, v.z) for v in (c.position, c.focal_point, c.view_up))
        return cls(position=p, focal_point=f, view_up=u, view_angle=c.view_angle, orthographic=c.orthographic,
                   parallel_scale=c.parallel_scale)


@dataclass
class Glass:
    """A solid of glass: index of refraction, dispersion (Abbe number; 0: none), the colour that white light has after
    `distance` mm in it (0: clear), and the picture that it reflects and refracts (.exr, .png; None: a studio)."""
    ior: float = 1.5
    refraction: str = "auto"
    dispersion: float = 0.0
    color: Color = "FFFFFF"
    distance: float = 0.0
    surface_opacity: float = 0.0
    environment: Optional[Path] = None

    def _opts(self, keep: "List[Any]") -> Any:
        path = ffi.new("char[]", os.fsencode(self.environment)) if self.environment is not None else ffi.NULL
        keep.append(path)
        return ffi.new("iso_glass_opts *", {
            "ior": self.ior, "refraction": one_of(_REFRACTIONS, self.refraction, "refraction"),
            "dispersion": self.dispersion, "attenuation_color": rgb(self.color)[0], "environment": path,
            "attenuation_distance": self.distance, "surface_opacity": self.surface_opacity})


@dataclass
class Look:
    """How things are lit and seen through: a soft shadow; the width of outlines, pixels; of what is translucent the same
    opacity at every angle, the length (mm) after which 1/e of the light is left in the solid (0: it is clear), the
    number of layers (0: all), and how splats are composited; glass."""
    shadow: bool = False
    outline: float = 0.0
    constant_opacity: bool = False
    absorption: float = 0.0
    layers: int = 0
    transparency: str = "sorted"
    glass: Optional[Glass] = None


class Picture:
    """A picture. `array` (height, width, 4), uint8, row 0 at the top, is the library's memory; rendered with aov=True it
    also has numbers: `depth`, `normal`, `coverage`, `ids`. `camera` is the one that took it."""

    def __init__(self, image: Any, aov: Any = None, camera: Optional[Camera] = None) -> None:
        self._image, self._aov = image, aov
        self.camera = camera
        self.array = view(image.rgba, (image.height, image.width, 4), "|u1", image)

    @classmethod
    def read(cls, path: Path) -> "Picture":
        """A PNG."""
        image = ffi.gc(ffi.new("iso_image *"), lib.iso_image_free)
        call(lib.iso_image_read, os.fsencode(path), image)
        return cls(image)

    @property
    def size(self) -> Tuple[int, int]:
        """Width and height, pixels."""
        return int(self._image.width), int(self._image.height)

    def __array__(self, dtype: Any = None) -> Array:
        return self.array if dtype is None else self.array.astype(dtype)

    def _plane(self, name: str, number: int = -1, kind: str = "<f4") -> Array:
        pointer = getattr(self._aov, name) if self._aov is not None else ffi.NULL
        if pointer != ffi.NULL and number >= 0:
            pointer = pointer[number]
        if pointer == ffi.NULL:
            raise usage(f"the picture has no {name}: render(.., aov=True) gives it; ids are of lines, glyphs and meshes")
        return view(pointer, (self._aov.height, self._aov.width), kind, self._aov)

    @property
    def depth(self) -> Array:
        """mm along the view; inf where nothing is."""
        return self._plane("depth")

    @property
    def normal(self) -> Array:
        """(height, width, 3), in the world, out of the solid; a copy."""
        return np.stack([self._plane("normal", i) for i in range(3)], -1)

    @property
    def coverage(self) -> Array:
        """The share of each pixel that something covers."""
        return self._plane("coverage")

    def ids(self, which: str = "thing") -> Array:
        """Numbers from 1 of the nearest "thing" of a pixel (surfaces, then the others), of its "element" (glyph, line or
        triangle), or of the "segment" of a line; 0: none."""
        numbers = {"thing": 0, "element": 1, "segment": 2}
        return self._plane("ids", int(one_of(numbers, which, "ids")), "<u4")

    def save(self, path: Path) -> None:
        """Writes a PNG; a name that ends in .exr: depth, normals, coverage and ids as OpenEXR."""
        if os.fspath(path).endswith(".exr"):
            self._plane("depth")
            call(lib.iso_aov_write, self._aov, os.fsencode(path))
        else:
            call(lib.iso_image_write, self._image, os.fsencode(path))

    def compare(self, other: "Picture") -> "Dict[str, float]":
        """How far another picture is from this one: psnr, ssim, flip, pixels_differing .."""
        found = ffi.new("iso_difference *")
        call(lib.iso_compare_images, self._image, other._image, ffi.NULL, found)
        return {name: getattr(found, name) for name, _ in ffi.typeof("iso_difference").fields}

    def _repr_png_(self) -> bytes:
        data, size = ffi.new("uint8_t **"), ffi.new("size_t *")
        call(lib.iso_image_encode, self._image, data, size)
        try:
            return bytes(ffi.buffer(data[0], size[0]))
        finally:
            lib.iso_bytes_free(data[0])

    def __repr__(self) -> str:
        return f"<isopoint.Picture {self.size[0]} x {self.size[1]}>"


def _method(name: str) -> Any:
    found = ffi.new("iso_method *")
    call(lib.iso_method_find, name.encode(), found)
    return found[0]


def _chosen(camera: Union[Camera, str, None]) -> Camera:
    return Camera(side=camera) if isinstance(camera, str) else camera or Camera()


def _annotate(image: Any, camera: Any, marks: Sequence[str], light: bool) -> None:
    for mark in marks:
        if mark not in _MARKS:
            raise usage(f"mark {mark!r}: one of {', '.join(_MARKS)} is wanted")
    call(lib.iso_image_annotate, image, ffi.new("iso_annotation_opts *", {
        "camera": camera, "scale_bar": "scale" in marks, "orientation_marker": len(set(marks) - {"scale"}) > 0,
        "anatomical": "anatomical" in marks, "light": light}))


def render(things: Union[Thing, Iterable[Thing]], *, size: Tuple[int, int] = (1024, 1024),
           camera: Union[Camera, str, None] = None, samples: int = 0, method: str = "exact",
           look: Optional[Look] = None, clip: Union[str, Sequence[str]] = (), cap: str = "none",
           cap_values: Tuple[float, float] = (0.0, 0.0), occlusion: Union[bool, float] = False,
           background: Optional[Color] = None, transparent: bool = False, marks: Sequence[str] = (),
           filter: str = "linear", lod: float = 0.0, aov: bool = False, threads: int = 0, progress: Optional[Progress] = None) -> Picture:
    """A picture of surfaces, clouds, lines, glyphs and meshes; the same bytes as isorender's.

    `camera`: a Camera, or a side: "front", "back", "left", "right", "top", "bottom", "iso". `samples` of a pixel: 1, 4,
    9 .. 64; 0: the method's. `method`: "exact", "mesh", "pullpush", "splats", "raycast" .. `clip`: what is cut away, as
    isorender's --clip says it ("x<12", "keep:sphere:X,Y,Z,R"), closed by `cap`: "none", "surface" or "slice" (in greys
    of `cap_values`). `occlusion`: mm, or True for a usual range. `filter`: "linear", or of smooth surfaces by
    "exact" and "raycast" "cubic" or "interpolating". `marks`: "scale" (of orthographic cameras),
    "orientation", "anatomical". `lod`: pixels that levels of detail may err. `threads`: of pictures without surfaces.
    `progress` is called with 0 .. 1, and cancels by returning True."""
    things = [things] if isinstance(things, Thing) else list(things)
    surfaces = [t for t in things if isinstance(t, _Surfaces)]
    shapes = [t._handle for t in things if isinstance(t, _Shapes)]
    for thing in things:
        if not isinstance(thing, (_Surfaces, _Shapes)):
            raise usage(f"a {type(thing).__name__} is not drawn: surfaces, clouds, lines, glyphs and meshes are")
    keep: "List[Any]" = []
    camera, look = _chosen(camera), look or Look()
    image = ffi.gc(ffi.new("iso_image *"), lib.iso_image_free)
    planes = ffi.gc(ffi.new("iso_aov *"), lib.iso_aov_free) if aov else None
    colorings = [s.color_by._opts(i, keep) for i, s in enumerate(surfaces) if s.color_by]
    clips = [ffi.new("char[]", c.encode()) for c in ([clip] if isinstance(clip, str) else clip)]
    used = ffi.new("iso_camera *")
    sets, texts = ffi.new("iso_shape_set *[]", shapes), ffi.new("char *[]", clips)
    by, paint, how = ffi.new("iso_color_by[]", colorings), rgb(background), camera._fixed()
    glass = look.glass._opts(keep) if look.glass else ffi.NULL
    options = {
        "method": _method(method), "width": int(size[0]), "height": int(size[1]), "samples": samples, "camera": how,
        "fit": camera._fit(keep), "background": paint, "transparent": transparent,
        "constant_opacity": look.constant_opacity, "absorption_length": look.absorption, "most_layers": look.layers,
        "transparency": one_of(_TRANSPARENCIES, look.transparency, "transparency"), "glass": glass,
        "shadow": look.shadow, "outline": look.outline, "shapes": sets, "shapes_count": len(shapes), "lod": lod,
        "aov": planes if planes is not None else ffi.NULL, "clips": texts, "clip_count": len(clips),
        "cap": one_of(_CAPS, cap, "cap"), "cap_values": list(cap_values),
        "filter": one_of(_FILTERS, filter, "filter"),
        "occlusion": -1.0 if occlusion is True else float(occlusion), "color_by": by,
        "color_by_count": len(colorings), "camera_used": used, "threads": threads}
    locks: "List[Locked]" = [s.volume if s.volume is not None else s for s in surfaces]
    locks += [s.color_by.volume for s in surfaces if s.color_by and s.color_by.volume]
    handles = ffi.new("iso_surface *[]", [s._handle for s in surfaces])
    with all_locked(locks), telling(progress) as context:
        options.update(progress=lib.isopoint_progress, progress_context=context)
        call(lib.iso_render_surfaces, handles, len(surfaces), ffi.new("iso_render_opts *", options), image)
    if marks:
        dark = background is not None and sum(b for b in (paint.r, paint.g, paint.b)) < 3 * 128
        _annotate(image, used, marks, dark)
    return Picture(image, planes, Camera._of(used))



class Keys:
    """A picture in parts, of a volume that is larger than memory or is divided among processes: `draw` each part, `merge`
    what others have drawn, `show`. With all parts it has the bytes of `render`."""

    def __init__(self, shape: Sequence[int], isovalue: float, camera: Camera, *, size: Tuple[int, int] = (1024, 1024),
                 spacing: Floats = (1, 1, 1), origin: Floats = (0, 0, 0), method: str = "exact", samples: int = 0,
                 color: Optional[Color] = None, background: Optional[Color] = None, threads: int = 0) -> None:
        """`shape` of the whole, (z, y, x); `camera` has a position; `method`: "exact", "pullpush" or "pullpush-box"."""
        place = ffi.new("iso_transform *", {"origin": vec3(origin, "origin"), "spacing": vec3(spacing, "spacing"),
                                            "direction": [1, 0, 0, 0, 1, 0, 0, 0, 1]})
        fixed, paint, ground = camera._fixed(), rgb(color), rgb(background)
        self._create(lib.iso_keys_create, ffi.new("iso_keys_opts *", {
            "dims": [int(n) for n in reversed(shape)], "transform": place, "isovalue": isovalue,
            "method": _method(method), "width": size[0], "height": size[1], "samples": samples, "camera": fixed,
            "color": paint, "background": ground, "threads": threads}))

    def _create(self, function: Any, *arguments: Any) -> None:
        made = ffi.new("iso_keys **")
        call(function, *arguments, made)
        self._handle = owned(made[0], "iso_keys_destroy")

    @classmethod
    def read(cls, paths: Sequence[Path], *, threads: int = 0) -> "Keys":
        """Merges key files of all parts."""
        keys = cls.__new__(cls)
        names = [ffi.new("char[]", os.fsencode(p)) for p in paths]
        keys._create(lib.iso_keys_read, ffi.new("char *[]", names), len(names), 0, threads)
        return keys

    def _use(self, function: Any, volume: Volume, at: Sequence[int], first: Sequence[int],
             end: Sequence[int]) -> None:
        part = ffi.new("iso_keys_part *", {"volume": volume._handle, "origin": list(reversed(at)),
                                           "first": list(reversed(first)), "end": list(reversed(end))})
        with volume._lock:
            call(function, self._handle, part)

    def survey(self, volume: Volume, at: Sequence[int], first: Sequence[int], end: Sequence[int]) -> None:
        """Of the method "pullpush": looks at a part, before the first is drawn."""
        self._use(lib.iso_keys_survey, volume, at, first, end)

    def draw(self, volume: Volume, at: Sequence[int], first: Sequence[int], end: Sequence[int]) -> None:
        """Draws voxels first .. end - 1 (z, y, x) of the whole: multiples of 16, or its end. `volume`, an array [z, y, x]
        whose voxel 0 is voxel `at` of the whole, has a voxel more before and two more after them, where there are."""
        self._use(lib.iso_keys_draw, volume, at, first, end)

    def merge(self, other: "Keys") -> None:
        """Adds what another picture of the same shows."""
        call(lib.iso_keys_merge, self._handle, other._handle)

    def show(self) -> Picture:
        """The picture of what was drawn so far."""
        image = ffi.gc(ffi.new("iso_image *"), lib.iso_image_free)
        call(lib.iso_keys_show, self._handle, image)
        return Picture(image)

    def save(self, path: Path, part: int = 1, parts: int = 1) -> None:
        """Writes a key file, which isorender merge reads too."""
        call(lib.iso_keys_write, self._handle, part, parts, os.fsencode(path))

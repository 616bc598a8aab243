"""Isosurfaces of numpy arrays and volume files as pictures, points and meshes.

    import isopoint
    isopoint.Surface(array, 500, spacing=(0.5, 0.5, 1.0)).render().save("picture.png")

World coordinates are mm, LPS; arrays are [z, y, x] unless `axes` says otherwise. Failures are `Error`s, of the classes
below; Ctrl-C works during long calls, and other threads of Python run meanwhile."""
from ._core import EmptySurface, Error, FileError, NoMemory, UnsupportedError, UsageError, version
from ._picture import Camera, Glass, Keys, Look, Picture, render
from ._scene import Scene
from ._sculpt import Brush, Sculpt, Stroke
from ._things import (Cloud, ColorBy, Gaussians, Glyphs, Labels, Lines, Mesh, MeshItem, Points, Surface, Thing)
from ._volume import Volume

__version__ = version()
__all__ = ["Brush", "Camera", "Cloud", "ColorBy", "EmptySurface", "Error", "FileError", "Gaussians", "Glass", "Glyphs",
           "Keys", "Labels", "Lines", "Look", "Mesh", "MeshItem", "NoMemory", "Picture", "Points", "Scene", "Sculpt",
           "Stroke", "Surface", "Thing", "UnsupportedError", "UsageError", "Volume", "render", "version"]

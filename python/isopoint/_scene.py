"""Scene files: pictures as data, of the program isorender."""
from __future__ import annotations

import os
from typing import Any, Dict, Iterable, List, Optional, Tuple, Union

from ._core import FileError, Path, UnsupportedError, UsageError
from ._picture import Picture

Option = Tuple[str, Union[str, bool]]
_CLASSES = {2: UsageError}


class Scene:
    """A picture as data: the input file and every option by its long name, as the program isorender has them
    (docs/scenes.md). It is drawn by that program, which must be installed: the options are its own.

        scene = isopoint.Scene("head.nii.gz", isovalue=500, camera="left")
        scene.save("head.json")           # isorender head.json draws the same
        isopoint.Scene.load("head.png")   # a picture of isorender holds its scene

    Options are in their order: some can be given several times."""

    def __init__(self, input: Optional[Path] = None, options: Iterable[Option] = (), **named: Any) -> None:
        """Of `named`, "_" stands for "-", True for an option without a value, and a list for several of one."""
        self.input = None if input is None else os.fspath(input)
        self.options: List[Option] = list(options)
        self._folder = "."
        for name, value in named.items():
            for each in value if isinstance(value, (list, tuple)) else [value]:
                self.options.append((name.replace("_", "-"), True if each is True else str(each)))

    @classmethod
    def load(cls, path: Path) -> "Scene":
        """Of a scene file, or of a PNG that holds one."""
        import json
        with open(path, "rb") as stream:
            data = stream.read()
        text = _scene_of_png(data) if data.startswith(b"\x89PNG") else data
        try:
            made = json.loads(text or b"")
            scene = cls(made.get("input"), [next(iter(o.items())) for o in made["options"]])
            if made["scene"] != 1:
                raise ValueError
        except (ValueError, KeyError, TypeError, AttributeError, StopIteration):
            raise FileError(f"{os.fspath(path)}: there is no scene in it") from None
        scene._folder = os.path.dirname(os.path.abspath(path))
        return scene

    def save(self, path: Path) -> None:
        """Writes a scene file, whose paths begin at its folder: by isorender, which checks all options."""
        from tempfile import TemporaryDirectory  # (imported when needed: the package is there sooner)
        with TemporaryDirectory() as folder:
            self._run("--save-scene", os.path.abspath(path), "--output", os.path.join(folder, "picture.png"))

    def render(self, **named: Any) -> Picture:
        """The picture, with further options."""
        from tempfile import TemporaryDirectory
        with TemporaryDirectory() as folder:
            path = os.path.join(folder, "picture.png")
            self._run("--output", path, *_arguments(Scene(None, **named).options))
            return Picture.read(path)

    def _run(self, *arguments: str) -> None:
        import shutil
        import subprocess
        program = os.environ.get("ISORENDER") or shutil.which("isorender")
        if not program:
            raise UnsupportedError("scenes are drawn by the program isorender, which is not on the PATH")
        inputs = [] if self.input is None else ["--", self.input]
        done = subprocess.run([program, "--quiet", *_arguments(self.options), *arguments, *inputs], cwd=self._folder,
                              capture_output=True, text=True, errors="replace")
        if done.returncode:
            text = done.stderr.strip().splitlines()
            raise _CLASSES.get(done.returncode, FileError)(text[-1] if text else f"isorender: {done.returncode}")

    def _repr_png_(self) -> bytes:
        return self.render()._repr_png_()


def _arguments(options: Iterable[Option]) -> List[str]:
    return [f"--{name}" if value is True else f"--{name}={value}" for name, value in options]


def _scene_of_png(data: bytes) -> Optional[bytes]:
    import struct
    at = 8
    while at + 12 <= len(data):
        size, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        if name in (b"tEXt", b"iTXt") and body.startswith(b"Scene\0"):
            return body[6:] if name == b"tEXt" else body.split(b"\0", 5)[-1]
        at += size + 12
    return None

"""What all classes share: errors, ownership, progress, arrays in memory of the library."""
from __future__ import annotations

import atexit
import os
import sys
import threading
import time
from contextlib import ExitStack, contextmanager
from typing import Any, Callable, Iterable, Iterator, Optional, Sequence, Tuple, Union

import numpy as np
import numpy.typing as npt

from ._native import ffi, lib

Color = Union[str, Sequence[int]]
Progress = Callable[[float], Optional[bool]]
Floats = Sequence[float]
Array = npt.NDArray[Any]
Path = Union[str, "os.PathLike[str]"]


def version() -> str:
    """The version of the library that runs, such as "0.1.0"."""
    return str(ffi.string(lib.iso_version()).decode())


# ---- errors
class Error(Exception):
    """A failure, in the library's words. `status` is its iso_status."""
    status: int = 0


class UsageError(Error, ValueError):
    """An argument is out of its range, or arguments do not fit together."""


class FileError(Error, OSError):
    """A file is missing, damaged, of an unexpected format or cannot be written; or `progress` returned true."""


class EmptySurface(Error, ValueError):
    """There is no surface at the isovalue, or nothing of it is in view."""


class NoMemory(Error, MemoryError):
    """Memory ran out."""


class UnsupportedError(Error, NotImplementedError):
    """What this needs was not built in, or is not installed."""


_CLASSES = {lib.ISO_ERR_USAGE: UsageError, lib.ISO_ERR_MISMATCH: UsageError, lib.ISO_ERR_LIMIT: UsageError,
            lib.ISO_ERR_IO: FileError, lib.ISO_ERR_FORMAT: FileError, lib.ISO_ERR_BRIDGE: FileError,
            lib.ISO_ERR_WRITE: FileError, lib.ISO_ERR_NOMEM: NoMemory, lib.ISO_ERR_EMPTY: EmptySurface,
            lib.ISO_ERR_UNSUPPORTED: UnsupportedError, lib.ISO_ERR_BACKEND: UnsupportedError}


def usage(text: str) -> UsageError:
    error = UsageError(text)
    error.status = int(lib.ISO_ERR_USAGE)
    return error


def call(function: Any, *arguments: Any) -> None:
    """Calls a function of the header whose last parameter is the iso_error. Other threads run meanwhile."""
    error = ffi.new("iso_error *")
    status = function(*arguments, error)
    if status == lib.ISO_OK:
        return
    text = ffi.string(error.text).decode() or ffi.string(lib.iso_status_text(status)).decode()
    failure: Error = _CLASSES.get(status, Error)(text)
    failure.status = int(status)
    raise failure


# ---- progress and Ctrl-C
class _Told:
    """What the library's calls of a progress function go to. It keeps what the function raises (or a signal, such as
    KeyboardInterrupt, meanwhile) until the library has returned."""

    def __init__(self, tell: Optional[Progress]) -> None:
        self.tell = tell
        self.raised: Optional[BaseException] = None
        self.handle = ffi.new_handle(self)

    running = 0
    ended = False

    def check(self) -> None:
        if self.raised is not None:
            raise self.raised


_counting = threading.Lock()


def _failed(kind: Any, value: BaseException, trace: Any) -> int:
    if trace is not None:
        ffi.from_handle(trace.tb_frame.f_locals["context"]).raised = value
    return 1


@ffi.def_extern(name="isopoint_progress", onerror=_failed, error=1)  # type: ignore[misc]
def _progress(context: Any, fraction: float) -> int:
    told = ffi.from_handle(context)
    if _Told.ended:
        return 1
    if fraction < 0 or told.tell is None:
        return 0
    return 1 if told.tell(fraction) else 0


@atexit.register
def _end() -> None:
    """Cancels what other threads have called, as Python's functions cannot be called when the interpreter has ended."""
    _Told.ended = True
    last = time.monotonic() + 5
    while _Told.running and time.monotonic() < last:
        time.sleep(0.01)


@contextmanager
def telling(progress: Optional[Progress]) -> Iterator[Any]:
    """Gives a context for isopoint_progress; an exception of the function replaces the library's."""
    told = _Told(progress)
    with _counting:
        _Told.running += 1
    try:
        yield told.handle
    except FileError:
        told.check()
        raise
    finally:
        with _counting:
            _Told.running -= 1


# ---- ownership
class _End:
    """Destroys handles of one kind. What they need is kept here, not with them: the collector of cycles may take what
    belongs to garbage apart in any order, but not what can be reached from a module."""

    def __init__(self, destroy: Any, to_the_last: bool) -> None:
        self.destroy, self.to_the_last = destroy, to_the_last
        self.kept: "dict[int, Any]" = {}

    def __call__(self, pointer: Any) -> None:
        if self.to_the_last or not sys.is_finalizing():  # (when the interpreter ends a thread may be at work on it)
            kept = self.kept.pop(int(ffi.cast("uintptr_t", pointer)), None)
            self.destroy(pointer)
            del kept


_ENDS: "dict[str, _End]" = {}


def owned(handle: Any, destroy: str, *keep: Any, to_the_last: bool = False) -> Any:
    """`handle`, which the function called `destroy` destroys when it is collected, and before what it needs in `keep`;
    not when the interpreter ends, unless `to_the_last`."""
    end = _ENDS.setdefault(destroy, _End(getattr(lib, destroy), to_the_last))
    end.kept[int(ffi.cast("uintptr_t", handle))] = keep
    return ffi.gc(handle, end)


class Locked:
    """What one thread at a time may use."""
    _lock: Any

    def __init__(self) -> None:
        self._lock = threading.RLock()


@contextmanager
def all_locked(things: Iterable[Locked]) -> Iterator[None]:
    with ExitStack() as stack:
        for thing in sorted(set(things), key=id):
            stack.enter_context(thing._lock)
        yield


# ---- arrays
class _Memory:
    """The array interface of memory of `owner`, which lives as long as any array of it."""

    def __init__(self, pointer: Any, shape: Tuple[int, ...], kind: str, owner: Any, readonly: bool,
                 strides: Optional[Tuple[int, ...]]) -> None:
        self.owner = owner
        self.__array_interface__ = {"version": 3, "shape": shape, "typestr": kind, "strides": strides,
                                    "data": (int(ffi.cast("uintptr_t", pointer)), readonly)}


def view(pointer: Any, shape: Tuple[int, ...], kind: str, owner: Any, readonly: bool = False,
         strides: Optional[Tuple[int, ...]] = None) -> Array:
    """An array of memory that belongs to the library; not copied."""
    if 0 in shape:
        return np.empty(shape, kind)
    return np.asarray(_Memory(pointer, shape, kind, owner, readonly, strides))


def lent(values: Any, columns: int, kind: str, keep: "list[Any]", name: str, count: int = -1) -> Any:
    """A pointer to the rows of an array, converted to `kind`; columns 0: plain numbers. None is NULL."""
    if values is None:
        return ffi.NULL
    array = np.ascontiguousarray(values, kind)
    if array.ndim != (2 if columns else 1) or (columns and array.shape[1] != columns):
        raise usage(f"{name}: an array of shape {array.shape}, not {f'(n, {columns})' if columns else '(n,)'}")
    if 0 <= count != len(array):
        raise usage(f"{name}: {len(array)} of them for {count} points")
    keep.append(array)
    return ffi.cast("uint8_t *" if kind == "u1" else "size_t *" if kind == "uintp" else "float *", array.ctypes.data)


def rgb(color: Optional[Color]) -> Any:
    """An iso_rgb of "RRGGBB", "#RRGGBB" or three numbers; None is NULL."""
    if color is None:
        return ffi.NULL
    numbers = []
    try:
        numbers = list(bytes.fromhex(color.lstrip("#"))) if isinstance(color, str) else [int(c) for c in color]
    except ValueError:
        pass
    if len(numbers) != 3 or not all(0 <= n <= 255 for n in numbers):
        raise usage(f"color {color!r}: RRGGBB or three numbers 0 .. 255 are wanted")
    return ffi.new("iso_rgb *", numbers)


def vec3(values: Floats, name: str) -> "list[float]":
    numbers = [float(v) for v in values]
    if len(numbers) != 3:
        raise usage(f"{name}: three numbers are wanted, not {len(numbers)}")
    return numbers


def one_of(choices: "dict[str, Any]", name: str, what: str) -> Any:
    if name not in choices:
        raise usage(f"{what} {name!r}: one of {', '.join(choices)} is wanted")
    return choices[name]

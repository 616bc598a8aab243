#!/usr/bin/env bash
# The wheel and the source distribution: the wheel is for every Python from 3.9 on, exports but PyInit, and draws where
# there is nothing else than numpy and cffi. usage: wheel.sh PYTHON SOURCE FOLDER; ISOPOINT_LIBRARY: as for setup.py.
set -euo pipefail
python=$1 source=$2 folder=$3
fail() { echo "wheel: $*" >&2; exit 1; }
"$python" -c 'import pip' 2>/dev/null || { echo "wheel: there is no pip"; exit 77; }
rm -rf "$folder"
mkdir -p "$folder"
# Of a copy: setuptools writes beside what it builds.
(cd "$source" && tar -c --exclude='./build*' --exclude=./.git .) | tar -x -C "$folder" --one-top-level=source
(cd "$folder/source" && "$python" setup.py --quiet sdist --dist-dir "$folder" bdist_wheel --dist-dir "$folder" >"$folder/log" 2>&1) ||
    { tail -n 20 "$folder/log"; fail "it cannot be built"; }
wheel=$(ls "$folder"/isopoint-*-cp39-abi3-*.whl) || fail "no wheel for every Python: $(ls "$folder")"
tar -tzf "$folder"/isopoint-*.tar.gz >"$folder/contents"
for file in src/isopoint.h src/api/render.c CMakeLists.txt apps/CMakeLists.txt python/isopoint/_build.py tools/isopoint.pc.in LICENSE; do
    grep -q "/$file\$" "$folder/contents" || fail "the source distribution lacks $file"
done
! grep -q '/tests/\|\.png$' "$folder/contents" || fail "the source distribution has tests: $(grep '/tests/' "$folder/contents" | head -n 3)"
rm -rf "$folder/source"
"$python" -m venv --without-pip --system-site-packages "$folder/venv"
unset PYTHONPATH
"$folder/venv/bin/python" -m pip --quiet --disable-pip-version-check install --no-deps --no-index --target "$folder/venv/site" "$wheel"
native=$folder/venv/site/isopoint/_native.abi3.so
exported=$(nm -D --defined-only "$native" | awk '{ print $3 }')
[ "$exported" = PyInit__native ] || fail "it exports $exported"
cd "$folder"
PYTHONPATH=$folder/venv/site "$folder/venv/bin/python" - <<'END'
import numpy, isopoint
from importlib.metadata import version
assert version("isopoint") == isopoint.version()
a = numpy.zeros((40, 40, 40), numpy.uint8)
a[10:30, 10:30, 10:30] = 255
assert len(isopoint.Surface(a)._repr_png_()) > 1000
END
echo "$(stat -c %s "$wheel") bytes: $(basename "$wheel"); needs $(objdump -p "$native" | awk '/NEEDED/ { printf "%s ", $2 }')"

#!/usr/bin/env bash
# run.sh BUILD: installs a build, moves the folder, and uses what is there: isorender with and without its modules, and a
# C program that finds the library by CMake and by pkg-config. Nothing but a module may need VTK, OpenVDB, GDCM or C++.
set -euo pipefail
build=$(cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset ISO_MODULE_PATH
export LC_ALL=C

fail() {
    echo "FAILED: $*"
    exit 1
}

# is_light FILE: what it is linked with, and what that is linked with
is_light() {
    ! ldd "$1" | grep -E 'vtk|openvdb|gdcm|stdc\+\+' || fail "$1 is linked with a library that belongs to a module"
}

# not_installed COMMAND ...: fails with status 3 and one line that names the module
not_installed() {
    local status=0
    "$@" >"$work/out" 2>"$work/err" || status=$?
    [ $status -eq 3 ] || fail "status $status instead of 3: $*"
    [ "$(wc -l <"$work/err")" -eq 1 ] || fail "not one line: $(cat "$work/err")"
    grep -q 'small.vti: the VTK reader (libisopoint-vti.so) is not installed' "$work/err" || fail "$(cat "$work/err")"
}

cmake --install "$build" --prefix "$work/first" >/dev/null
mkdir "$work/moved"
mv "$work/first" "$work/moved/here"
root=$work/moved/here
modules=$(dirname "$(find "$root" -name 'libisopoint-*.so' | head -n 1)")
library=$(find "$root" -name 'libisopoint.a' -o -name 'libisopoint.so')

# 4 x 4 x 4 voxels, 8 of them inside: 24 edges cross the surface
python3 - "$work" <<'P'
import sys
values = [200 if {x, y, z} <= {1, 2} else 0 for z in range(4) for y in range(4) for x in range(4)]
extent = '"0 3 0 3 0 3"'
with open(sys.argv[1] + "/small.vti", "w") as file:
    file.write('<VTKFile type="ImageData" version="0.1" byte_order="LittleEndian">\n<ImageData WholeExtent=' + extent +
               ' Origin="0 0 0" Spacing="1 1 1">\n<Piece Extent=' + extent + '><PointData Scalars="v">\n'
               '<DataArray type="UInt8" Name="v" format="ascii">' + " ".join(map(str, values)) +
               '</DataArray></PointData></Piece></ImageData></VTKFile>\n')
with open(sys.argv[1] + "/small.mha", "wb") as file:
    file.write(b"ObjectType = Image\nNDims = 3\nDimSize = 4 4 4\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n" +
               bytes(values))
P

# ---- every program starts where the folder now is, and under the folder that DESTDIR names
# starts FOLDER PROGRAM ...: each says its version
starts() {
    local folder=$1 name
    shift
    for name in "$@"; do
        "$folder/$name" --version >"$work/out" 2>"$work/err" || fail "$folder/$name does not start: $(cat "$work/err")"
        grep -q "^$name [0-9]" "$work/out" || fail "$folder/$name --version said: $(cat "$work/out")"
    done
}
mapfile -t programs < <(cd "$root/bin" && ls)
[ ${#programs[@]} -ge 3 ] || fail "installed programs: ${programs[*]}"
starts "$root/bin" "${programs[@]}"
DESTDIR=$work/stage cmake --install "$build" --prefix /opt/isopoint >/dev/null
starts "$work/stage/opt/isopoint/bin" "${programs[@]}"
rm -rf "$work/stage"

has_vti=$([ -e "$modules/libisopoint-vti.so" ] && echo 1 || echo 0)
is_light "$root/bin/isorender"
count() {
    "$root/bin/isorender" "$1" --isovalue 100 --method points --no-image --json --quiet | grep -o '"points": *[0-9]*' | grep -o '[0-9]*$'
}
[ "$(count "$work/small.mha")" = 24 ] || fail "isorender found $(count "$work/small.mha") points in a .mha"
if [ "$has_vti" = 1 ]; then
    [ "$(count "$work/small.vti")" = 24 ] || fail "isorender found $(count "$work/small.vti") points in a .vti"
fi

# ---- the public headers are installed, and each compiles alone as C and as C++
(cd "$root/include" && echo *) >"$work/headers"
[ "$(cat "$work/headers")" = "isopoint.h isopoint_clouds.h isopoint_figures.h isopoint_lines.h isopoint_meshes.h isopoint_parts.h isopoint_sculpt.h" ] || fail "installed headers: $(cat "$work/headers")"
printf '#include <%s>\n' isopoint_sculpt.h isopoint_parts.h isopoint_meshes.h isopoint_lines.h isopoint_figures.h isopoint_clouds.h isopoint.h >"$work/alone.c"
for language in c:-std=c17 c++:-std=c++17; do
    ${CC:-cc} -x ${language%%:*} ${language#*:} -pedantic -Wall -Wextra -Werror -fsyntax-only -I"$root/include" "$work/alone.c" \
        2>"$work/err" || fail "${language%%:*}: $(head -n 3 "$work/err")"
done

# ---- from C; a program elsewhere finds the modules of the shared library, and is told of those of the static one
case $library in *.a) export ISO_MODULE_PATH=$modules ;; esac
cmake -S "$here" -B "$work/cmake" -DCMAKE_PREFIX_PATH="$root" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
cmake --build "$work/cmake" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
config=$(dirname "$(find "$root" -name isopoint.pc)")
flags=$(PKG_CONFIG_PATH=$config pkg-config --cflags --libs isopoint)
# shellcheck disable=SC2086
mkdir "$work/tools"
${CC:-cc} -o "$work/tools/consumer" "$here/consumer.c" $flags -Wl,-rpath,"$(dirname "$library")"
for program in "$work/cmake/consumer" "$work/tools/consumer"; do
    is_light "$program"
    [ "$("$program" "$work/small.mha" 100)" = 24 ] || fail "$program cannot read a .mha"
    [ "$has_vti" = 0 ] || [ "$("$program" "$work/small.vti" 100)" = 24 ] || fail "$program cannot read a .vti"
done
# ---- the program that the README shows
sed -n '/^## From C/,/^## /{/^```c$/,/^```$/p}' "$here/../../README.md" | sed '/^```/d' >"$work/readme.c"
grep -q 'int main' "$work/readme.c" || fail "README.md has no C program below 'From C'"
# shellcheck disable=SC2086
${CC:-cc} -std=c17 -Wall -Wextra -Werror -o "$work/tools/readme" "$work/readme.c" $flags -Wl,-rpath,"$(dirname "$library")" ||
    fail "the README's program does not compile"
"$work/tools/readme" "$work/small.mha" 100 "$work/readme.png" || fail "the README's program ended with $?"
"$root/bin/isorender" "$work/small.mha" "$work/isorender.png" --isovalue 100 --fit box --quiet
"$root/bin/isocompare" images "$work/isorender.png" "$work/readme.png" --fail-under psnr=138 --quiet ||
    fail "the README's program and isorender make different pictures"
status=0
"$work/tools/readme" "$work/none.mha" 100 "$work/none.png" >"$work/out" 2>"$work/err" || status=$?
[ $status -eq 3 ] || fail "the README's program ended with $status for a missing file"
[ ! -e "$work/none.png" ] || fail "the README's program left a picture of a missing file"
if command -v valgrind >/dev/null; then
    valgrind --quiet --undef-value-errors=no --leak-check=full --error-exitcode=9 "$work/tools/readme" "$work/small.mha" 100 "$work/leaks.png" >/dev/null 2>"$work/err" ||
        fail "the README's program leaks: $(cat "$work/err")"
fi
# ---- the program of docs/insitu.md: the same bytes by any number of ranks
if command -v mpicc >/dev/null && command -v mpirun >/dev/null; then
    sed -n '/^```c$/,/^```$/p' "$here/../../docs/insitu.md" | sed '/^```/d' >"$work/heat.c"
    # shellcheck disable=SC2086
    OMPI_CC=${CC:-cc} mpicc -std=c17 -O2 -Wall -Wextra -o "$work/tools/heat" "$work/heat.c" $flags -Wl,-rpath,"$(dirname "$library")" ||
        fail "the program of docs/insitu.md does not compile"
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_btl_vader_single_copy_mechanism=none
    for ranks in 1 2 4; do
        mpirun --oversubscribe -n $ranks "$work/tools/heat" 64 20 "$work/heat$ranks.png" >"$work/out" 2>"$work/err" ||
            fail "docs/insitu.md by $ranks ranks: $(cat "$work/err")"
        cmp "$work/heat1.png" "$work/heat$ranks.png" || fail "docs/insitu.md: $ranks ranks make another picture"
        grep -q '^a step .* s, a picture .* s$' "$work/out" || fail "docs/insitu.md said: $(cat "$work/out")"
    done
fi
unset ISO_MODULE_PATH

# ---- a module is taken away
rm -f "$modules/libisopoint-vti.so"
prefix=$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")
if [ -n "$(find "$prefix/lib" -name libisopoint-vti.so 2>/dev/null)" ]; then
    echo "an installation in $prefix has the module: what happens without it is not tested"
    exit 0
fi
not_installed "$root/bin/isorender" "$work/small.vti" --isovalue 100 --no-image --json
# What lies around a program that is not in bin/ is not ours.
mkdir -p "$work/lib/isopoint"
echo "not a module" >"$work/lib/isopoint/libisopoint-vti.so"
not_installed "$work/tools/consumer" "$work/small.vti" 100
[ "$(count "$work/small.mha")" = 24 ] || fail "without a module, isorender cannot read a .mha"

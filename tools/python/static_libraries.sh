#!/usr/bin/env bash
# Builds zlib, libpng and jansson as static libraries that an extension can be linked with (Debian's are not
# position-independent). usage: static_libraries.sh PREFIX [ZLIB LIBPNG JANSSON]: folders of their sources, which are
# fetched if they are not given.
set -euo pipefail
prefix=$1
shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
if [ $# -eq 0 ]; then
    git clone -q --depth 1 --branch v1.3.1 https://github.com/madler/zlib "$work/zlib-source"
    git clone -q --depth 1 --branch v1.6.43 https://github.com/pnggroup/libpng "$work/png-source"
    git clone -q --depth 1 --branch v2.14 https://github.com/akheron/jansson "$work/jansson-source"
    set -- "$work/zlib-source" "$work/png-source" "$work/jansson-source"
fi
# build NAME SOURCE [options]
build() {
    cmake -S "$2" -B "$work/$1" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_PREFIX_PATH="$prefix" \
        -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_C_FLAGS="-ffunction-sections -fdata-sections" -DBUILD_SHARED_LIBS=OFF \
        "${@:3}" >"$work/$1.log" 2>&1 && cmake --build "$work/$1" --target install --parallel >>"$work/$1.log" 2>&1 ||
        { tail -n 20 "$work/$1.log" >&2; exit 1; }
}
build zlib "$1"
rm -f "$prefix"/lib/libz.so* # which would be preferred
build png "$2" -DPNG_SHARED=OFF -DPNG_TESTS=OFF -DPNG_EXECUTABLES=OFF -DZLIB_LIBRARY="$prefix/lib/libz.a" -DZLIB_INCLUDE_DIR="$prefix/include"
build jansson "$3" -DJANSSON_BUILD_DOCS=OFF -DJANSSON_WITHOUT_TESTS=ON -DJANSSON_EXAMPLES=OFF
ls "$prefix"/lib/*.a

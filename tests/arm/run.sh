#!/usr/bin/env bash
# run.sh BUILD: builds the library for 64-bit ARM in this folder, and holds what it makes against the golden table, whose hashes
# are the same on every machine, under qemu's user mode. The libraries that it needs are downloaded by apt and unpacked there:
# nothing is installed. Exit status 77, with a message: they cannot be had.
set -euo pipefail
build=$(realpath -m "$1")
cd "$(dirname "$0")/../.."
export ISO_ARM_ROOT=$build/root
libraries="libpng-dev zlib1g-dev libjansson-dev"

skip() {
    echo "skipped: $*"
    exit 77
}
for tool in aarch64-linux-gnu-gcc aarch64-linux-gnu-g++ qemu-aarch64 ninja; do
    command -v $tool >/dev/null || skip "there is no $tool"
done

if [ ! -e "$ISO_ARM_ROOT/complete" ]; then
    rm -rf "$ISO_ARM_ROOT"
    mkdir -p "$ISO_ARM_ROOT" "$build"/apt/{lists,cache}/partial
    as_arm() {
        apt-get -qq -o APT::Architecture=arm64 -o APT::Architectures=arm64 -o Dir::State::Lists="$build/apt/lists" \
            -o Dir::Cache="$build/apt/cache" -o Dir::State::Status=/dev/null -o APT::Sandbox::User= "$@"
    }
    # shellcheck disable=SC2086
    (cd "$ISO_ARM_ROOT" && as_arm update && as_arm download $libraries) >"$build/apt.log" 2>&1 ||
        skip "packages of arm64 cannot be downloaded: $(tail -n 1 "$build/apt.log")"
    for package in "$ISO_ARM_ROOT"/*.deb; do dpkg -x "$package" "$ISO_ARM_ROOT"; done
    touch "$ISO_ARM_ROOT/complete"
fi

options=()
for name in VTK OPENVDB TIFF HDF5 ZARR GDCM BZIP2 NIFTI OPENEXR JPEG MESHOPTIMIZER GL; do options+=("-DISO_WITH_$name=OFF"); done
cmake -G Ninja -S . -B "$build" -DCMAKE_TOOLCHAIN_FILE="$PWD/tests/arm/aarch64.cmake" -DCMAKE_BUILD_TYPE=Release \
    -DISO_PROGRAMS=OFF -DISO_UNITY=ON -DISO_WERROR="${ISO_WERROR:-OFF}" "${options[@]}" >"$build/log" || { cat "$build/log"; exit 1; }
cmake --build "$build" --target isopoint
aarch64-linux-gnu-gcc -std=c17 -D_GNU_SOURCE -O2 -ffp-contract=off -static -I. -Isrc -Itests/golden -I"$ISO_ARM_ROOT/usr/include" -o "$build/golden" \
    tests/golden/*.c "$build/lib/libisopoint.a" -L"$ISO_ARM_ROOT/usr/lib/aarch64-linux-gnu" -ljansson -lpng -lz -lm
exec qemu-aarch64 "$build/golden" . tests/golden/table.tsv "$build/different"

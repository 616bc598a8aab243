#!/usr/bin/env bash
# runpath.sh BUILD: every RUNPATH of what was built, in the build tree and installed, consists of absolute folders (or
# $ORIGIN, the file's own). An empty or relative element is the working directory, whose libraries anyone may have put there.
set -euo pipefail
build=$(cd "$1" && pwd)
command -v readelf >/dev/null || { echo "readelf is not installed"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cmake --install "$build" --prefix "$work/installed" >/dev/null
objects=0 wrong=0
while IFS= read -r -d '' file; do
    head -c 4 "$file" | cmp -s - <(printf '\177ELF') || continue
    dynamic=$(readelf -d "$file" 2>/dev/null) || continue
    objects=$((objects + 1))
    while IFS= read -r elements; do
        # (a colon is added for the element behind the last one)
        while IFS= read -r -d : element; do
            case $element in
            /* | \$ORIGIN | \$ORIGIN/*) ;;
            *)
                echo "${file#"$work/"}: RUNPATH '$elements' has the element '$element'"
                wrong=1
                ;;
            esac
        done <<<"$elements:"
    done < <(sed -nE 's/.*\((RPATH|RUNPATH)\).*\[(.*)\]$/\2/p' <<<"$dynamic")
done < <(find "$build"/bin "$build"/lib* "$build"/tests "$work/installed" -type f \( -perm -100 -o -name '*.so*' \) -print0 2>/dev/null)
[ $objects -ge 6 ] || { echo "only $objects programs and libraries were found"; exit 1; }
exit $wrong

header() { printf "ObjectType = Image\nNDims = 3\nDimSize = $1\nElementType = MET_SHORT\nElementDataFile = LOCAL\n"; }
endless() { timeout 60 bash -c 'cat /dev/zero 2>/dev/null'; }
refused() {
    local status=$1 words=$2
    shift 2
    code=0
    timeout 60 isorender - out.png --max-memory 64M --quiet "$@" 2>said || code=$?
    [ $code = $status ] && [ "$(grep -c '' said)" = 1 ] && grep -q "$words" said || { cat said; echo "$code instead of $status"; exit 1; }
    rm said
    [ ! -e out.png ] || exit 1
}
endless | refused 3 "its first bytes are not those of a volume"
{ header "4000 4000 4000"; endless; } | refused 5 "max-memory"
{ printf '<VTKFile>'; endless; } | refused 5 "standard input: .*max-memory"
{ printf 'NRRD0004\ntype: nonsense\ndimension: 3\nsizes: 2 2 2\nencoding: raw\n\n'; endless; } | refused 3 "standard input: "
# What follows the voxels is not waited for.
{ header "16 16 16"; tr '\0' '\1' </dev/zero 2>/dev/null; } | refused 6 "constant"
endless | refused 6 constant --raw 16x16x16:uint8

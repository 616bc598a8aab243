# stdout: cpu*3 threads*egl *osmesa *
isorender --list-backends --threads 3
# The instruction set in use is named, whatever the machine has.
set_in_use() {
    ISO_CPU=$1 isorender --list-backends | sed -n 's/^cpu  *\([^,]*\),.*/\1/p'
}
[ "$(set_in_use generic)" = generic ]
flags=$(grep -m 1 '^flags' /proc/cpuinfo || true)
case $flags in
*avx2*bmi1*bmi2*) [ "$(set_in_use avx2)" = avx2 ] && [ "$(set_in_use '')" != generic ] ;;
esac

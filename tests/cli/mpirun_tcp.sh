# Four ranks of mpirun on two hosts, which are network namespaces that only TCP joins: the bytes of one process, and a
# failure on the other host is said. Namespaces need root.
which mpirun ip unshare >/dev/null || { echo "skipped: no mpirun, ip or unshare"; exit 77; }
[ -e "$(dirname "$(which isorender)")"/../lib*/isopoint/libisopoint-mpi.so ] || { echo "skipped: built without MPI"; exit 77; }
near=iso_near_$$ far=iso_far_$$
cleanup() {
    ip netns del $near
    ip netns del $far
} 2>/dev/null
trap cleanup EXIT
{ ip netns add $near && ip netns add $far && ip link add iso_n$$ type veth peer name iso_f$$; } 2>/dev/null ||
    { echo "skipped: network namespaces cannot be made (needs root)"; exit 77; }
ip link set iso_n$$ netns $near
ip link set iso_f$$ netns $far
ip -n $near addr add 10.213.7.1/24 dev iso_n$$
ip -n $far addr add 10.213.7.2/24 dev iso_f$$
for name in $near $far; do ip -n $name link set lo up; done
ip -n $near link set iso_n$$ up
ip -n $far link set iso_f$$ up

# what mpirun starts instead of ssh: agent HOST COMMAND
cat >agent <<A
#!/bin/sh
shift
exec ip netns exec $far unshare --uts sh -c "hostname far; \$*"
A
chmod +x agent
export OMPI_MCA_orte_tmpdir_base="$PWD" OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# together ARGUMENTS: two ranks on each host
together() {
    ip netns exec $near unshare --uts sh -c 'hostname near; exec timeout 100 mpirun --mca plm rsh --mca plm_rsh_agent "$PWD/agent" \
        --mca btl tcp,self --mca btl_tcp_if_include 10.213.7.0/24 --mca oob_tcp_if_include 10.213.7.0/24 \
        -H 10.213.7.1:2,10.213.7.2:2 -n 4 isorender "$@" --threads 1 --quiet' sh "$@"
}
sent() {
    ip netns exec $near cat /sys/class/net/iso_n$$/statistics/rx_bytes
}
for options in "scene:ct:80 --fit box --chunk-size 16" "scene:ct:80 --fit box --chunk-size 32 --method pullpush --reconstruction gaussian"; do
    before=$(sent)
    isorender ${options/--chunk-size ??/} -o alone.png --resolution 320x240 --threads 1 --quiet
    together $options -o together.png --resolution 320x240
    cmp alone.png together.png
    # two ranks on the other host have sent the keys of a picture at least once
    [ $(($(sent) - before)) -gt $((320 * 240 * 8)) ]
    rm together.png
done
status=0
together scene:ct:80 --isovalue 1e9 -o together.png 2>said || status=$?
[ $status = 6 ] && [ "$(grep -c '^isorender:' said)" = 1 ] && [ ! -e together.png ] || { cat said; exit 1; }

# chroot.sh: sourced by tests that need a Debian 12 that has nothing installed, in $root; in_root runs a command there. What was
# downloaded for Debian itself is kept in build/bare.tar. Exit status 77, with a message: debootstrap or chroot cannot be had.
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

skip() {
    echo "skipped: $*"
    exit 77
}
fail() {
    echo "FAILED: $*"
    exit 1
}

[ "$(id -u)" -eq 0 ] || skip "a bare Debian needs root, for chroot"
command -v debootstrap >/dev/null || skip "debootstrap is not installed"
mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE)' 2>/dev/null | awk '$2 == "bookworm" { print $1; exit }')
[ -n "$mirror" ] || skip "apt names no mirror of Debian 12"

mkdir -p build
root=$PWD/build/bare
in_root() { chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin bash -c "$1"; }
clean_up() {
    umount "$root/proc" 2>/dev/null || true
    rm -rf --one-file-system "$root"
}
trap clean_up EXIT
clean_up
mkdir -p "$root"
if [ ! -e build/bare.tar ]; then
    debootstrap --variant=minbase bookworm "$root" "$mirror" >build/debootstrap.log 2>&1 || skip "debootstrap: $(tail -n 1 build/debootstrap.log)"
    tar -C "$root" -cf build/bare.tar.new .
    mv build/bare.tar.new build/bare.tar
else
    tar -C "$root" -xf build/bare.tar
fi
in_root true 2>/dev/null || skip "chroot does not work here"
# apt's own settings are the machine's: mirrors, their keys, proxies.
rm -f "$root/etc/apt/sources.list"
cp -r /etc/apt/sources.list* /etc/apt/apt.conf.d /etc/apt/trusted.gpg.d "$root/etc/apt/"
rm -f "$root"/etc/apt/apt.conf.d/{20packagekit,50appstream,docker-clean}
echo 'Dpkg::Use-Pty "0";' >"$root/etc/apt/apt.conf.d/99bare"
[ ! -e /etc/resolv.conf ] || cp /etc/resolv.conf "$root/etc/"
mount -t proc proc "$root/proc" 2>/dev/null || echo "no /proc in the chroot"

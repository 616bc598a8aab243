#!/usr/bin/env bash
# packages.sh PACKAGES [TEST ...]: installs the .deb files of this folder by apt in a Debian 12 that has nothing, and runs debian/tests
# there (all, or those that are named), each with what debian/tests/control says that it depends on. Exit status 77, with a message: such a Debian cannot be had.
set -euo pipefail
packages=$(cd "$1" && pwd)
ls "$packages"/*.deb >/dev/null
shift
tests=" $* "
source "$(dirname "$0")/chroot.sh"

mkdir -p "$root/srv/packages"
cp "$packages"/*.deb "$root/srv/packages"
(cd "$root/srv/packages" && dpkg-scanpackages --multiversion . >Packages 2>/dev/null)
echo "deb [trusted=yes] file:/srv/packages ./" >"$root/etc/apt/sources.list.d/packages.list"
git clone --quiet --no-hardlinks . "$root/root/isopoint"
cp -r debian "$root/root/isopoint" # as it is now
mkdir "$root/root/tmp"
in_root "apt-get update -qq" >build/packages-test.log 2>&1 || fail "$(tail -n 1 build/packages-test.log)"
while read -r name depends; do
    [ "$tests" = "  " ] || [[ $tests == *" $name "* ]] || continue
    in_root "DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $depends" >>build/packages-test.log 2>&1 ||
        fail "$depends cannot be installed: $(tail -n 3 build/packages-test.log)"
    echo "packages.sh: debian/tests/$name"
    in_root "cd /root/isopoint && AUTOPKGTEST_TMP=/root/tmp debian/tests/$name" || fail "debian/tests/$name ended with $?"
done < <(sed -n 's/^Tests: //p; s/^Depends: //p' debian/tests/control | sed 's/,//g' | paste -d' ' - -)
in_root "DEBIAN_FRONTEND=noninteractive apt-get remove -y -qq 'libisopoint*' isopoint isosculpt isopoint-formats" >>build/packages-test.log 2>&1 ||
    fail "the packages cannot be removed: $(tail -n 3 build/packages-test.log)"
left=$(in_root "find /usr -name '*isopoint*' -not -path '/usr/share/doc/*' | grep -v '^/usr/share/mime/'" || true)
[ -z "$left" ] || fail "packages that were removed left $left"

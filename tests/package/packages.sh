#!/usr/bin/env bash
# Debian packages of the last commit: built twice, in other directories, at other times, in another language and time
# zone; the bytes are the same. lintian finds no error. In a minimal Debian root apt installs them, the demo
# scene runs, and purging leaves nothing.   Usage: packages.sh SOURCE WORK     77: something is missing
set -euo pipefail
source=$1 work=$2

for tool in git ninja lintian mmdebstrap dpkg-shlibdeps; do
    command -v "$tool" >/dev/null || { echo "$tool is missing (Debian: git ninja-build lintian mmdebstrap dpkg-dev)" && exit 77; }
done
[ "$(id -u)" -eq 0 ] || { echo "making a root needs root" && exit 77; }
commit=$(git -C "$source" rev-parse HEAD)
rm -rf "$work"
mkdir -p "$work"

build() {  # DIRECTORY
    git clone -q "$source" "$1" && cd "$1" && git checkout -q --detach "$commit" && export CCACHE_DISABLE=1 &&
        cmake --preset package && cmake --build --preset package && cpack --preset package
}
(build "$work/one" >"$work/one.log" 2>&1) || { tail -n 40 "$work/one.log" && exit 1; }
(export TZ=Asia/Tokyo LC_ALL=C LANGUAGE=C && build "$work/another/with a longer name" >"$work/another.log" 2>&1) ||
    { tail -n 40 "$work/another.log" && exit 1; }
packages=("$work/one/build/package/packages/"*.deb)
for package in "${packages[@]}"; do
    cmp "$package" "$work/another/with a longer name/build/package/packages/${package##*/}"
    printf '%s  %s bytes, %s KiB installed\n' "${package##*/}" "$(stat -c %s "$package")" "$(dpkg-deb -f "$package" Installed-Size)"
done
echo "${#packages[@]} packages: twice the same bytes"

lintian --allow-root --fail-on error "${packages[@]}"

apt-get indextargets --format 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' 'Origin: Debian' | sort -u >"$work/sources.list"
apt-config dump | { grep -E '^Acquire::(https?::|[^:]*[Pp]roxy)' || true; } >"$work/apt.conf"
mkdir "$work/packages"
for name in twinchute python3-twinchute twinchute-doc twinchute-serve; do cp "$work/one/build/package/packages/$name"_*.deb "$work/packages/"; done
cat >"$work/use" <<'TXT'
set -eu
names() { find / -xdev \( -path /proc -o -path /sys -o -path /dev -o -path /tmp -o -path /var/cache -o -path /var/lib/apt -o -path /var/lib/dpkg -o -path /var/log -o -path /run \) -prune -o -print | sort; }
size() { du -xsk --exclude=/proc --exclude=/sys --exclude=/tmp --exclude=/var/cache --exclude=/var/lib/apt / | cut -f1; }
export DEBIAN_FRONTEND=noninteractive
cd /tmp
names >before
empty=$(size)
apt-get install -qq -y --no-install-recommends /tmp/packages/twinchute_*.deb
echo "twinchute and all that it needs: $((($(size) - empty) / 1024)) MiB on a minimal Debian"
twinchute compare /usr/share/twinchute/scenes/c9-inflation.toml --out /tmp/out
test -s /tmp/out/report.html
test -s /usr/share/man/man1/twinchute.1.gz
apt-get install -qq -y --no-install-recommends /tmp/packages/*.deb
test -s /usr/share/doc/twinchute/docs/glossary.md
python3 - <<'PY'
import twinchute
scene = twinchute.Scene.load("/usr/share/twinchute/scenes/c9-inflation.toml")
print("peak force by Python:", twinchute.rom(scene).metrics["peak_force"])
PY
twinchute serve --dir /tmp >/tmp/address &
server=$!
python3 - <<'PY'
import time, urllib.request
for _ in range(100):
    address = open("/tmp/address").read().strip()
    if address:
        break
    time.sleep(0.1)
page = urllib.request.urlopen(address).read().decode()
assert "<title>" in page and "twinchute" in page, page[:200]
print("the local page answers:", len(page), "bytes")
PY
kill -TERM $server
wait $server || true
apt-get purge -qq -y twinchute python3-twinchute twinchute-doc twinchute-serve
apt-get autoremove -qq -y --purge
names >after
diff before after && echo "purged: nothing is left"
TXT
mmdebstrap --format=null --mode=root --variant=minbase --aptopt="$work/apt.conf" \
    --customize-hook="cp -r '$work/packages' '$work/use' \"\$1/tmp/\"" --customize-hook='chroot "$1" bash /tmp/use' \
    "$(. /etc/os-release && echo "${VERSION_CODENAME:-stable}")" /dev/null "$work/sources.list" >"$work/root.log" 2>&1 ||
    { tail -n 60 "$work/root.log" && exit 1; }
grep -E 'MiB on a minimal|purged:|peak force|within|local page' "$work/root.log" || true
rm -rf "$work/one" "$work/another"

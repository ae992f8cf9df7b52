#!/bin/bash
# clean_machine.sh DEB: a fresh Debian 12 made by debootstrap, in which apt installs the package with what it depends on, and
# nothing else; it renders, and goes away again. Needs root and a Debian mirror. RT_CLEAN_ROOT: a folder to make it in.
set -euo pipefail
package=$(realpath "$1")
root=${RT_CLEAN_ROOT:-$(mktemp -d)}
mirror=$(apt-get indextargets --format '$(SITE)' 2>/dev/null | grep -m1 -v security || echo http://deb.debian.org/debian)
[[ -e $root/etc/debian_version ]] || debootstrap --variant=minbase bookworm "$root" "$mirror" >/dev/null
cp /etc/resolv.conf "$root/etc/resolv.conf"
{ grep -lsE "Acquire::(https?|Check)" /etc/apt/apt.conf.d/* || true; } | xargs -r cp -nt "$root/etc/apt/apt.conf.d/" # proxies, and what mirrors of old days need
mountpoint -q "$root/proc" || mount -t proc proc "$root/proc"
trap 'umount "$root/proc"' EXIT
cp "$package" "$root/tmp/rt.deb"
inside() { chroot "$root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
list() { inside find /usr /etc -xdev ! -type d | sort; }

inside apt-get update -qq
list >"$root/before.txt"
inside apt-get install -y -qq --no-install-recommends /tmp/rt.deb >"$root/install.log" 2>&1 || { tail "$root/install.log" >&2; exit 1; }
inside rt --version
cat >"$root/tmp/scene.yaml" <<'SCENE'
rt: 1
image: {width: 320, height: 240}
camera: {position: [0, -5, 2], look_at: [0, 0, 0.5]}
background: {color: [0.4, 0.6, 0.9]}
lights:
  - point: {position: [3, -4, 5], color: 1}
objects:
  - sphereflake: {center: [0, 0, 0.6], radius: 0.6, material: {color: [0.9, 0.8, 0.4], diffuse: 0.8, specular: 0.2}}
SCENE
for suffix in png jpg bmp exr pfm; do inside rt render /tmp/scene.yaml -o /tmp/picture.$suffix; done
! inside rt plugins | grep -A3 '^refused'
[[ -s $root/usr/share/man/man1/rt.1.gz || -e $root/etc/dpkg/dpkg.cfg.d/docker ]]
inside apt-get purge -y -qq rt >"$root/purge.log" 2>&1
inside apt-get autoremove -y -qq --purge >>"$root/purge.log" 2>&1
if inside dpkg -L rt 2>/dev/null; then echo "clean_machine: still there" >&2; exit 1; fi
list | diff "$root/before.txt" - | grep -i '[/ ]rt[/.]' && { echo "clean_machine: files are left" >&2; exit 1; }
echo "clean_machine: installed, rendered, removed; the root is $root"

#!/bin/sh
# try_package.sh DEB WORK: unpacks, uses and removes the Debian package in a root of its own below WORK, with this machine's
# libraries: the program renders, find_package(rt) builds a plugin, the manual is there, and nothing stays behind.
set -eu
package=$1 work=$2
rm -rf "$work"
mkdir -p "$work/root/var/lib/dpkg/info" "$work/root/var/lib/dpkg/updates" "$work/root/var/log"
touch "$work/root/var/lib/dpkg/status"
cd "$work"
fail() { echo "try_package: $*" >&2; exit 1; }
# CPack's scripts only run ldconfig, which is this machine's business and not that of the root.
mkdir bin
printf '#!/bin/sh\n' >bin/ldconfig
chmod +x bin/ldconfig
dpkg() {
    PATH="$work/bin:$PATH" command dpkg --root="$work/root" --force-depends --force-not-root --force-script-chrootless \
        --no-debsig "$@" >>"$work/dpkg.log" 2>&1
}

dpkg -i "$package" || { cat "$work/dpkg.log" >&2; fail "does not install"; }
rt=$work/root/usr/bin/rt
"$rt" --version >version.txt

# Draws, with a plugin and a codec of its own.
cat >scene.yaml <<'SCENE'
rt: 1
image: {width: 64, height: 48}
camera: {position: [0, -5, 2], look_at: [0, 0, 0.5]}
lights:
  - point: {position: [3, -4, 5], color: 1}
objects:
  - torus: {translate: [0, 0, 0.5], material: {color: [0.8, 0.2, 0.1], diffuse: 0.9}}
SCENE
"$rt" render scene.yaml -o scene.png || fail "does not render"
"$rt" plugins >plugins.txt
grep -q refused plugins.txt && { cat plugins.txt >&2; fail "a plugin is refused"; }
"$rt" plugins | grep -q "$work/root/usr/lib/rt/plugins/torus" || fail "finds other plugins than its own"

# What a third party needs.
"$rt" new shape spot >/dev/null
cmake -S spot -B spot/build -DCMAKE_PREFIX_PATH="$work/root/usr" -DCMAKE_FIND_USE_CMAKE_SYSTEM_PATH=OFF >cmake.log 2>&1 ||
    { cat cmake.log >&2; fail "find_package(rt) fails"; }
cmake --build spot/build >>cmake.log 2>&1 || { cat cmake.log >&2; fail "a plugin does not build"; }
"$rt" render spot/scene.yaml --size 64x36 -o spot.png --plugin-dir spot/build || fail "a new plugin does not render"

# The manual and the completions of every command.
share=$work/root/usr/share
for command in $("$rt" --help | sed -n '/^Commands:/,/^$/s/^  \([a-z]\+\) .*/\1/p' | grep -v '^help$'); do
    page=$share/man/man1/rt-$command.1.gz
    [ -s "$page" ] || fail "there is no man page of rt $command"
    gzip -dc "$page" | grep -q "$command" || fail "the man page of rt $command is empty"
    grep -q "$command" "$share/bash-completion/completions/rt" || fail "bash does not complete rt $command"
done
for file in zsh/site-functions/_rt fish/vendor_completions.d/rt.fish doc/rt/copyright; do
    [ -s "$share/$file" ] || fail "there is no $file"
done

dpkg -r rt || { cat "$work/dpkg.log" >&2; fail "does not uninstall"; }
left=$(find "$work/root/usr" ! -type d 2>/dev/null || true)
[ -z "$left" ] || fail "leaves behind: $left"
echo "installed, rendered, built a plugin, removed: $(basename "$package")"

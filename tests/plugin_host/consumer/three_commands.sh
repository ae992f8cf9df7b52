#!/bin/sh
# three_commands.sh GUIDE BIN WORK: runs the first indented block of the guide, line by line, in the empty folder WORK.
set -eu
guide=$1 work=$3
PATH=$2:$PATH
rm -rf "$work"
mkdir -p "$work"
awk '/^    /{print substr($0, 5); found = 1; next} found{exit}' "$guide" >"$work.commands"
[ "$(wc -l <"$work.commands")" = 3 ] || { echo "the guide does not begin with three commands:"; cat "$work.commands"; exit 1; }
cd "$work"
sh -eux "$work.commands"
[ -s scene.png ]

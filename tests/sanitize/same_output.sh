#!/bin/sh
# same_output.sh PROGRAM OTHER [ARGUMENT...]: both end well and print the same, and something.
set -eu
program=$1 other=$2
shift 2
expected=$("$program" "$@")
printed=$("$other" "$@")
test -n "$expected"
test "$expected" = "$printed" || {
    printf '%s:\n%s\n%s:\n%s\n' "$program" "$expected" "$other" "$printed"
    exit 1
}

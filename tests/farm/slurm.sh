#!/usr/bin/env bash
# rt farm on a real Slurm of two nodes: slurm.sh RT. Ends with 77 (skipped) where there is none.
# RT_FARM_LONG=1 also loses a node in mid-film.
set -euo pipefail
# Whatever a daemon does, this ends.
[[ -n ${RT_FARM_LIMITED:-} ]] || RT_FARM_LIMITED=1 exec timeout --kill-after=10 "${RT_FARM_LIMIT:-560}" "$0" "$@"
rt=$1
source "$(dirname "${BASH_SOURCE[0]}")/two_nodes.sh"
((EUID == 0)) && command -v slurmctld munged setpriv >/dev/null || {
    echo "there is no Slurm here, or no right to start one"
    exit 77
}
work=$(mktemp -d)
slurm=$work/slurm
full= # a folder on a disk of its own
trap 'end_processes; cd /; [[ -z $full ]] || umount -l "$full"; rm -rf "$work"' EXIT
cd "$work"
start_slurm || {
    echo "Slurm does not start here"
    tail -n 5 "$slurm"/*.log "$slurm"/*.out || true
    exit 77
}
echo "Slurm is there after $SECONDS s"

fail() {
    echo "FAILED after $SECONDS s: $*"
    "$rt" farm status "$job" || true
    timeout 5 squeue || true
    tail -n 20 "$job"/log/*.log 2>/dev/null || true
    exit 1
}
# wait_for SECONDS COMMAND...: until it succeeds; what waits to begin again meanwhile does
wait_for() {
    local end=$((SECONDS + $1))
    shift
    until "$@" >/dev/null 2>&1; do
        ((SECONDS < end)) || fail "not in time: $*"
        sleep 0.2
        begin_again
    done
}
# attempts [TASK]
attempts() { cat "$job"/log/task_${1:-*}.events | grep -c '^start '; }
# What the manifests vouch for, and since when it is there.
rendered() {
    awk -F'\t' '$1 == "frame" {folder = FILENAME; sub(/manifest$/, "", folder); print folder $3}' "$job"/out/*/manifest |
        xargs -r stat -c '%n %.9Y' | sort
}
# kept FILE: all that `rendered` wrote there is as it was
kept() { [[ -z $(comm -23 "$1" <(rendered)) ]] || fail "rendered twice: $(comm -23 "$1" <(rendered))"; }
nothing_queued() { [[ -z $(timeout 5 squeue -h) ]]; }
# status PATTERN: what rt farm status says has such a line
status() { "$rt" farm status "$job" | grep -Eq "$1" || fail "the status does not say: $1"; }

cat >film.yaml <<'YAML'
rt: 1
image: {width: 160, height: 120}
camera: {position: [0, -5, 1], look_at: [0, 0, 0.5], field_of_view: 50deg}
background: {color: [0.2, 0.3, 0.5]}
lights: [point: {position: [3, -4, 5]}]
materials: {mirror: {diffuse: 0.3, specular: 0.6}}
objects:
  - sphere: {name: left, center: [-1.2, 0, 0.5], radius: 0.5, material: mirror}
  - sphere: {name: right, center: [1.2, 0, 0.5], radius: 0.5, material: mirror}
animation:
  frames: 48
  tracks:
    - {target: left, rotate: {center: [0, 0, 0.5], axis: [0, 0, 1], angle: 360deg}, frames: [0, 48]}
YAML
"$rt" render film.yaml -o whole.mp4
"$rt" render film.yaml -o whole.png --size 400x400 --frames 7

job=film.job
"$rt" farm submit film.yaml -o film.mp4 --engine slurm --chunk 6 -t 1
wait_for 120 test -s film.mp4
cmp film.mp4 whole.mp4 || fail "the film is another one"
for frame in whole.frames/*.png; do cmp "$frame" "film.frames/${frame##*/}" || fail "$frame"; done
(($(attempts) == 8)) || fail "frames were rendered twice"
[[ $(cat film.job/log/*.events | awk '$1 == "start" {print $3}' | sort -u | xargs) == "n1 n2" ]] || fail "one node did nothing"
echo "film: $SECONDS s"

job=tiles.job
"$rt" farm submit film.yaml -o tiles.png --engine slurm --size 400x400 --frames 7 --tiles=50 -t 1 --job tiles.job
wait_for 180 test -s tiles.png
cmp tiles.png whole.png || fail "the picture is another one"
(($(attempts) == 64)) || fail "not 64 tiles, each once"
echo "64 tiles: $SECONDS s"

# More tasks than an array may have; cancelled, nothing of it is left in Slurm; resumed, it is Slurm's again.
job=many.job
"$rt" farm submit film.yaml -o many.mp4 --set animation.frames=100 --size 16x12 --engine slurm --chunk 1 -t 1 --job many.job
(($(grep -c '"frames"' many.job/job.json) == 50)) || fail "100 frames are not 50 tasks of 2"
"$rt" farm cancel many.job
status '; cancelled'
wait_for 30 nothing_queued
"$rt" farm resume many.job
wait_for 120 test -s many.mp4
"$rt" render film.yaml -o many_whole.mp4 --set animation.frames=100 --size 16x12
cmp many.mp4 many_whole.mp4 || fail "the film is another one after it was cancelled"
echo "cancelled and resumed: $SECONDS s"

options=(--size 480x360 --set 'render.antialias={grid: 3}')
"$rt" render film.yaml -o faults_whole.mp4 "${options[@]}"

# A task gets SIGKILL, another finds its disk full, and what a third has done is damaged.
job=faults.job
mkdir -p faults.job/out/task_0005
mount -t tmpfs -o size=64k tmpfs faults.job/out/task_0005 && full=$work/faults.job/out/task_0005 ||
    echo "no small disk can be made here; none is full"
"$rt" farm submit film.yaml -o faults.mp4 --engine slurm --chunk 6 -t 1 --job faults.job "${options[@]}"
wait_for 60 test -s faults.job/log/task_0002.events
kill -9 "$(awk '$1 == "start" {print $4; exit}' faults.job/log/task_0002.events)" || fail "the task was too quick to be killed"
wait_for 60 grep -q '^end .* 0$' faults.job/log/task_0000.events
rendered | grep -v task_0000/frame_0001 >before.txt
echo damaged >faults.job/out/task_0000/frame_0001.png
again=10
if [[ -n $full ]]; then
    wait_for 60 grep -q '^end .* 75$' faults.job/log/task_0005.events
    mount -o remount,size=8m "$full"
    again=11
fi
wait_for 120 test -s faults.mp4
cmp faults.mp4 faults_whole.mp4 || fail "the film is another one after faults"
kept before.txt
(($(attempts) == again)) || fail "other tasks than those that failed were done again"
status '^task 0, frames 0-5: done, attempt 2 on n[12]; attempt 1 on n[12] was done, and then lost or damaged$'
status '^task 2, frames 12-17: done, attempt 2 on n[12]; attempt 1 on n[12] was killed$'
[[ -z $full ]] || status '^task 5, frames 30-35: done, attempt 2 on n[12]; attempt 1 on n[12], exit 75$'
"$rt" farm status faults.job
echo "killed, damaged, full: $SECONDS s"

if [[ -n ${RT_FARM_LONG:-} ]]; then
    job=node.job
    "$rt" farm submit film.yaml -o node.mp4 --engine slurm --chunk 6 -t 1 --job node.job "${options[@]}"
    wait_for 60 grep -q '^start .* n2 ' node.job/log/task_000{0,1,2,3}.events
    # One node goes, with its step daemons and tasks; the other stays.
    end_processes n2
    [[ -n $(processes_of n1) ]] || fail "both nodes are lost"
    rendered >before.txt
    lost=$(awk '$1 == "start" {node[FILENAME] = $3} $1 == "end" {delete node[FILENAME]}
        END {for (file in node) if (node[file] == "n2") print file}' node.job/log/*.events)
    [[ -n $lost ]] || fail "no task ran on the node that was lost"
    wait_for 120 test -s node.mp4
    cmp node.mp4 faults_whole.mp4 || fail "the film is another one after a node was lost"
    kept before.txt
    for events in node.job/log/*.events; do
        times=$(grep -c '^start ' "$events")
        ((times == ($(grep -cxF "$events" <<<"$lost") ? 2 : 1))) || fail "$events: $times attempts"
    done
    for events in $lost; do status "^task $((10#${events//[^0-9]/})), .* attempt 1 on n2 was killed$"; done
    "$rt" farm status node.job
    echo "a node lost: $SECONDS s"
fi

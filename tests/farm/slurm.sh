#!/usr/bin/env bash
# rt farm on a real Slurm of two nodes: slurm.sh RT. Ends with 77 (skipped) where there is none.
# RT_FARM_LONG=1 also kills a node in mid-film, which Slurm takes 45 s to notice.
set -euo pipefail
rt=$1
source "$(dirname "${BASH_SOURCE[0]}")/two_nodes.sh"
((EUID == 0)) && command -v slurmctld munged >/dev/null || {
    echo "there is no Slurm here, or no right to start one"
    exit 77
}
work=$(mktemp -d)
slurm=$work/slurm
trap 'stop_slurm; cd /; rm -rf "$work"' EXIT
cd "$work"
start_slurm || {
    echo "Slurm does not start here"
    tail -n 5 "$slurm"/*.log || true
    exit 77
}

fail() {
    echo "FAILED: $*"
    "$rt" farm status "$job" || true
    tail -n 20 "$job"/log/*.log 2>/dev/null || true
    exit 1
}
# wait_for FILE SECONDS
wait_for() {
    local end=$((SECONDS + $2))
    until [[ -s $1 ]]; do
        ((SECONDS < end)) || fail "$1 is not there after $2 s"
        sleep 0.2
    done
}
attempts() { cat "$job"/log/*.events | grep -c '^start '; }

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
wait_for film.mp4 120
cmp film.mp4 whole.mp4 || fail "the film is another one"
for frame in whole.frames/*.png; do cmp "$frame" "film.frames/${frame##*/}" || fail "$frame"; done
(($(attempts) == 8)) || fail "frames were rendered twice"

job=tiles.job
"$rt" farm submit film.yaml -o tiles.png --engine slurm --size 400x400 --frames 7 --tiles=50 -t 1 --job tiles.job
wait_for tiles.png 180
cmp tiles.png whole.png || fail "the picture is another one"

# A task gets SIGKILL: its script says so with 75, and it is done again.
job=killed.job
"$rt" farm submit film.yaml -o killed.mp4 --engine slurm --chunk 6 -t 1 --job killed.job --size 480x360 \
    --set 'render.antialias={grid: 3}'
wait_for killed.job/log/task_0002.events 60
kill -9 "$(awk '$1 == "start" {print $4; exit}' killed.job/log/task_0002.events)" || fail "the task was too quick to be killed"
# Slurm waits two minutes before it begins a requeued task again.
for ((i = 0; i < 60; ++i)); do
    for id in $(squeue -h -o %i -t PD 2>/dev/null); do scontrol update JobId="$id" StartTime=now 2>/dev/null || true; done
    [[ -s killed.mp4 ]] && break
    sleep 1
done
wait_for killed.mp4 120
"$rt" render film.yaml -o killed_whole.mp4 --size 480x360 --set 'render.antialias={grid: 3}'
cmp killed.mp4 killed_whole.mp4 || fail "the film is another one after a kill"
(($(attempts) == 9)) || fail "other than the killed task was done again"
"$rt" farm status killed.job

if [[ -n ${RT_FARM_LONG:-} ]]; then
    job=node.job
    "$rt" farm submit film.yaml -o node.mp4 --engine slurm --chunk 6 -t 1 --job node.job --size 480x360 \
        --set 'render.antialias={grid: 3}'
    wait_for node.job/log/task_0001.events 60
    lost=$(awk '$1 == "start" && $3 == "n2" {print FILENAME, $4}' node.job/log/*.events | head -1)
    [[ -n $lost ]] || fail "no task runs on n2"
    # The node with its step daemons and tasks.
    node=$(<"$slurm/n2.pid")
    kill -9 "$node"
    for pid in $(pgrep -f "slurmstepd.*"); do
        [[ $(tr '\0' '\n' </proc/$pid/environ 2>/dev/null | grep -c "SLURM_CONF=$slurm") -gt 0 ]] || continue
        pgrep -P "$pid" >/dev/null && kill -9 "$pid" 2>/dev/null || true
    done
    kill -9 "${lost##* }" 2>/dev/null || true
    for ((i = 0; i < 200; ++i)); do
        for id in $(squeue -h -o %i -t PD 2>/dev/null); do scontrol update JobId="$id" StartTime=now 2>/dev/null || true; done
        [[ -s node.mp4 ]] && break
        sleep 1
    done
    wait_for node.mp4 60
    cmp node.mp4 killed_whole.mp4 || fail "the film is another one after a node was lost"
    "$rt" farm status node.job
fi
echo "done in $SECONDS s"

#!/usr/bin/env python3
"""versus.py BUILD [ROUNDS]: rt and POV-Ray draw the same four pictures, its octree and Embree trace the same rays; prints two
tables of Markdown.

Each scene is written for both by hand: ambient 0, the same lights, one ray through the middle of each pixel, as many bounces,
POV-Ray without its cut-off of dim rays. Rounds are interleaved and medians taken. `trace` is what each program itself reports
for tracing; `whole` is the process from start to the written PNG. A pixel differs where a channel does by more than 2/255 in
linear light. RT_TIMED: a command that runs the timed ones, on a machine with other work.
"""
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = ["sphereflake", "mesh", "glass", "checker"]
SIZE = (640, 480)
PREFIX = os.environ.get("RT_TIMED", "").split()


def run(command, fine=(0,)):
    """Seconds of the process and what it said, stdout and stderr together; ends with it unless its exit code is fine."""
    start = time.monotonic()
    done = subprocess.run(PREFIX + command, cwd=HERE, capture_output=True, text=True)
    seconds = time.monotonic() - start
    if done.returncode not in fine:
        sys.exit(f"versus: {' '.join(command)}\n{done.stdout}{done.stderr}")
    return seconds, done.stdout + done.stderr


def rt(program, work, scene, threads):
    report = f"{work}/stats.json"
    command = [program, "render", "--quiet", f"{scene}.yaml", "--size", "%dx%d" % SIZE, "--threads", str(threads), "-o",
               f"{work}/rt.png"]
    whole, _ = run(command)
    run(command + ["--stats=" + report])  # counting what rays visit takes some time of its own
    with open(report, encoding="utf-8") as file:
        return next(phase["wall_seconds"] for phase in json.load(file)["phases"] if phase["name"] == "trace"), whole


def povray(work, scene, threads):
    whole, said = run(["povray", f"+I{scene}.pov", f"+O{work}/pov.png", f"+L{work}", "+L.", "+W%d" % SIZE[0],
                       "+H%d" % SIZE[1], "-A", "-D", "+FN8", "File_Gamma=srgb", f"+WT{threads}"])
    trace = re.search(r"Trace Time:.*\(([0-9.]+) seconds\)", said)
    return float(trace.group(1)), whole


def write_mesh(path):
    """knot.obj as a POV-Ray mesh2, polygons as fans."""
    vertices, triangles = [], []
    with open(f"{HERE}/../../../scenes/generated/knot.obj", encoding="ascii") as file:
        for line in file:
            words = line.split()
            if words and words[0] == "v":
                vertices.append("<" + ",".join(words[1:4]) + ">")
            elif words and words[0] == "f":
                corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
                triangles += ["<%d,%d,%d>" % (corners[0], corners[k], corners[k + 1]) for k in range(1, len(corners) - 1)]
    with open(path, "w", encoding="ascii") as out:
        out.write("#declare Knot = mesh2 {\n  vertex_vectors { %d,\n%s }\n  face_indices { %d,\n%s }\n}\n" %
                  (len(vertices), ",\n".join(vertices), len(triangles), ",\n".join(triangles)))


def versus_embree(build, rounds):
    """Mrays/s of single rays on one thread, behind it how often as fast as Embree's robust mode; see octree_bench."""
    print("\n| mesh | primitives | primary | shadow | mirror | random | build: rt / Embree | other hits |")
    print("|---|---|---|---|---|---|---|---|")
    for what in (["scan70k", "scan870k", "ico", "stadium", "soup"], ["--spheres"]):
        _, said = run([f"{build}/bin/octree_bench", "--json", "--rounds", str(rounds)] + what)
        for line in said.splitlines():
            mesh = json.loads(line)
            single = [c for c in mesh["rays"] if c["class"] in ("primary", "shadow", "mirror", "random")]
            cells = [f"{c['mrays']:.1f} ({c['ratio_robust']:.2f})" for c in single]
            print(f"| {mesh['mesh']} | {mesh['triangles']} | {' | '.join(cells)} | {mesh['ratio_build']:.2f} | "
                  f"{sum(c['mismatches'] for c in single)} |", flush=True)


def main():
    build = os.path.abspath(sys.argv[1])
    program = build + "/bin/rt"
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 5
    with tempfile.TemporaryDirectory() as work:
        write_mesh(f"{work}/knot.inc")
        print("| scene | differing pixels | threads | trace: POV-Ray | rt | ratio | whole: POV-Ray | rt | ratio |")
        print("|---|---|---|---|---|---|---|---|---|")
        for scene in SCENES:
            for threads in (1, 2):
                times = [(rt(program, work, scene, threads), povray(work, scene, threads)) for _ in range(rounds)]
                ours, theirs = ([statistics.median(t[side][part] for t in times) for part in (0, 1)] for side in (0, 1))
                _, said = run([program, "compare", f"{work}/rt.png", f"{work}/pov.png", "--tolerance", str(2 / 255),
                                "--json"], fine=(0, 1))
                difference = json.loads(said)
                share = 100 * difference["over"] / difference["pixels"]
                print(f"| {scene} | {share:.2f} % | {threads} | {theirs[0]:.3f} s | {ours[0]:.3f} s | "
                      f"{theirs[0] / ours[0]:.1f} | {theirs[1]:.3f} s | {ours[1]:.3f} s | {theirs[1] / ours[1]:.1f} |",
                      flush=True)
    versus_embree(build, rounds)


main()

"""What light, surfaces, clipping and several variables cost, beside the same frame without; grids also beside VTK's
mappers with shading (those for meshes have none)."""
import json
import statistics

import numpy as np

import grid_workloads
import workloads
from peers import GRID_PEERS
from tool import Failed
from workloads import REPEATS, ROUNDS, PeerRun, frame_seconds, say, skipped

DATASETS = {"bluntfin": workloads, "embryo": grid_workloads, "neghip": grid_workloads}
RESOLUTION = ("--resolution", "512,512")
MATERIAL = "0.3,0.7,0.3,32"  # what VTK's property is given, too
SHADE = ("--lights", "headlight", "--material", MATERIAL)
# As VTK samples: plain, and lit.
AT_RATE, LIT_AT_RATE = "plain, 1 sample a voxel", "one headlight, 1 sample a voxel"


def survey(tool, scene):
    """World bounds of a scene's data, and the range of the array that it draws."""
    with open(scene) as file:
        data = json.load(file)["data"]
    info = tool.info(data["file"])
    array = next(array for array in info["arrays"] if data.get("array") in (None, array["name"]))
    return info["bounds"], array["range"]


def variants(tool, scene):
    """Name -> options of what is compared with the plain frame."""
    bounds, values = survey(tool, scene)
    middle = [0.5 * (low + high) for low, high in bounds]
    plane = ",".join(str(x) for x in (*middle, 1, 0.4, 0.2))
    iso = str(values[0] + 0.3 * (values[1] - values[0]))
    return {
        "one headlight": SHADE,
        "one headlight, tolerance 0.01": (*SHADE, "--tolerance", "0.01"),
        "clipped by a plane": ("--clip-plane", plane),
        "an opaque iso-surface in it": ("--lights", "none", "--isosurface", iso + ":0.9,0.9,0.9"),
        "value by gradient": ("--variables", "gradient"),
    }


def measure(tool, display, name, options):
    """One dataset: the plain frame, its variants and the peers with shading take turns."""
    module = DATASETS[name]
    scene, peer_scene = module.prepare_scenes(tool, name, options)
    rounds = 1 if options.quick else ROUNDS
    asked = variants(tool, scene)
    bases, peers = {}, {}  # what variants are compared with instead of the plain frame; VTK's mappers
    if module is grid_workloads:
        asked |= {AT_RATE: grid_workloads.at_rate(1.0), LIT_AT_RATE: (*grid_workloads.at_rate(1.0), *SHADE)}
        bases = {LIT_AT_RATE: AT_RATE}
        peers = {peer: PeerRun(display, peer + ":shaded", peer_scene, 512) for peer in GRID_PEERS}
    plain, times = [], {variant: [] for variant in asked}
    for _ in range(rounds):
        plain.append(tool.render(scene, *RESOLUTION, "--repeat", str(REPEATS)))
        for variant, extra in asked.items():
            times[variant].append(tool.render(scene, *RESOLUTION, *extra, "--repeat", str(REPEATS)))
        for peer in peers.values():
            peer.frame()
    own = frame_seconds(plain)
    row = {"plain": statistics.median(own), "variants": {}, "peers": {}}
    for variant, runs in times.items():
        seconds = frame_seconds(runs)
        base = frame_seconds(times[bases[variant]]) if variant in bases else own
        ratio = statistics.median(a / b for a, b in zip(seconds, base))
        row["variants"][variant] = {"frame": statistics.median(seconds), "ratio": ratio}
    for peer, run in peers.items():
        row["peers"][peer] = run.finish(tool.path("peer.npy"), np.zeros((512, 512, 3)),
                                        ratio=frame_seconds(times["one headlight"]),
                                        fast_ratio=frame_seconds(times[LIT_AT_RATE]))
    return row


def measure_effects(tool, display, options):
    rows = []
    for name in DATASETS:
        say(f"effects: {name}")
        try:
            row = measure(tool, display, name, options)
        except Failed as error:
            row = skipped(error)
        rows.append(dict(row, workload=name))
    return rows

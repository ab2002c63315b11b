"""What is measured of grids: named workloads beside VTK's mappers for images, and sizes for scaling."""
import os

import numpy as np

from peers import GRID_PEERS
from tool import Failed
from workloads import REPEATS, ROUNDS, PeerRun, frame_seconds, load_scene, say, skipped, summary

# Name -> dataset, for a scene of the same name in bench/scenes: what is drawn where nobody asks for anything.
WORKLOADS = {
    "neghip": "data/neghip.slc",  # 66^3 uint8
    "embryo": "data/embryo.slc",  # 256^3 uint8
    "ch2": "data/ch2.nii.gz",  # 181 x 217 x 181 uint8
    "marschner-lobb": "builtin:marschner-lobb?size=256",  # float32
}
RESOLUTION = ("--resolution", "512,512")
# Beside the default (half an 8-bit step): errs less than the peers do, which sample once a voxel.
FAST = ("--samples-per-voxel", "0.8", "--tolerance", "0.1")
EXACT = ("--integrator", "partial", "--tolerance", "1e-6", "--early-ray-termination", "off")
# Points along each side of the turbulence, of type uint8; the last one is for memory.
SCALING_SIZES = (64, 256, 512, 1024)


def prepare_scenes(tool, name, options):
    """Scene for tetravox, and for the peers the same with the grid as tetravox sees it, as VTI."""
    scene = os.path.join(options.scenes, name + ".json")
    dataset = WORKLOADS[name]
    if not dataset.startswith("builtin:"):
        dataset = os.path.join(options.shared, dataset)
        if not os.path.exists(dataset):
            raise Failed(f"{dataset} is absent")
    return load_scene(tool, scene, dataset), load_scene(tool, scene, tool.export(dataset, name + ".vti"))


def compare(tool, display, scene, peer_scene, rounds):
    """One row of the table: tetravox as exact as by default, fast, and fast by OpenGL, and the peers take turns."""
    tool.render(scene, *RESOLUTION, *EXACT, output="exact.npy")
    exact = np.load(tool.path("exact.npy"))
    peers = {name: PeerRun(display, name, peer_scene, exact.shape[0]) for name in GRID_PEERS}
    repeat = ("--repeat", str(REPEATS))
    own, fast, by_opengl, without_opengl = [], [], [], None
    for _ in range(rounds):
        own.append(tool.render(scene, *RESOLUTION, *repeat))
        fast.append(tool.render(scene, *RESOLUTION, *repeat, *FAST, output="fast.npy"))
        try:
            by_opengl.append(tool.render(scene, *RESOLUTION, *repeat, *FAST, "--backend", "gl", output="gl.npy"))
        except Failed as error:
            without_opengl = skipped(error)
        for peer in peers.values():
            peer.frame()
    row = {
        "tetravox": summary(own, tool.path("picture.npy"), exact),
        "fast": summary(fast, tool.path("fast.npy"), exact),
        "gl": without_opengl or summary(by_opengl, tool.path("gl.npy"), exact),
    }
    for name, peer in peers.items():
        times = {"ratio": own, "fast_ratio": fast, "gl_ratio": by_opengl}
        row[name] = peer.finish(tool.path("peer.npy"), exact,
                                **{key: frame_seconds(runs) for key, runs in times.items() if runs})
    return row


def measure_rendering(tool, display, options):
    """Frame times, errors against the exact picture, memory, preparation."""
    rows = []
    for name in WORKLOADS:
        say(f"grids: {name}")
        try:
            scene, peer_scene = prepare_scenes(tool, name, options)
            row = compare(tool, display, scene, peer_scene, 1 if options.quick else ROUNDS)
        except Failed as error:
            row = skipped(error)
        rows.append(dict(row, workload=name))
    return rows


def measure_scaling(tool, options):
    """The same field with more and more points, as it is drawn where nobody asks for anything."""
    rows = []
    for size in SCALING_SIZES[:2] if options.quick else SCALING_SIZES:
        say(f"grids: turbulence of {size}^3 points")
        try:
            row = tool.render(f"builtin:turbulence?size={size}&type=uint8", *RESOLUTION, "--repeat", str(REPEATS))
        except Failed as error:
            row = skipped(error)
        rows.append(dict(row, size=size))
    return rows

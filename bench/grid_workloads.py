"""What is measured of grids: named workloads beside VTK's mappers for images, and sizes for scaling."""
import os

import numpy as np

from peers import GRID_PEERS
from tool import Failed
from workloads import REPEATS, ROUNDS, PeerRun, difference, frame_seconds, load_scene, say, skipped, summary

# Name -> dataset, for a scene of the same name in bench/scenes: what is drawn where nobody asks for anything.
WORKLOADS = {
    "neghip": "data/neghip.slc",  # 66^3 uint8
    "embryo": "data/embryo.slc",  # 256^3 uint8
    "ch2": "data/ch2.nii.gz",  # 181 x 217 x 181 uint8
    "marschner-lobb": "builtin:marschner-lobb?size=256",  # float32
}
RESOLUTION = ("--resolution", "512,512")
# Beside the default (half an 8-bit step) as exact as a peer, which samples once a voxel: the coarsest of these rates at
# which the picture errs no more than its own, neither at most nor on average.
RATES = tuple(n / 20 for n in range(5, 21)) + (1.25, 1.6, 2.0)
FAST_TOLERANCE = "0.1"
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


def at_rate(rate):
    return ("--samples-per-voxel", f"{rate:g}", "--tolerance", FAST_TOLERANCE)


def find_rate(tool, scene, exact, error):
    """The coarsest rate that errs no more than `error`; the one that peers have where there is none."""
    if error is None:
        return 1.0
    for rate in RATES:
        tool.render(scene, *RESOLUTION, *at_rate(rate), output="fast.npy")
        own = difference(tool.path("fast.npy"), exact)
        if own["max"] <= error["max"] and own["rms"] <= error["rms"]:
            return rate
    return RATES[-1]


class Method:
    """A way to draw the scene with the tool; collects its runs."""

    def __init__(self, name, *options):
        self.picture, self.options, self.runs = name + ".npy", options, []

    def frame(self, tool, scene):
        self.runs.append(tool.render(scene, *RESOLUTION, "--repeat", str(REPEATS), *self.options, output=self.picture))

    def finish(self, tool, exact):
        return summary(self.runs, tool.path(self.picture), exact)


class OptionalMethod(Method):
    """One that a build or a machine may lack: without runs then."""

    def frame(self, tool, scene):
        try:
            super().frame(tool, scene)
        except Failed as error:
            self.runs, self.lack = [], error

    def finish(self, tool, exact):
        return super().finish(tool, exact) if self.runs else skipped(self.lack)


def compare(tool, display, scene, peer_scene, rounds):
    """One row of the table: tetravox as exact as by default, as exact as each peer, and the peers take turns."""
    tool.render(scene, *RESOLUTION, *EXACT, output="exact.npy")
    exact = np.load(tool.path("exact.npy"))
    peers = {name: PeerRun(display, name, peer_scene, exact.shape[0]) for name in GRID_PEERS}
    rates = {name: find_rate(tool, scene, exact, peer.error(tool.path("peer.npy"), exact))
             for name, peer in peers.items()}
    own = Method("picture")
    fast = {name: Method("fast-" + name, *at_rate(rate)) for name, rate in rates.items()}
    opengl = OptionalMethod("opengl", *at_rate(rates["gpu"]), "--backend", "gl")
    for _ in range(rounds):
        for method in (own, *fast.values(), opengl):
            method.frame(tool, scene)
        for peer in peers.values():
            peer.frame()
    row = {"tetravox": own.finish(tool, exact), "gl": opengl.finish(tool, exact), "rates": rates,
           "fast": {name: method.finish(tool, exact) for name, method in fast.items()}}
    for name, peer in peers.items():
        times = {"ratio": own.runs, "fast_ratio": fast[name].runs, "gl_ratio": opengl.runs if name == "gpu" else []}
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

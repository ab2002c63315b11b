"""What is measured of meshes, and how: named workloads, the exact pictures they are held against, sizes for scaling."""
import json
import os
import statistics
import sys

import numpy as np

from peers import MESH_PEERS, Peer
from tool import Failed

# Name -> dataset, for a scene of the same name in bench/scenes.
WORKLOADS = {
    "bluntfin": "data/bluntfin.vtu",  # 224,874 tetrahedra (Hung and Buning 1984)
    "post": "data/post.vtu",  # 616,050 tetrahedra (Rogers, Kwak, Kaul 1986)
    "buckyball": "builtin:buckyball",
}
SIZES = (512, 1024)
ROUNDS = 5
REPEATS = 5  # frames of tetravox a round

# Scenes with exact pictures, drawn by an independent integrator in double precision.
EXACT_SCENES = ("bluntfin-smooth", "bluntfin-spikes", "bluntfin-step", "bluntfin-inside", "post-smooth", "post-random",
                "post-thick")
SCALING_CELLS = (200_000, 2_000_000, 20_000_000)
STARTS = 9


def say(text):
    print(text, file=sys.stderr, flush=True)


def skipped(why):
    return {"skipped": str(why)}


def load_scene(tool, path, data_file=None):
    """Path of a copy of the scene whose data file is absolute, or another one."""
    with open(path) as file:
        scene = json.load(file)
    data = scene["data"]
    if data_file:
        data["file"] = data_file
    elif not data["file"].startswith("builtin:"):
        data["file"] = os.path.abspath(os.path.join(os.path.dirname(path), data["file"]))
    copy = tool.path(f"scene-{len(os.listdir(tool.work))}.json")
    with open(copy, "w") as file:
        json.dump(scene, file)
    return copy


def prepare_scenes(tool, name, options):
    """Scene for tetravox and scene for the peers of a workload."""
    scene = os.path.join(options.scenes, name + ".json")
    dataset = WORKLOADS[name]
    if dataset.startswith("builtin:"):
        return load_scene(tool, scene), load_scene(tool, scene, tool.export(dataset, name + ".vtu"))
    path = os.path.join(options.shared, dataset)
    if not os.path.exists(path):
        raise Failed(f"{path} is absent")
    copy = load_scene(tool, scene, path)
    return copy, copy


def difference(path, exact):
    """Root mean square and maximum over all pixels and colour channels, over black."""
    delta = np.load(path)[..., :3].astype(np.float64) - np.clip(exact[..., :3], 0, 1)
    return {"rms": float(np.sqrt(np.mean(delta**2))), "max": float(np.abs(delta).max())}


class PeerRun:
    """A peer, or why there is none; collects its frames."""

    def __init__(self, display, mapper, scene, size):
        self.times, self.result, self.peer = [], {}, None
        try:
            self.peer = Peer(display, mapper, scene, size)
            self.result = {"vtk": self.peer.hello["vtk"], "read": self.peer.hello["read"]}
            self.result["first_frame"] = self.peer.ask("frame")["seconds"]
        except Failed as error:
            self.fail(error)

    def fail(self, error):
        self.result, self.peer = skipped(error), None

    def frame(self):
        if not self.peer:
            return
        try:
            answer = self.peer.ask("frame")
            self.times.append(answer["seconds"])
            self.result["peak_rss"] = answer["peak_rss"]
        except Failed as error:
            self.fail(error)

    def error(self, path, exact):
        """Of its picture; None where there is no peer."""
        if not self.peer:
            return None
        try:
            self.peer.ask("image " + path)
        except Failed as error:
            self.fail(error)
            return None
        return difference(path, exact)

    def finish(self, path, exact, **own_times):
        """The result, with a ratio for each of the tool's times by their key: the median over the rounds, so that a
        slow moment counts for both or not at all."""
        own_error = self.error(path, exact)
        if self.peer:
            self.result.update(frame=statistics.median(self.times), error=own_error)
            for key, times in own_times.items():
                self.result[key] = statistics.median(a / b for a, b in zip(self.times, times))
            self.peer.close()
        return self.result


def compare(tool, display, scene, peer_scene, size, rounds, exact=None):
    """One row of the rendering table: tetravox and the peers take turns."""
    resolution = ["--resolution", f"{size},{size}"]
    if exact is None:
        tool.render(scene, *resolution, "--integrator", "partial", output="exact.npy")
        exact = np.load(tool.path("exact.npy"))
    peers = {name: PeerRun(display, name, peer_scene, size) for name in MESH_PEERS}
    own = []
    for _ in range(rounds):
        own.append(tool.render(scene, *resolution, "--repeat", str(REPEATS)))
        for peer in peers.values():
            peer.frame()
    row = {"size": size, "tetravox": summary(own, tool.path("picture.npy"), exact)}
    for name, peer in peers.items():
        row[name] = peer.finish(tool.path("peer.npy"), exact, ratio=frame_seconds(own))
    return row


def summary(runs, picture, exact):
    """The tool's statistics, each time the median over the runs, and the error of its picture."""
    seconds = {key: statistics.median(run["seconds"][key] for run in runs) for key in runs[0]["seconds"]}
    return dict(runs[-1], seconds=seconds, error=difference(picture, exact))


def frame_seconds(runs):
    return [run["seconds"]["frame"] for run in runs]


def measure_rendering(tool, display, options):
    """Frame times, errors against exact pre-integration at the same size, memory, preparation."""
    rows = []
    for name in WORKLOADS:
        for size in SIZES[:1] if options.quick else SIZES:
            say(f"rendering: {name} {size}x{size}")
            try:
                scene, peer_scene = prepare_scenes(tool, name, options)
                row = compare(tool, display, scene, peer_scene, size, 1 if options.quick else ROUNDS)
            except Failed as error:
                row = skipped(error)
            rows.append(dict(row, workload=name, size=size))
    return rows


def measure_exactness(tool, display, options):
    """Errors against pictures of an independent integrator, at their own size."""
    rows = []
    for name in EXACT_SCENES[:2] if options.quick else EXACT_SCENES:
        say(f"exactness: {name}")
        path = os.path.join(options.shared, "truth", name)
        row = {"workload": name}
        try:
            if not os.path.exists(path + ".npy"):
                raise Failed(f"{path}.npy is absent")
            exact = np.load(path + ".npy")
            scene = load_scene(tool, path + ".json")
            for integrator in ("antiderivative", "partial"):
                tool.render(scene, "--integrator", integrator)
                row[integrator] = difference(tool.path("picture.npy"), exact)
            for mapper in MESH_PEERS:
                peer = PeerRun(display, mapper, scene, exact.shape[0])
                peer.frame()
                result = peer.finish(tool.path("peer.npy"), exact)
                row[mapper] = result.get("error", result)
        except Failed as error:
            row.update(skipped(error))
        rows.append(row)
    return rows


def measure_scaling(tool, options):
    """The same scene with more and more cells: the cost follows the segments of the picture, not the mesh."""
    rows = []
    for cells in SCALING_CELLS[:2] if options.quick else SCALING_CELLS:
        say(f"scaling: {cells} cells")
        scene = load_scene(tool, os.path.join(options.scenes, "buckyball.json"), f"builtin:buckyball?cells={cells}")
        try:
            rows.append(dict(tool.render(scene, "--resolution", "512,512", "--repeat", str(REPEATS)), cells=cells))
        except Failed as error:
            rows.append(dict(skipped(error), cells=cells))
    return rows


def measure_startup(tool, options):
    """Seconds from the shell to the written PNG, reading included."""
    rows = []
    path = os.path.join(options.shared, WORKLOADS["bluntfin"])
    for name, extra in (("bluntfin, no option", []), ("bluntfin, 512x512", ["--resolution", "512,512"])):
        say(f"shell to PNG: {name}")
        command = [tool.program, "render", path, *extra, "-o", tool.path("start.png")]
        try:
            if not os.path.exists(path):
                raise Failed(f"{path} is absent")
            tool.run(command)  # the file is in the cache from here on
            times = [tool.run(command) for _ in range(3 if options.quick else STARTS)]
            rows.append({"workload": name, "seconds": statistics.median(times), "least": min(times)})
        except Failed as error:
            rows.append(dict(skipped(error), workload=name))
    return rows

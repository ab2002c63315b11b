"""Results as Markdown tables."""
import os
import platform

from grid_workloads import FAST_TOLERANCE
from peers import GRID_PEERS, MESH_PEERS

BEGIN, END = "<!-- bench: begin (make bench README=README.md) -->", "<!-- bench: end -->"


def machine():
    model = platform.processor() or platform.machine()
    try:
        with open("/proc/cpuinfo") as file:
            names = [line.split(":", 1)[1].strip() for line in file if line.startswith("model name")]
        model = names[0] if names else model
    except OSError:
        pass
    return {"processor": model, "cores": len(os.sched_getaffinity(0)), "system": platform.platform(terse=True)}


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def skipped_row(row, name, width):
    return [name, f"SKIPPED: {row['skipped']}"] + [""] * (width - 2)


def seconds(value):
    return f"{value * 1e3:.0f} ms" if value < 1 else f"{value:.2f} s"


def megabytes(value):
    return f"{value / 2**20:.0f} MiB"


def tool_memory(statistics):
    """Peak of the tool and of its reader process, which lives for a part of that time."""
    return statistics["bytes"]["peak_rss"] + statistics["bytes"]["reader_peak_rss"]


def error(value):
    return f"{value['max']:.1e} ({value['rms']:.1e})" if "max" in value else "SKIPPED"


def own_row(names, own, ratios):
    """A row of tetravox beside VTK: cells `names`, an empty one for each of the ratios, measures."""
    times = own["seconds"]
    return [*names, seconds(times["frame"]), *("" for _ in ratios), error(own["error"]), seconds(times["read"]),
            seconds(times["prepare"]) + " / " + seconds(times["first_frame"]), megabytes(tool_memory(own))]


def peer_row(names, peer, other, ratios):
    if "skipped" in other:
        return [*names, *skipped_row(other, peer, 6 + len(ratios))]
    return [*names, f"VTK {other['vtk']} {peer}", seconds(other["frame"]),
            *(f"{other[key]:.1f}×" if key in other else "–" for key in ratios), error(other["error"]),
            seconds(other["read"]), "– / " + seconds(other["first_frame"]), megabytes(other["peak_rss"])]


def rendering_table(rows):
    header = ["scene", "size", "method", "frame", "tetravox is faster by", "largest error (RMS)", "read",
              "prepare / first frame", "peak memory"]
    ratios = ("ratio",)
    lines = []
    for row in rows:
        names = [row["workload"], f"{row['size']}²"]
        if "skipped" in row:
            lines.append(skipped_row(row, names[0], len(header)))
            continue
        lines.append(own_row([*names, "**tetravox**"], row["tetravox"], ratios))
        lines += [peer_row(names, peer, row[peer], ratios) for peer in MESH_PEERS]
    return table(header, lines)


def speed_table(rows):
    header = ["scene", "size", "instruction set", "threads", "segments", "ns a segment", "million segments/s",
              "new transfer function"]
    lines = []
    for row in rows:
        if "skipped" in row:
            lines.append(skipped_row(row, row["workload"], len(header)))
            continue
        own = row["tetravox"]
        frame, segments = own["seconds"]["frame"], own["segments"]
        lines.append([row["workload"], f"{row['size']}²", own["isa"], str(own["threads"]), f"{segments / 1e6:.1f} M",
                      f"{frame / segments * 1e9:.1f}", f"{segments / frame / 1e6:.0f}",
                      f"{own['seconds']['transfer_function'] * 1e3:.2f} ms"])
    return table(header, lines)


def exactness_table(rows):
    methods = ["antiderivative", "partial", *MESH_PEERS]
    lines = []
    for row in rows:
        if "skipped" in row:
            lines.append(skipped_row(row, row["workload"], len(methods) + 1))
        else:
            lines.append([row["workload"], *(error(row[method]) for method in methods)])
    return table(["scene", "tetravox antiderivative", "tetravox partial", "VTK bunyk", "VTK pt"], lines)


def scaling_table(rows):
    header = ["cells asked", "frame", "segments", "ns a segment", "mesh", "peak memory", "prepare", "million cells/s prepared"]
    lines = []
    for row in rows:
        if "skipped" in row:
            lines.append(skipped_row(row, f"{row['cells']:,}", len(header)))
            continue
        times, segments = row["seconds"], row["segments"]
        lines.append([f"{row['cells']:,}", seconds(times["frame"]), f"{segments / 1e6:.1f} M",
                      f"{times['frame'] / segments * 1e9:.1f}", megabytes(row["bytes"]["mesh"]),
                      megabytes(tool_memory(row)), seconds(times["prepare"]),
                      f"{row['cells'] / times['prepare'] / 1e6:.1f}"])
    return table(header, lines)


def grid_table(rows):
    header = ["scene", "method", "frame", "tetravox is faster by", "as exact as it: by", "by OpenGL: by",
              "largest error (RMS)", "read", "prepare / first frame", "peak memory"]
    ratios = ("ratio", "fast_ratio", "gl_ratio")
    lines = []
    for row in rows:
        name = row["workload"]
        if "skipped" in row:
            lines.append(skipped_row(row, name, len(header)))
            continue
        lines.append(own_row([name, "**tetravox**"], row["tetravox"], ratios))
        for peer in GRID_PEERS:
            rate = f"{row['rates'][peer]:g} samples a voxel"
            lines.append(own_row([name, f"**tetravox**, {rate}"], row["fast"][peer], ratios))
            if peer == "gpu" and "skipped" not in row["gl"]:
                lines.append(own_row([name, f"**tetravox**, OpenGL, {rate}"], row["gl"], ratios))
            lines.append(peer_row([name], peer, row[peer], ratios))
    return table(header, lines)


def grid_scaling_table(rows):
    header = ["points", "frame", "segments", "segments a ray", "ns a segment", "prepare", "new transfer function",
              "values", "summaries", "peak memory"]
    lines = []
    for row in rows:
        name = f"{row['size']}³"
        if "skipped" in row:
            lines.append(skipped_row(row, name, len(header)))
            continue
        times, segments, parts = row["seconds"], row["segments"], row["bytes"]
        lines.append([name, seconds(times["frame"]), f"{segments / 1e6:.1f} M", f"{segments / row['rays']:.0f}",
                      f"{times['frame'] / segments * 1e9:.1f}", seconds(times["prepare"]),
                      f"{times['transfer_function'] * 1e3:.2f} ms", f"{(parts['grid'] - parts['summaries']) / 2**20:.2f} MiB",
                      f"{parts['summaries'] / 2**20:.2f} MiB", megabytes(tool_memory(row))])
    return table(header, lines)


def effects_table(rows):
    header = ["scene", "what", "frame", "times plain", "tetravox lit is faster by", "at 1 sample a voxel: by"]
    lines = []
    for row in rows:
        name = row["workload"]
        if "skipped" in row:
            lines.append(skipped_row(row, name, len(header)))
            continue
        lines.append([name, "plain", seconds(row["plain"]), "1", "", ""])
        for variant, own in row["variants"].items():
            lines.append([name, variant, seconds(own["frame"]), f"{own['ratio']:.2f}", "", ""])
        for peer, other in row["peers"].items():
            if "skipped" in other:
                lines.append([name, *skipped_row(other, peer, len(header) - 1)])
            else:
                lines.append([name, f"VTK {peer}, shaded", seconds(other["frame"]), "", f"{other['ratio']:.1f}×",
                              f"{other['fast_ratio']:.1f}×"])
    return table(header, lines)


def startup_table(rows):
    lines = []
    for row in rows:
        if "skipped" in row:
            lines.append(skipped_row(row, row["workload"], 3))
        else:
            lines.append([row["workload"], seconds(row["seconds"]), seconds(row["least"])])
    return table(["from the shell to the PNG", "median", "least"], lines)


def tables(results):
    """All tables as one Markdown text."""
    where = results["machine"]
    return "\n\n".join([
        f"Measured on {where['cores']} cores, {where['processor']}. The programs take turns; times and ratios are medians over"
        " the rounds.",
        "**Meshes beside VTK.** Errors in colour, over black, against exact pre-integration (`partial`) at the same"
        " size; VTK's pictures have 8 bits a channel, which alone errs by 2.0e-3. Memory of tetravox is the tool's peak"
        " plus its reader's.",
        rendering_table(results["rendering"]),
        "**Grids beside VTK.** 512², errors against the exact picture (`partial`, tolerance 1e-6). VTK takes one sample"
        " a voxel; tetravox what its tolerance asks by default, and at a fixed rate (`--samples-per-voxel N --tolerance"
        f" {FAST_TOLERANCE}`), the coarsest at which it errs no more than the mapper below it, at most and on average.",
        grid_table(results["grids"]),
        "**Speed on meshes.** A segment is one ray in one tetrahedron.",
        speed_table(results["rendering"]),
        "**Exactness on meshes.** Largest error (RMS) against pictures of an independent integrator in double precision, 256².",
        exactness_table(results["exactness"]),
        "**More cells.** `builtin:buckyball?cells=N`, 512².",
        scaling_table(results["scaling"]),
        "**More points.** `builtin:turbulence?size=N`, a byte each, 512². A segment is one ray in one cell, or in a"
        " block of cells that is drawn as one.",
        grid_scaling_table(results["grid_scaling"]),
        "**Light, surfaces, clipping, several variables.** 512². VTK shades grids alone, at one sample a voxel. What is"
        f" lit at that rate (`--samples-per-voxel 1 --tolerance {FAST_TOLERANCE}`) is compared with what is plain at it."
        " VTK's light is another model: pictures are not compared.",
        effects_table(results["effects"]),
        "**Start.**",
        startup_table(results["startup"]),
    ]) + "\n"


def replace_block(path, text):
    """Puts `text` between the markers of a file."""
    with open(path, encoding="utf-8") as file:
        content = file.read()
    before, found, rest = content.partition(BEGIN)
    _, found_end, after = rest.partition(END)
    if not (found and found_end):
        raise SystemExit(f"{path} has no markers {BEGIN} ... {END}")
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"{before}{BEGIN}\n\n{text}\n{END}{after}")

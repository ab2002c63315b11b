"""Results as Markdown tables."""
import os
import platform

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


def rendering_table(rows):
    header = ["scene", "size", "method", "frame", "tetravox is faster by", "largest error (RMS)", "read",
              "prepare / first frame", "peak memory"]
    lines = []
    for row in rows:
        name, size = row["workload"], f"{row['size']}²"
        if "skipped" in row:
            lines.append(skipped_row(row, name, len(header)))
            continue
        own = row["tetravox"]
        times = own["seconds"]
        lines.append([name, size, "**tetravox**", seconds(times["frame"]), "", error(own["error"]),
                      seconds(times["read"]), seconds(times["prepare"]) + " / " + seconds(times["first_frame"]),
                      megabytes(tool_memory(own))])
        for peer in ("bunyk", "pt"):
            other = row[peer]
            if "skipped" in other:
                lines.append([name, size, *skipped_row(other, peer, len(header) - 2)])
                continue
            lines.append([name, size, f"VTK {other['vtk']} {peer}", seconds(other["frame"]),
                          f"{other['ratio']:.1f}×", error(other["error"]), seconds(other["read"]),
                          "– / " + seconds(other["first_frame"]), megabytes(other["peak_rss"])])
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
    methods = ["antiderivative", "partial", "bunyk", "pt"]
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
        "**Beside VTK.** Errors in colour, over black, against exact pre-integration (`partial`) at the same size; VTK's"
        " pictures have 8 bits a channel, which alone errs by 2.0e-3. Memory of tetravox is the tool's peak plus its reader's.",
        rendering_table(results["rendering"]),
        "**Speed.** A segment is one ray in one tetrahedron.",
        speed_table(results["rendering"]),
        "**Exactness.** Largest error (RMS) against pictures of an independent integrator in double precision, 256².",
        exactness_table(results["exactness"]),
        "**Scaling.** `builtin:buckyball?cells=N`, 512².",
        scaling_table(results["scaling"]),
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

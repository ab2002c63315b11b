"""Visibility orders: speed and errors of every method (bench/visibility_orders.cpp)."""
import os
import subprocess

from workloads import say

EMBEDDED = ("builtin:buckyball", "builtin:duct")
FILES = ("bluntfin.vtu", "post.vtu", "disk_out_ref.ex2", "can.vtu")


def measure_orders(options):
    """The table as Markdown; a line for each file that is not there."""
    program = os.path.join(options.build, "bin", "visibility_orders")
    paths = {name: os.path.join(options.shared, "data", name) for name in FILES}
    inputs = [*EMBEDDED, *(path for path in paths.values() if os.path.exists(path))]
    say("orders")
    limits = ("--views", "2", "--pixels", "48") if options.quick else ()
    done = subprocess.run([program, *limits, *inputs], capture_output=True, text=True, timeout=1800)
    lines = [done.stdout if done.returncode == 0 else f"SKIPPED: {done.stderr.strip()}"]
    lines += [f"{name}: SKIPPED: not in {options.shared}" for name, path in paths.items() if not os.path.exists(path)]
    return "\n".join(lines) + "\n"

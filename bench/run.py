#!/usr/bin/env python3
"""Measures tetravox beside VTK's mappers for meshes (bunyk, pt) and for images (fixed, gpu), in one run.

    bench/run.py [--build build/release] [--shared DIR] [--out out/bench] [--quick] [--readme README.md]

Writes results.json, tables.md and orders.md (visibility orders), and prints the tables. The programs take turns (A B C A B C ..), so that a
machine that slows down slows all of them; every time is a median. What cannot run says SKIPPED and why.
"""
import argparse
import json
import os
import shutil
import sys

import effect_workloads
import grid_workloads
import order_workloads
import peers
import report
import workloads
from tool import Tool


def parse_arguments():
    root = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--build", default=os.path.join(root, "build", "release"), help="build directory")
    parser.add_argument("--shared", help="directory with data/ and truth/ (default: the build's TETRAVOX_SHARED_DIR)")
    parser.add_argument("--out", default=os.path.join(root, "out", "bench"), help="directory of the results")
    parser.add_argument("--quick", action="store_true", help="512x512 only, one round, small scaling tables")
    parser.add_argument("--readme", help="file whose block between the bench markers is replaced by the tables")
    options = parser.parse_args()
    options.shared = os.path.abspath(options.shared or shared_directory(options.build))
    options.scenes = os.path.join(root, "bench", "scenes")
    return options


def shared_directory(build):
    """TETRAVOX_SHARED_DIR as the build was configured."""
    with open(os.path.join(build, "CMakeCache.txt")) as cache:
        for line in cache:
            if line.startswith("TETRAVOX_SHARED_DIR:"):
                return line.split("=", 1)[1].strip()
    return "shared"


def main():
    options = parse_arguments()
    work = os.path.join(options.out, "work")
    shutil.rmtree(work, ignore_errors=True)
    os.makedirs(work)
    tool = Tool(options.build, work)
    with peers.Display() as display:
        results = {
            "machine": report.machine(),
            "rendering": workloads.measure_rendering(tool, display, options),
            "exactness": workloads.measure_exactness(tool, display, options),
            "scaling": workloads.measure_scaling(tool, options),
            "grids": grid_workloads.measure_rendering(tool, display, options),
            "grid_scaling": grid_workloads.measure_scaling(tool, options),
            "effects": effect_workloads.measure_effects(tool, display, options),
            "startup": workloads.measure_startup(tool, options),
        }
    with open(os.path.join(options.out, "results.json"), "w") as file:
        json.dump(results, file, indent=1)
    tables = report.tables(results)
    with open(os.path.join(options.out, "tables.md"), "w") as file:
        file.write(tables)
    if options.readme:
        report.replace_block(options.readme, tables)
    orders = order_workloads.measure_orders(options)
    with open(os.path.join(options.out, "orders.md"), "w") as file:
        file.write(orders)
    print(tables)
    print(orders)
    print(f"written: {options.out}/tables.md, orders.md and results.json")


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
"""Measures the errors of the pictures in a page, and writes them into the page's tables.

    tools/measure_pictures.py TOOL PAGE

In tables whose first column is titled "picture", rows that begin with `PICTURE` or `PICTURE OPTIONS` are measured,
where PICTURE.png lies in the folder images beside the page: the scene that it holds is drawn once more with the
options, and once exactly, with the filter linear. Pictures of waves are held against the signal itself instead of its
samples.
"""
import array
import json
import math
import os
import re
import subprocess
import sys
import tempfile

EXACT = {"integrator": "partial", "tolerance": 1e-6, "early_ray_termination": False}
SIGNAL = "builtin:marschner-lobb?size=321"
ROW = re.compile(r"\| `([a-z]+[-a-z0-9.]*)((?: --[^`]*)?)` \|")


def read_colors(path):
    """Red, green, blue of all pixels of an NPY picture (float32, [height][width][4])."""
    with open(path, "rb") as file:
        start = file.read(10)
        file.seek(10 + int.from_bytes(start[8:10], "little"))
        values = array.array("f", file.read())
    return [value for i, value in enumerate(values) if i % 4 != 3]


class Painter:
    """Draws scenes with the tool; keeps exact pictures."""

    def __init__(self, tool, folder):
        self.tool, self.folder, self.exact = tool, folder, {}

    def draw(self, scene, *options):
        """Colours of a scene file or of what a picture shows."""
        path = os.path.join(self.folder, "picture.npy")
        subprocess.run([self.tool, "render", scene, "-o", path, "--quiet", *options], check=True)
        return read_colors(path)

    def draw_exactly(self, picture):
        """Colours of what the picture shows, without its errors."""
        path = os.path.join(self.folder, "scene.json")
        self.draw(picture, "--save-scene", path)
        with open(path) as file:
            scene = json.load(file)
        scene["render"] = EXACT
        if os.path.basename(picture).startswith("waves"):
            scene["data"]["file"] = SIGNAL
        text = json.dumps(scene)
        if text not in self.exact:
            with open(path, "w") as file:
                file.write(text)
            self.exact[text] = self.draw(path)
        return self.exact[text]

    def measure(self, picture, options):
        """The cells of a row by the titles of their columns."""
        errors = [abs(a - b) for a, b in zip(self.draw(picture, *options), self.draw_exactly(picture))]
        return {"largest error": f"{max(errors):.1e}",
                "RMS": f"{math.sqrt(sum(error**2 for error in errors) / len(errors)):.1e}"}


def fill_row(line, titles, cells):
    return "| " + " | ".join(cells.get(title, old) for title, old in zip(titles, split_row(line))) + " |"


def split_row(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def fill_tables(lines, painter, images):
    titles = [""]
    for i, line in enumerate(lines):
        if line.startswith("|---"):
            titles = split_row(lines[i - 1])
        row = ROW.match(line)
        if row and titles[0] == "picture":
            name, options = row.groups()
            lines[i] = fill_row(line, titles, painter.measure(os.path.join(images, name + ".png"), options.split()))


def main():
    tool, page = sys.argv[1:]
    with open(page, encoding="utf-8") as file:
        lines = file.read().split("\n")
    with tempfile.TemporaryDirectory() as folder:
        fill_tables(lines, Painter(os.path.abspath(tool), folder), os.path.join(os.path.dirname(page), "images"))
    with open(page, "w", encoding="utf-8") as file:
        file.write("\n".join(lines))


if __name__ == "__main__":
    main()

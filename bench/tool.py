"""Runs the command line tool and reads its statistics."""
import json
import os
import subprocess
import time


class Failed(Exception):
    """What a program said when it did not do what it was asked."""


class Tool:
    def __init__(self, build, work):
        self.program = os.path.join(build, "bin", "tetravox")
        self.exporter = os.path.join(build, "bin", "export_dataset")
        self.work = work
        if not os.path.exists(self.program):
            raise SystemExit(f"{self.program} is missing: run 'make build'")

    def path(self, name):
        return os.path.join(self.work, name)

    def run(self, command, timeout=600):
        """Seconds from the shell to the end of the program."""
        start = time.perf_counter()
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout)
        seconds = time.perf_counter() - start
        if done.returncode != 0:
            raise Failed((done.stderr or done.stdout).strip().split("\n")[-1])
        return seconds

    def render(self, scene, *options, output="picture.npy"):
        """Draws; returns the statistics."""
        statistics = self.path("statistics.json")
        command = [self.program, "render", scene, "-o", self.path(output), "--statistics", statistics, *options]
        self.run(command)
        with open(statistics) as file:
            return json.load(file)

    def info(self, dataset):
        """What the tool knows of a file."""
        done = subprocess.run([self.program, "info", dataset, "--json"], capture_output=True, text=True, timeout=600)
        if done.returncode != 0:
            raise Failed(done.stderr.strip().split("\n")[-1])
        return json.loads(done.stdout)

    def export(self, dataset, name):
        """Path of an embedded dataset or a file as VTU or VTI, by the ending of `name`."""
        path = self.path(name)
        self.run([self.exporter, dataset, path])
        return path

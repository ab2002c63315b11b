"""The peers: VTK's mappers, each in a process of its own that draws a frame when told to."""
import json
import os
import select
import subprocess
import sys
import time

from tool import Failed

MESH_PEERS = ("bunyk", "pt")
GRID_PEERS = ("fixed", "gpu")
LONGEST_FRAME = 120.0  # seconds


class Display:
    """A virtual X display for the time of a `with` block; `reason` says why there is none."""

    def __init__(self):
        self.process, self.name, self.reason = None, None, None

    def __enter__(self):
        reading, writing = os.pipe()
        try:
            self.process = subprocess.Popen(
                ["Xvfb", "-displayfd", str(writing), "-screen", "0", "2048x2048x24", "-nolisten", "tcp", "-noreset"],
                pass_fds=[writing], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        except FileNotFoundError:
            self.reason = "Xvfb is not installed"
        os.close(writing)
        number = self.read_number(reading)
        os.close(reading)
        if number:
            self.name = f":{number}"
        elif self.reason is None:
            self.reason = "Xvfb did not start"
        return self

    @staticmethod
    def read_number(pipe):
        """The line that Xvfb writes once it listens; it gives up when the pipe closes before the line ends."""
        text = b""
        while not text.endswith(b"\n") and select.select([pipe], [], [], 20)[0]:
            chunk = os.read(pipe, 16)
            if not chunk:
                return ""
            text += chunk
        return text.decode().strip()

    def __exit__(self, *_):
        if self.process:
            self.process.terminate()
            self.process.wait()


class Peer:
    """One mapper with one scene at one size."""

    def __init__(self, display, mapper, scene, size):
        if display.name is None:
            raise Failed(display.reason)
        program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "vtk_peer.py")
        self.process = subprocess.Popen(
            [sys.executable, program, scene, mapper, str(size), str(size)],
            env=dict(os.environ, DISPLAY=display.name, LIBGL_ALWAYS_SOFTWARE="1"),
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.pending = b""
        self.hello = self.receive()

    def ask(self, line):
        self.process.stdin.write((line + "\n").encode())
        self.process.stdin.flush()
        return self.receive()

    def receive(self):
        """The next answer. VTK prints warnings among them: what is no JSON object is passed over."""
        end = time.monotonic() + LONGEST_FRAME
        while True:
            line, found, rest = self.pending.partition(b"\n")
            if found:
                self.pending = rest
                if line.startswith(b"{"):
                    return json.loads(line)
                continue
            if not select.select([self.process.stdout], [], [], max(0.0, end - time.monotonic()))[0]:
                self.close()
                raise Failed(f"no answer in {LONGEST_FRAME:.0f} s")
            chunk = os.read(self.process.stdout.fileno(), 65536)
            if not chunk:
                raise Failed("the peer ended early: see what bench/vtk_peer.py says by itself")
            self.pending += chunk

    def close(self):
        self.process.kill()
        self.process.wait()

#!/usr/bin/env python3
"""Checks who may include whom, and how headers are written. Python 3.9, standard library only.

    tools/check_includes.py [ROOT]

Prints one line for each violation, `file:line: what`, and exits 1 where there is any.
The rules are the tables below; docs/architecture.md says why.
"""
import os
import re
import sys

PUBLIC = "include/tetravox"
BASE = [PUBLIC, "src/support"]
SCENE = BASE + ["src/optics", "src/mesh", "src/grid", "src/scene"]

# Folder -> folders that its files may include besides itself. The longest match counts.
MAY_INCLUDE = {
    PUBLIC: [],
    "src/support": [PUBLIC],
    "src/optics": BASE,
    "src/mesh": BASE,
    "src/grid": BASE,
    "src/scene": SCENE,
    "src/sort": SCENE,
    "src/cpu": SCENE + ["src/cpu/kernels"],
    "src/cpu/kernels": SCENE + ["src/cpu"],
    "src/gl": SCENE,
    "src/io": SCENE,
    "apps": [PUBLIC],
    "examples": [PUBLIC],
    "python": [PUBLIC],
    "plugins": [PUBLIC],
    "tests": [PUBLIC, "src"],
    "bench": [PUBLIC, "src"],
}

# Foreign headers (regular expression of what is included) -> the only folders that may include them.
FOREIGN = [
    (r"vtk\w*\.h", ["src/io", "tests", "bench", "plugins"]),
    (r"hwy/", ["src/cpu/kernels", "tests"]),
    (r"\w*intrin\.h|arm_(neon|sve)\.h", ["src/cpu/kernels"]),
    (r"(epoxy|GL|GLES\d?|EGL|GLFW)/", ["src/gl", "tests", "bench"]),
    (r"(tbb|oneapi)/", ["src", "tests", "bench"]),
    (r"nlohmann/", ["src", "apps", "tests", "bench"]),
    (r"CLI/", ["apps"]),
    (r"(pugixml|Imf|Iex|Imath|png|zlib|OpenEXR/|Imath/)\w*(\.hpp|\.h)?", ["src/io", "tests", "bench"]),
    (r"gtest/|gmock/", ["tests"]),
    (r"benchmark/", ["bench"]),
]

# Text that only the vector kernels may hold.
VECTOR_CODE = re.compile(r"\b_mm(256|512)?_[a-z]|\b__m(128|256|512)[id]?\b|__AVX|__builtin_ia32_")
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
LARGEST_HEADER, LARGEST_SOURCE = 400, 600
ROOTS = ["include", "src", "apps", "examples", "python", "plugins", "tests", "bench"]


def is_below(path, folder):
    return path == folder or path.startswith(folder + "/")


def rule_of(path):
    """The folder of MAY_INCLUDE that `path` belongs to, or None."""
    matches = [folder for folder in MAY_INCLUDE if is_below(path, folder)]
    return max(matches, key=len, default=None)


def location_of(included):
    """Path in the project of an included name, or None for a foreign header."""
    if included.startswith("tetravox/"):
        return "include/" + included
    top = included.split("/", 1)[0]
    return included if top in ROOTS and "/" in included else None


def may_include(path, target):
    """Whether the file at `path` may include the project's file `target`."""
    folder = rule_of(path)
    target_folder = rule_of(target) or os.path.dirname(target)
    if folder == target_folder:
        # Programs are islands: an app sees its own folder, not another app's.
        depth = {"apps": 2, "examples": 2}.get(folder, 0)
        return path.split("/")[:depth] == target.split("/")[:depth]
    return any(is_below(target_folder, allowed) for allowed in MAY_INCLUDE[folder])


def check_include(path, number, quote, included):
    target = location_of(included)
    if target is not None:
        if quote != '"':
            yield number, f"include the project's <{included}> with quotes"
        if not may_include(path, target):
            yield number, f"{rule_of(path)} must not include {included}"
        return
    if quote == '"':
        yield number, f'"{included}" is no full path: "tetravox/...", "src/folder/..." or "apps/tool/..."'
    for pattern, folders in FOREIGN:
        if re.match(pattern, included) and not any(is_below(path, folder) for folder in folders):
            yield number, f"<{included}> may be included only in {', '.join(folders)}"


def own_header(path, root):
    """What the source file at `path` must include first, or None where it has no header of its own."""
    stem = os.path.splitext(path)[0]
    if os.path.exists(os.path.join(root, stem + ".h")):
        return stem + ".h"
    public = f"tetravox/{os.path.basename(stem)}.h"
    if path.startswith("src/") and os.path.exists(os.path.join(root, "include", public)):
        return public
    return None


def check_header(path, lines):
    # Highway includes its -inl.h files once for each instruction set; a toggled guard takes the place of the pragma.
    guard = "HWY_TARGET_TOGGLE" if path.endswith("-inl.h") else "#pragma once"
    if not any(guard in line for line in lines):
        yield 1, f"{guard} is missing"
    for number, line in enumerate(lines, 1):
        if re.match(r"\s*using\s+namespace\b", line):
            yield number, "no 'using namespace' in a header"


def check_source(path, includes, root):
    own = own_header(path, root)
    if own is None or not includes:
        return
    # A private header of the same name speaks for a file that implements only a part of a public one.
    if includes[0][2] != own and own in [included for _, _, included in includes]:
        yield includes[0][0], f'include the file\'s own header "{own}" first'


def check_file(path, root):
    """Violations in one file as (line, text)."""
    with open(os.path.join(root, path), encoding="utf-8", errors="replace") as file:
        lines = file.read().splitlines()
    found = ((number, INCLUDE.match(line)) for number, line in enumerate(lines, 1))
    includes = [(number, match.group(1), match.group(2)) for number, match in found if match]
    for number, quote, included in includes:
        yield from check_include(path, number, quote, included)
    if not is_below(path, "src/cpu/kernels"):
        for number, line in enumerate(lines, 1):
            if VECTOR_CODE.search(line):
                yield number, "vector code belongs in src/cpu/kernels"
    is_header = path.endswith(".h")
    yield from check_header(path, lines) if is_header else check_source(path, includes, root)
    limit = LARGEST_HEADER if is_header else LARGEST_SOURCE
    if len(lines) >= limit:
        yield limit, f"{len(lines)} lines: a {'header' if is_header else 'source file'} stays under {limit}"


def source_files(root):
    for top in ROOTS:
        for folder, _, names in os.walk(os.path.join(root, top)):
            for name in sorted(names):
                if name.endswith((".h", ".cpp")):
                    yield os.path.relpath(os.path.join(folder, name), root).replace(os.sep, "/")


def check_tree(root):
    """All violations below `root` as lines of text."""
    for path in source_files(root):
        if rule_of(path) is None:
            yield f"{path}:1: its folder has no rule: add it to MAY_INCLUDE in tools/check_includes.py"
            continue
        for number, text in check_file(path, root):
            yield f"{path}:{number}: {text}"


def main():
    default = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    violations = list(check_tree(sys.argv[1] if len(sys.argv) > 1 else default))
    print("\n".join(violations), end="\n" if violations else "")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main())

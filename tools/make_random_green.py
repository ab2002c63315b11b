#!/usr/bin/env python3
"""Prints a transfer function whose green is random from entry to entry; the other channels are linear.

    tools/make_random_green.py >docs/methods/random-green.json
"""
import random

STEP = 5  # from entry to entry, of values in [0, 255]
FIRST_VISIBLE, FULL = 8, 60  # opacity rises between these values
OPACITY, UNIT_DISTANCE = 0.5, 8 / 3  # for the length of a voxel of the 16^3 orbital


def point(value, green):
    t = value / 255
    opacity = OPACITY * min(max((value - FIRST_VISIBLE) / (FULL - FIRST_VISIBLE), 0), 1)
    color = f"[{0.3 + 0.7 * t:.3f}, {green:.3f}, {0.8 - 0.7 * t:.3f}]"
    return f'    {{"value": {value}, "color": {color}, "opacity": {opacity:.4f}}}'


def main():
    numbers = random.Random(1)
    points = ",\n".join(point(value, numbers.random()) for value in range(0, 256, STEP))
    print(f'{{\n  "unit_distance": {UNIT_DISTANCE:.6f},\n  "points": [\n{points}\n  ]\n}}')


if __name__ == "__main__":
    main()

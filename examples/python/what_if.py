"""A recorded session, felt again with other stiffnesses: what would have changed, and would it have been felt?

    python3 what_if.py what_if.png [recording.mcap]
"""
import os
import sys

import matplotlib.pyplot as plt
import numpy as np

import lumbrical as lum

here = os.path.dirname(os.path.abspath(__file__))
path = sys.argv[2] if len(sys.argv) > 2 else os.path.join(here, "../../recordings/sample.mcap")

with lum.Recording(path) as recording:
    ticks = recording.read()
    felt_again = lum.Session(recording.model()).run(ticks["frame"], recording.read_given())
recorded = ticks["output"]["segment"]["force"]
kept = ~np.isnan(recorded).any(axis=(1, 2))  # a recording may leave forces out
assert (felt_again["segment"]["force"][kept] == recorded[kept]).all(), "the same inputs give the same bits"

fingers = ["thumb", "index", "middle", "ring", "little", "palm"]
figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.5))
for stiffness in (5e6, 1e7, 4e7):
    answer = lum.what_if(path, stiffness=stiffness)
    left.plot(fingers, answer["force"]["max"], "o-", label=f"{stiffness:g} N/m³")
    right.plot(fingers, answer["force_jnd"]["max"], "o-")
left.set_ylabel("largest change of force [N]")
left.legend()
right.set_ylabel("the same in just-noticeable differences")
right.axhline(1, color="grey", linestyle="--")
figure.tight_layout()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "what_if.png", dpi=120)

"""A fingertip slides over the edge of a box: what each law makes of it.

    python3 force_over_an_edge.py force_over_an_edge.png
"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import lumbrical as lum

RADIUS, DEPTH = 0.008, 0.002  # [m]
x = np.linspace(-0.02, 0.02, 401)

vertices, triangles = lum.make_box((0.06, 0.06, 0.02), 12)
vertices = vertices + (-0.03, 0, -0.01)  # its edge is at x = 0, its top at z = 0
spheres = np.stack([x, np.zeros_like(x), np.full_like(x, RADIUS - DEPTH), np.full_like(x, RADIUS)], axis=1)

figure, axes = plt.subplots(2, 1, sharex=True, figsize=(7, 6))
for law in ("field", "column", "max-depth", "centroid"):
    contacts = lum.probe(vertices, triangles, spheres=spheres, law=law)
    force = np.zeros((len(x), 3))
    np.add.at(force, contacts["primitive"], contacts["force"])
    axes[0].plot(1e3 * x, force[:, 2], label=law)
    axes[1].plot(1e3 * x, force[:, 0], label=law)
axes[0].set_ylabel("upward force [N]")
axes[1].set_ylabel("force along x [N]")
axes[1].set_xlabel("fingertip's centre, 0 at the edge [mm]")
axes[0].legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "force_over_an_edge.png", dpi=120)

"""How much time does precision cost? Each precision's error against exact forces over its rate on this machine.

    python3 pareto_front.py pareto_front.png
"""
import sys
import time

import matplotlib.pyplot as plt
import numpy as np

import lumbrical as lum

scene = lum.Scene("right")
scene.fade_time = 0
scene.max_force = 1000
scene.felt_once = "always"  # exactly too: else what several parts of the hand hold together would count for errors
scene.add_object("ball", *lum.make_sphere(0.04, 24))
share = np.linspace(0.4, 0.7, 60)
frames = lum.angle_frames(np.outer(0.2 * share, np.arange(20) % 4 != 0),
                          np.stack([0 * share, 0 * share - 0.12, 0.07 - 0.03 * share], axis=1),
                          (np.sqrt(0.5), np.sqrt(0.5), 0, 0))


def measured(precision):
    """Forces (n, 3), and ticks per second."""
    scene.precision[:] = precision
    session = lum.Session(lum.Model(scene))
    session.run(frames)  # caches
    start = time.perf_counter()
    outputs = session.run(frames)
    return lum.hand_force(outputs), len(frames) / (time.perf_counter() - start)


exact, exact_rate = measured(0)
largest = np.linalg.norm(exact, axis=1).max()
figure, axes = plt.subplots(figsize=(7, 5))
for precision in (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6):
    forces, rate = measured(precision)
    error = np.linalg.norm(forces - exact, axis=1).max() / largest
    axes.loglog(1e-3 * rate, error, "o")
    axes.annotate(f"{precision:g}", (1e-3 * rate, error), textcoords="offset points", xytext=(6, 4))
    print(f"precision {precision:7g}: {1e-3 * rate:8.2f} kHz, largest error {error:.1e} of the largest force")
axes.axvline(1e-3 * exact_rate, linestyle="--", label="exact")
axes.set_xlabel("ticks per second, one core [kHz]")
axes.set_ylabel("largest error, share of the largest force")
axes.legend()
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "pareto_front.png", dpi=120)

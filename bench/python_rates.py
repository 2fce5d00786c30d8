"""Ticks per second and core from Python: one tick a call, a motion a call, ten thousand hands a call.

    PYTHONPATH=build/release/bindings/python python3 bench/python_rates.py [examples/demo.json]
"""
import sys
import time

import numpy as np

import lumbrical as lum

HANDS = 10_000
scene = lum.Scene.load(sys.argv[1] if len(sys.argv) > 1 else "examples/demo.json")
model = lum.Model(scene)
frames = scene.frames()
frames = frames[np.linspace(0, len(frames) - 1, HANDS).astype(int)]


def rate(run, seconds=time.process_time):
    """The best of five, [kHz]."""
    best = 0.0
    for _ in range(5):
        start = seconds()
        run()
        best = max(best, 1e-3 * HANDS / (seconds() - start))
    return best


def one_by_one():
    session = lum.Session(model)
    for i in range(HANDS):
        session.tick(frames[i:i + 1])


print(f"a tick a call          {rate(one_by_one):8.1f} kHz per core")
print(f"a motion a call        {rate(lambda: lum.Session(model).run(frames)):8.1f} kHz per core")
for threads in sorted({1, lum.core_count()}):
    batch = lum.Batch(model, HANDS)
    print(f"{HANDS} hands a call, {threads} threads{rate(lambda: batch.tick(frames, threads)):6.1f} kHz per core, "
          f"{rate(lambda: batch.tick(frames, threads), time.perf_counter):.1f} kHz in all")

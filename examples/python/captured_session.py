"""A captured hand meets a scene: run it, record it, read the recording, plot what each finger felt.

    python3 captured_session.py captured_session.png [scene.json]
"""
import os
import sys
import tempfile

import matplotlib.pyplot as plt
import numpy as np

import lumbrical as lum

here = os.path.dirname(os.path.abspath(__file__))
scene = lum.Scene.load(sys.argv[2] if len(sys.argv) > 2 else os.path.join(here, "../cup.json"))
session = lum.Session(lum.Model(scene))
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "session.mcap")
    session.record(path)
    session.run(scene.frames())
    session.stop_recording()
    assert lum.replay(path)["identical"]
    with lum.Recording(path) as recording:
        ticks, rate = recording.read(), scene.rate

seconds = ticks["output"]["tick"] / rate
forces = ticks["output"]["segment"]["force"]  # (n, 16, 3), a view
figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(9, 6))
for finger, name in enumerate(["thumb", "index", "middle", "ring", "little"]):
    upper.plot(seconds, np.linalg.norm(forces[:, 3 * finger:3 * finger + 3].sum(axis=1), axis=1), label=name)
upper.plot(seconds, np.linalg.norm(forces[:, 15], axis=1), label="palm")
upper.set_ylabel("force [N]")
upper.legend(ncol=3)
lower.plot(seconds, ticks["output"]["contact_count"], color="grey")
lower.set_ylabel("contacts")
lower.set_xlabel("time [s]")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "captured_session.png", dpi=120)

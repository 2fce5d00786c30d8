"""Meshes as modellers and scanners leave them, and the files they come in."""
import base64
import json
import math
import struct

from at_random import between


def rough_ball(r):
    """Closed, with bumps, and with needles at its poles."""
    rings, sectors = r.randint(3, 24), r.randint(3, 32)
    roughness, stretch = r.choice([0, 0.02, 0.2]), between(r, 0.2, 2)
    vertices = [(0, 0, stretch), (0, 0, -stretch)]
    for i in range(1, rings):
        for k in range(sectors):
            a, b, radius = math.pi * i / rings, 2 * math.pi * k / sectors, 1 + roughness * r.uniform(-1, 1)
            vertices.append((radius * math.sin(a) * math.cos(b), radius * math.sin(a) * math.sin(b),
                             stretch * radius * math.cos(a)))
    at = lambda i, k: 2 + (i - 1) * sectors + k % sectors
    triangles = []
    for k in range(sectors):
        triangles += [(0, at(1, k), at(1, k + 1)), (1, at(rings - 1, k + 1), at(rings - 1, k))]
        for i in range(1, rings - 1):
            triangles += [(at(i, k), at(i + 1, k), at(i + 1, k + 1)), (at(i, k), at(i + 1, k + 1), at(i, k + 1))]
    return vertices, triangles


def scanned_sheet(r):
    """Open, as a scanner leaves it: noise, holes, triangles that stand there twice, turned over or without an area."""
    cells, noise = r.randint(2, 40), r.choice([0, 0.002, 0.02])
    vertices = [(x / cells - 0.5, y / cells - 0.5, noise * r.gauss(0, 1) + 0.1 * math.sin(6 * x / cells))
                for x in range(cells + 1) for y in range(cells + 1)]
    triangles = []
    for x in range(cells):
        for y in range(cells):
            a, b = x * (cells + 1) + y, (x + 1) * (cells + 1) + y
            triangles += [(a, b, b + 1), (a, b + 1, a + 1)]
    left = [t for t in triangles if r.random() > 0.05] or triangles
    left = [(a, c, b) if r.random() < 0.02 else (a, b, c) for a, b, c in left]
    return vertices, left + r.sample(left, min(3, len(left))) + [(0, 1, 1)] * r.choice([0, 1])


def obj_file(vertices, triangles):
    lines = ["v %.9g %.9g %.9g" % v for v in vertices] + ["f %d %d %d" % tuple(i + 1 for i in t) for t in triangles]
    return "\n".join(lines + [""]).encode()


def off_file(vertices, triangles):
    lines = [f"OFF\n{len(vertices)} {len(triangles)} 0"] + ["%.9g %.9g %.9g" % v for v in vertices]
    return "\n".join(lines + ["3 %d %d %d" % t for t in triangles] + [""]).encode()


def ply_file(vertices, triangles):
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    head += [f"property float {axis}" for axis in "xyz"]
    head += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    return "\n".join(head).encode() + b"".join(struct.pack("<3f", *v) for v in vertices) + b"".join(
        struct.pack("<B3i", 3, *t) for t in triangles)


def stl_file(vertices, triangles):
    corners = [struct.pack("<12fH", 0, 0, 0, *(x for i in t for x in vertices[i]), 0) for t in triangles]
    return bytes(80) + struct.pack("<I", len(triangles)) + b"".join(corners)


def gltf_file(vertices, triangles):
    places = b"".join(struct.pack("<3f", *v) for v in vertices)
    corners = b"".join(struct.pack("<3I", *t) for t in triangles)
    stored = list(struct.iter_unpack("<3f", places))
    lower, upper = ([end(axis) for axis in zip(*stored)] for end in (min, max))
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0, "scale": [1, 1, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(vertices), "type": "VEC3", "min": lower,
             "max": upper},
            {"bufferView": 1, "componentType": 5125, "count": 3 * len(triangles), "type": "SCALAR"}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(places)},
                        {"buffer": 0, "byteOffset": len(places), "byteLength": len(corners)}],
        "buffers": [{"byteLength": len(places + corners),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(places + corners).decode()}],
    }).encode()


MESH_FILES = {"obj": obj_file, "off": off_file, "ply": ply_file, "stl": stl_file, "gltf": gltf_file}

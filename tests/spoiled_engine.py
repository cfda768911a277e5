"""An engine that was made wrong on purpose: another one's answers, spoiled in one way.

usage: spoiled_engine.py WAY COMMAND...      WAY: whole, flipped, lost, seams, shifted, inflated, lazy or dying

Lazy answers another number of triangles, in no time, where no mesh is asked for. Dying ends once, in the middle of its second answer.
"""

import json
import os
import struct
import subprocess
import sys


def read(path):
    data = open(path, "rb").read()
    end = data.index(b"end_header\n") + 11
    header = data[:end].decode()
    vertices = int(header.split("element vertex ")[1].split()[0])
    faces = int(header.split("element face ")[1].split()[0])
    columns = header.split("element vertex")[1].split("element face")[0].count("property float")
    size = 4 * columns
    points = [struct.unpack_from("<3f", data, end + v * size) for v in range(vertices)]
    begin = end + vertices * size
    return points, [struct.unpack_from("<3I", data, begin + 13 * t + 1) for t in range(faces)]


def write(path, points, triangles):
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n"
    )
    with open(path, "wb") as file:
        file.write(header.encode())
        file.write(b"".join(struct.pack("<3f", *point) for point in points))
        file.write(b"".join(struct.pack("<B3I", 3, *triangle) for triangle in triangles))


def spoiled(way, request, points, triangles):
    if way == "flipped":
        # As if one case of a table had one triangle the other way round.
        a, b, c = triangles[len(triangles) // 2]
        triangles[len(triangles) // 2] = (b, a, c)
    elif way == "lost":
        del triangles[len(triangles) // 2]
    elif way == "seams":
        # As if two halves had been made by two threads, and not joined.
        middle = request["origin"][0] + request["spacing"][0] * (request["size"][0] // 2)
        own = {}
        for t, triangle in enumerate(triangles):
            if sum(points[v][0] for v in triangle) > 3 * middle:
                triangles[t] = tuple(own.setdefault(v, len(points) + len(own)) for v in triangle)
        points = points + [points[v] for v in own]
    elif way == "shifted":
        half = [0.5 * step for step in request["spacing"]]
        points = [tuple(x + h for x, h in zip(point, half)) for point in points]
    elif way == "inflated":
        # Along the normals, so that the mesh is as smooth as before.
        normals = [[0.0] * 3 for _ in points]
        for triangle in triangles:
            a, b, c = (points[v] for v in triangle)
            u, w = [y - x for x, y in zip(a, b)], [y - x for x, y in zip(a, c)]
            normal = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]]
            for v in triangle:
                normals[v] = [x + y for x, y in zip(normals[v], normal)]
        far = 0.6 * max(request["spacing"])
        points = [
            tuple(x + far * n / (sum(m * m for m in normal) ** 0.5 or 1.0) for x, n in zip(point, normal)) for point, normal in zip(points, normals)
        ]
    return points, triangles


def main():
    way, command = sys.argv[1], sys.argv[2:]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as engine:
        print(engine.stdout.readline(), end="", flush=True)
        for line in sys.stdin:
            engine.stdin.write(line)
            engine.stdin.flush()
            answer, request = json.loads(engine.stdout.readline()), json.loads(line)
            died = os.path.join(os.path.dirname(sys.argv[0]), "died")
            if way == "dying" and request["id"] == 2 and not os.path.exists(died):
                open(died, "w").close()
                sys.exit(3)
            if way == "lazy" and not request["mesh"]:
                answer |= {"extraction_s": 1e-9, "triangles": 1}
            if request["mesh"] and "failed" not in answer:
                points, triangles = spoiled(way, request, *read(request["mesh"]))
                write(request["mesh"], points, triangles)
                answer |= {"vertices": len(points), "triangles": len(triangles)}
            print(json.dumps(answer), flush=True)
        engine.stdin.close()


main()

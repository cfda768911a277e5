"""The smallest program: a square between each sample inside and each neighbour outside. Needs Python alone."""
import array, json, sys, time

def extract(values, size, origin, spacing, isovalue):
    steps, corners, triangles = (1, size[0], size[0] * size[1]), {}, []
    for n, value in enumerate(values):
        cell = [n // steps[a] % size[a] for a in range(3)]
        for a in range(3):
            if cell[a] + 1 < size[a] and (value > isovalue) != (values[n + steps[a]] > isovalue):
                square = [corners.setdefault(tuple(cell[i] + (1, u, v)[i - a] for i in range(3)), len(corners))
                          for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))]
                p, q, r, s = square if value > isovalue else square[::-1]
                triangles += [(p, q, r), (p, r, s)]
    return [[origin[a] + spacing[a] * (corner[a] - 0.5) for a in range(3)] for corner in corners], triangles

print(json.dumps({"ready": {"name": "squares", "version": "1"}}), flush=True)
for line in sys.stdin:
    request = json.loads(line)
    values = array.array("f", open(request["samples"], "rb").read())
    begin = time.perf_counter()
    positions, triangles = extract(values, *(request[key] for key in ("size", "origin", "spacing", "isovalue")))
    counts = {"extraction_s": time.perf_counter() - begin, "vertices": len(positions), "triangles": len(triangles)}
    if request["mesh"]:
        with open(request["mesh"], "w") as file:
            file.write(f"ply\nformat ascii 1.0\nelement vertex {len(positions)}\nproperty float x\nproperty float y\n"
                       f"property float z\nelement face {len(triangles)}\nproperty list uchar uint vertex_indices\nend_header\n")
            file.writelines("%.9g %.9g %.9g\n" % tuple(p) for p in positions)
            file.writelines("3 %d %d %d\n" % t for t in triangles)
    print(json.dumps({"id": request["id"], **counts}), flush=True)

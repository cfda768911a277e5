"""Runs the code of notebook.ipynb from top to bottom, in the folder that is named. Usage: run_notebook.py FOLDER"""

import json
import os
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
notebook = json.loads((Path(__file__).parent.parent / "notebook.ipynb").read_text(encoding="utf-8"))
os.chdir(sys.argv[1])
names = {}
for cell in notebook["cells"]:
    if cell["cell_type"] == "code":
        exec(compile("".join(cell["source"]), cell["id"], "exec"), names)
assert len(names["meshes"]) == 6 and Path("six-methods.png").stat().st_size > 10_000
print("the notebook ran")

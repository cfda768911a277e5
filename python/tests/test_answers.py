"""Tests of `analyse`: answers whose results are known by hand, in frames of three libraries. `make wheel` runs them."""

import csv
import math
import os
import subprocess
import tempfile
import threading
import unittest
from pathlib import Path

import pandas
import polars
import pyarrow

import isostudy


def answers(counts):
    """A row for each answer: `counts` has, for each pair, how often the first, neither and the second was chosen."""
    rows = []
    for question, ((first, second), times) in enumerate(counts.items()):
        for choice, number in zip(("left", "none", "right"), times):
            for _ in range(number):
                rows.append((f"p{len(rows)}", f"Q{question}", first, second, choice))
    return dict(zip(("participant", "question", "left", "right", "choice"), map(list, zip(*rows))))


# People who answered once each. By Bradley and Terry the log worth of a over b is ln(30 / 10).
TWO = answers({("a", "b"): (30, 0, 10)})
THREE = answers({("a", "b"): (24, 6, 10), ("b", "c"): (20, 5, 15), ("a", "c"): (28, 2, 10)})
LIBRARIES = {"pandas": pandas.DataFrame, "polars": polars.DataFrame, "pyarrow": pyarrow.table}


def columns(table):
    """Of any library's frame, a list for each column, with None where a value is missing."""
    return pyarrow.table(table).to_pydict()


class Answers(unittest.TestCase):
    def test_worths_and_counts_known_by_hand(self):
        found = isostudy.analyse(pyarrow.table(TWO), reference="b")
        worths = columns(found["worths"])
        of = {item: worths["log_worth"][i] for i, item in enumerate(worths["item"])}
        self.assertAlmostEqual(of["a"], math.log(3), places=9)
        self.assertEqual(of["b"], 0)
        counts = columns(found["answer_counts"])
        self.assertEqual([counts[of][0] for of in ("left_answers", "no_preference", "right_answers")], [30, 0, 10])
        # The exact sign test: 30 or more of 40, from both sides.
        p = 2 * sum(math.comb(40, k) for k in range(30, 41)) / 2**40
        tests = columns(found["tests"])
        self.assertAlmostEqual(tests["p_binomial"][0], p, places=9)
        self.assertEqual((tests["contrast"][0], tests["first"][0], tests["second"][0]), ("b-a", 10, 30))
        self.assertIn("answer_counts", repr(found))

    def test_each_library_gets_frames_of_its_own_with_the_same_numbers(self):
        found = {name: isostudy.analyse(frame(THREE)) for name, frame in LIBRARIES.items()}
        kinds = {"pandas": pandas.DataFrame, "polars": polars.DataFrame, "pyarrow": pyarrow.Table}
        for name, kind in kinds.items():
            self.assertIsInstance(found[name]["worths"], kind)
            self.assertEqual(found[name].found, found["pyarrow"].found)
        for table in found["pyarrow"]:
            expected = columns(found["pyarrow"][table])
            self.assertEqual(columns(found["polars"][table]), expected)
            # pandas writes what is missing in its own ways.
            other = columns(found["pandas"][table].astype(object).where(lambda of: of.notna(), None))
            self.assertEqual(other, expected)

    def test_what_is_missing_or_of_another_type_is_read(self):
        frame = pandas.DataFrame(THREE | {"note": 7, "rt_ms": [1000.0] * len(THREE["left"])})
        frame.loc[3, "rt_ms"] = math.nan
        plain = columns(isostudy.analyse(pyarrow.table(THREE))["worths"])
        for of in ("left", "right", "choice", "participant"):
            frame[of] = frame[of].astype("category")
        self.assertEqual(columns(isostudy.analyse(frame, many=False)["worths"]), plain)
        self.assertNotIn("note", isostudy.analyse(frame).read)
        # Rows that stand for several people, without their names.
        counted = {"question": ["1"] * 2, "left": ["a"] * 2, "right": ["b"] * 2, "choice": ["left", "right"], "count": [30, 10]}
        for frame in (pyarrow.table(counted), pandas.DataFrame(counted).astype({"count": float})):
            worths = columns(isostudy.analyse(frame, reference="b")["worths"])
            self.assertAlmostEqual(max(worths["log_worth"]), math.log(3), places=9)

    def test_many_answers_are_counted(self):
        found = isostudy.analyse(polars.DataFrame(THREE), many=True)
        self.assertEqual(list(found), ["factors", "worths", "models"])
        factors = {row["item"]: row for row in found["factors"].to_dicts()}
        self.assertEqual((factors["a"]["wins"], factors["a"]["losses"]), (24 + 28, 10 + 10))
        self.assertEqual(factors["a"]["factor"], (24 + 28) / 120)

    def test_faults_have_their_names(self):
        with self.assertRaisesRegex(TypeError, "list is no data frame"):
            isostudy.analyse([1, 2])
        with self.assertRaisesRegex(ValueError, "nobody.*there are a, b"):
            isostudy.analyse(pyarrow.table(TWO), reference="nobody")
        with self.assertRaisesRegex(ValueError, "the frame"):
            isostudy.analyse(pyarrow.table(TWO).drop_columns(["choice"]))
        with self.assertRaisesRegex(ValueError, "perhaps"):
            isostudy.analyse(pyarrow.table(TWO | {"choice": ["perhaps"] * len(TWO["choice"])}))
        with self.assertRaises(ValueError):
            isostudy.analyse(pyarrow.table({of: [] for of in TWO}))

    def test_other_threads_run_meanwhile(self):
        frame = pyarrow.table({of: values * 40 for of, values in THREE.items()})
        running = threading.Event()
        ticks = []

        def tick():
            while not running.is_set():
                ticks.append(1)
                running.wait(0.001)

        thread = threading.Thread(target=tick)
        thread.start()
        before = len(ticks)
        isostudy.analyse(frame.set_column(0, "participant", pyarrow.array([f"p{i}" for i in range(frame.num_rows)])))
        during = len(ticks) - before
        running.set()
        thread.join()
        self.assertGreater(during, 5)

    @unittest.skipUnless(os.environ.get("ISOSTUDY"), "ISOSTUDY names no program")
    def test_the_numbers_are_those_of_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "answers.csv"
            polars.DataFrame(THREE).write_csv(file)
            run = [os.environ["ISOSTUDY"], "analyse", str(file), "--out", str(Path(folder) / "out")]
            subprocess.run(run, check=True, capture_output=True)
            found = isostudy.analyse(polars.DataFrame(THREE))
            for table in found:
                with open(Path(folder) / f"out/tables/{table}.csv", newline="") as text:
                    expected = list(csv.DictReader(text))
                own = found[table].to_dicts()
                self.assertEqual(len(own), len(expected), table)
                for row, of in zip(own, expected):
                    for name, value in row.items():
                        same = of[name] == "" if value is None else str(value) == of[name] or float(of[name]) == value
                        self.assertTrue(same, (table, name, value, of[name]))


if __name__ == "__main__":
    unittest.main()

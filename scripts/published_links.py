#!/usr/bin/env python3
"""Prints the files that a folder's report.md links and the folder lacks, one a line.

Links to other sites and within the page are no files. --test holds the search against a small folder.
"""
import pathlib
import re
import sys
import tempfile

LINK = re.compile(r"\]\(<?([^)<>\s]+)>?(?:\s+\"[^\"]*\")?\)|(?:src|href)=\"([^\"]+)\"")


def missing(folder):
    """The linked files that are not there, in order and once each."""
    folder = pathlib.Path(folder)
    links = [a or b for a, b in LINK.findall((folder / "report.md").read_text())]
    files = [link.split("#")[0] for link in links if not re.match(r"[a-z]+:", link)]
    return [file for file in dict.fromkeys(files) if file and not (folder / file).is_file()]


def test():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        text = '![a](figures/a.svg "A") [b](b.csv) [c](#c) [d](https://d.org/e) <img src="f.gif"> ![g](figures/a.svg)'
        (folder / "report.md").write_text(text)
        (folder / "b.csv").write_text("")
        assert missing(folder) == ["figures/a.svg", "f.gif"], missing(folder)


if sys.argv[1:] == ["--test"]:
    test()
else:
    for file in missing(sys.argv[1]):
        print(file)

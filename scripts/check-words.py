#!/usr/bin/env python3
"""Checks the English of README.md and docs/*.md: words of scripts/words.txt, sentences, lines.

Usage: scripts/check-words.py [--list] [PAGE]

A sentence has at most 25 words and is not a noun made of "what" or "who"; there is no ellipsis; a
line has at most 100 characters, without the addresses of links. Code and tables are free of the
limits on lines and sentences. Each fault is printed with file and line; exit 1 if there is one, 2
for a wrong argument. --list prints those of NOT_YET pages too.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LONGEST_LINE = 100
LONGEST_SENTENCE = 25

# Written by the program itself: `isostudy analyse --self-test`.
GENERATED = {"docs/self-test.md"}

# Pages that still have sentences and lines that are too long, and how many. A page may leave this list
# and a number may fall; neither may grow.
NOT_YET = {}


class Paragraph:
    """Text of one paragraph, list item or cell, and the number of its first line."""

    def __init__(self, line, kind):
        self.line, self.kind, self.parts = line, kind, []

    def text(self):
        return " ".join(self.parts)


def paragraphs(lines):
    """Paragraphs, list items, table rows and headings outside of blocks of code."""
    found, current, fence = [], None, False
    for number, line in enumerate(lines, 1):
        stripped = line.strip()
        if stripped.startswith("```"):
            fence, current = not fence, None
        elif fence:
            continue
        elif not stripped:
            current = None
        elif stripped.startswith(("|", "#")):
            found.append(Paragraph(number, "table" if stripped[0] == "|" else "heading"))
            found[-1].parts.append(stripped)
            current = None
        else:
            item = re.match(r"([-*]|\d+\.) +(.*)", stripped)
            if item or current is None:
                current = Paragraph(number, "text")
                found.append(current)
            current.parts.append(item.group(2) if item else stripped)
    return found


def plain(text):
    """Text without markup: code becomes one word, links and pictures their text."""
    text = re.sub(r"`[^`]*`", "CODE", text)
    text = re.sub(r"\[docs/[^\]]*\]\([^)]*\)", "PAGE", text)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"\*\*|(?<!\w)[*_](?=\S)|(?<=\S)[*_](?!\w)", "", text)


def sentences(text):
    """Sentences end at a full stop, question or exclamation mark before a space or the end."""
    for sentence in re.split(r"(?<=[.?!])[\"')]?\s+(?=[\"'(A-Z0-9]|isostudy )", text):
        # A citation is not a part of the sentence.
        yield re.sub(r"\s*\([^()]*\b(1[89]|20)\d\d\b[^()]*\)", "", sentence).strip()


def words(sentence):
    return [word for word in sentence.split() if re.search(r"\w", word)]


def banned():
    for line in (ROOT / "scripts/words.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            pattern, instead = line.split("\t")
            yield re.compile(rf"(?<![\w-])({pattern})(?![\w-])", re.IGNORECASE), instead


def long_lines(lines):
    fence = False
    for number, line in enumerate(lines, 1):
        stripped = line.strip()
        if stripped.startswith("```"):
            fence = not fence
        elif not fence and not stripped.startswith("|"):
            length = len(re.sub(r"\]\([^)]*\)", "]", line))
            if length > LONGEST_LINE:
                yield number, f"{length} characters in a line; at most {LONGEST_LINE}"


def faults_of_words(found, list_of_words):
    for paragraph in found:
        text = plain(paragraph.text())
        for pattern, instead in list_of_words:
            for match in pattern.finditer(text):
                yield paragraph.line, f'"{match.group()}": say {instead}'
        if "..." in text or "…" in text:
            yield paragraph.line, "an ellipsis: write the sentence out"


def faults_of_sentences(found):
    for paragraph in found:
        if paragraph.kind != "text":
            continue
        for sentence in sentences(plain(paragraph.text())):
            count = len(words(sentence))
            if count > LONGEST_SENTENCE:
                yield paragraph.line, f"{count} words in a sentence; at most {LONGEST_SENTENCE}: {sentence}"
            if re.match(r"(What|Who|Whose)\b", sentence) and not sentence.endswith(("?", "?**")):
                yield paragraph.line, f'a noun made of "what" or "who": {sentence}'


def main(arguments):
    listing = "--list" in arguments
    chosen = [argument for argument in arguments if argument != "--list"]
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
    pages = {str(page.relative_to(ROOT)): page for page in pages}
    pages = {name: page for name, page in pages.items() if name not in GENERATED}
    unknown = [name for name in chosen if name not in pages]
    if unknown:
        print(f"check-words: no such page: {unknown[0]}; pages are {', '.join(pages)}", file=sys.stderr)
        return 2
    list_of_words = list(banned())
    wrong = 0
    for name, page in pages.items():
        if chosen and name not in chosen:
            continue
        lines = page.read_text(encoding="utf-8").splitlines()
        found = paragraphs(lines)
        faults = list(faults_of_words(found, list_of_words))
        long = [*long_lines(lines), *faults_of_sentences(found)]
        allowed = NOT_YET.get(name, 0)
        if len(long) > allowed or listing:
            faults += long
        elif len(long) < allowed:
            faults.append((1, f"{len(long)} long sentences and lines, and NOT_YET has {allowed}: lower it"))
        for line, fault in sorted(faults):
            print(f"{name}:{line}: {fault}")
        wrong += len(faults)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

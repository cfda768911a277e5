#!/usr/bin/env python3
"""Checks the English that readers meet: phrases of scripts/words.txt, sentences, lines.

Usage: scripts/check-words.py [--list] [--self-test] [PAGE...]

Without PAGE it checks README, DESIGN, CONTRIBUTING, CHANGELOG and docs/*.md, the templates and scripts of the
pages, golden texts of reports, and the published report. PAGE is one of these, or the path of any other
Markdown, HTML or text file, such as results/paper/report.html.

A sentence has at most 25 words and is not a noun made of "what" or "who"; there is no ellipsis; a line of
Markdown has at most 100 characters, without the addresses of links. Code and tables are free of the limits on
lines and sentences. Links and paths of files have to lead somewhere. Each fault is printed with file and line; exit 1 if there is one, 2 for a wrong
argument. A page in NOT_YET may have as many faults as it says: --list prints them too. --self-test tries the rules on EXAMPLES.
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LONGEST_LINE = 100
LONGEST_SENTENCE = 25

# Pages that still have faults, and how many. A page may leave this list and a number may fall; neither may grow.
# They are made by the program: their sentences change together with the golden digests of what it writes.
NOT_YET = {
    "crates/isostudy-timing/tests/golden/quiet.txt": 1,
    "crates/isostudy-serve/page/researcher.html": 1,
    "crates/isostudy/src/pipeline/pages/index.html": 1,
    "crates/isostudy/src/pipeline/pages/report.html": 1,
}

# What a rule must find, and sentences that it must let pass.
EXAMPLES = [
    ("The extract room has eleven folders.", "crate"),
    ("People sat in a dark room.", None),
    ("The room for labels is 40 pixels wide.", None),
    ("An odd respondent was left out.", "outlying"),
    ("The polynomial is odd: it has odd powers alone.", None),
    ("Each sitting has a warm-up.", "invocation"),
    ("They answered in one go, in a sitting room.", None),
    ("The two methods cannot be told apart.", "distinguished"),
    ("We were told about it.", None),
    ("It takes 3 ms a chunk.", "per"),
    ("It takes 3 ms per chunk.", None),
    ("A run of unsound results is refused.", "valid"),
    ("The proof is sound.", None),
    ("Whoever breaks a rule is left out.", "a person who"),
    ("It goes on and on ...", "ellipsis"),
    ("`a ... b` is code.", None),
    ("What was asked is counted.", "noun made of"),
    ("What was asked?", None),
    (" ".join(["word"] * 26) + ".", "26 words"),
    (" ".join(["word"] * 25) + ".", None),
    (" ".join(["word"] * 24) + " `some code of many words` ([docs/cubes.md](docs/cubes.md)).", "26 words"),
    (" ".join(["word"] * 23) + " (Jacobson, Kavan & Sorkine-Hornung 2013) end.", None),
    ("First one, " + " ".join(["word"] * 12) + ". Second one, " + " ".join(["word"] * 12) + ".", None),
]


class Paragraph:
    """Text of one paragraph, list item or cell, and the number of its first line."""

    def __init__(self, line, kind):
        self.line, self.kind, self.parts = line, kind, []

    def text(self):
        return " ".join(self.parts)


def paragraphs(lines):
    """Paragraphs, list items, table rows and headings of Markdown, outside of blocks of code."""
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


class Page(HTMLParser):
    """Paragraphs of HTML. Text inside of a paragraph keeps it together; every other element ends it."""

    INLINE = {"a", "b", "em", "i", "strong", "code", "span", "abbr", "sub", "sup", "small", "kbd", "q", "br", "time", "label", "dfn", "mark"}
    SILENT = {"script", "style", "svg", "pre", "template"}
    CELLS = {"td": "table", "th": "table", "h1": "heading", "h2": "heading", "h3": "heading", "h4": "heading", "title": "heading", "option": "heading"}

    def __init__(self):
        super().__init__()
        self.found, self.current, self.kinds, self.silent = [], None, ["text"], 0

    def handle_starttag(self, tag, attributes):
        if tag in self.SILENT:
            self.silent += 1
        elif tag == "code":
            self.handle_data("`")
        elif tag not in self.INLINE:
            self.current = None
            self.kinds.append(self.CELLS.get(tag, "text"))

    def handle_endtag(self, tag):
        if tag in self.SILENT:
            self.silent = max(0, self.silent - 1)
        elif tag == "code":
            self.handle_data("`")
        elif tag not in self.INLINE:
            self.current = None
            if len(self.kinds) > 1:
                self.kinds.pop()

    def handle_data(self, data):
        if self.silent or (not data.strip() and self.current is None):
            return
        if self.current is None:
            self.current = Paragraph(self.getpos()[0], self.kinds[-1])
            self.found.append(self.current)
        self.current.parts.append(" ".join(data.split()))


def paragraphs_of(path, text):
    if path.suffix == ".html":
        page = Page()
        # What a template puts in is one word; what it decides is none.
        text = re.sub(r"\{%.*?%\}|\{#.*?#\}", lambda found: "\n" * found.group().count("\n"), text, flags=re.S)
        page.feed(re.sub(r"\{\{.*?\}\}", "CODE", text))
        return page.found
    if path.suffix == ".js":
        # Texts that a page shows: quoted, of three words or more.
        found = []
        for number, line in enumerate(text.splitlines(), 1):
            for match in re.finditer(r"'((?:\\.|[^'\\])*)'|\"((?:\\.|[^\"\\])*)\"|`((?:\\.|[^`\\])*)`", line):
                shown = re.sub(r"\$\{[^}]*\}", "CODE", next(group for group in match.groups() if group is not None))
                if not line.lstrip().startswith("//") and re.search(r"[A-Za-z]+ [a-z]+ [a-z]+", shown):
                    found.append(Paragraph(number, "text"))
                    found[-1].parts.append(shown)
        return found
    return paragraphs(text.splitlines())


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


def slugs(text):
    """The anchors of a Markdown page, as its headings make them."""
    for paragraph in paragraphs(text.splitlines()):
        if paragraph.kind == "heading":
            heading = re.sub(r"[`*]", "", paragraph.text().lstrip("#").strip().lower())
            yield re.sub(r"[^\w -]", "", heading).replace(" ", "-")


def faults_of_places(path, text):
    """Links and paths in code that lead nowhere. Placeholders are in capitals; results and caches are made."""
    for paragraph in paragraphs(text.splitlines()):
        shown = paragraph.text()
        for address in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"`[^`]*`", "", shown) if "](" in shown else ""):
            file, _, anchor = address.partition("#")
            if re.match(r"\w+:", address) or file.startswith(("results/", "../results/")):
                continue
            there = (ROOT / path).parent / file if file else ROOT / path
            if not there.exists():
                yield paragraph.line, f"a link that leads nowhere: {address}"
            elif anchor and there.suffix == ".md" and anchor not in slugs(there.read_text(encoding="utf-8")):
                yield paragraph.line, f"a link to a heading that is not there: {address}"
        for named in re.findall(r"`((?:crates|configs|docs|examples|scripts|study|tests)/[\w./-]*[\w/])`", shown):
            if not re.search(r"\b[A-Z]{2,}\b", named.replace("README", "")) and not (ROOT / named).exists():
                yield paragraph.line, f"no such file: {named}"


def faults_of(path, text, list_of_words):
    found = paragraphs_of(path, text)
    faults = [*faults_of_words(found, list_of_words), *faults_of_sentences(found)]
    generated = "results" in path.parts
    if path.suffix == ".md" and not generated:
        faults += long_lines(text.splitlines())
        # What a changelog names may be gone.
        faults += faults_of_places(path, text) if path.name != "CHANGELOG.md" else []
    return sorted(faults)


def self_test(list_of_words):
    """Sentences of EXAMPLES that are judged otherwise than they should be."""
    wrong = []
    for suffix, around in ((".md", "{}"), (".html", "<p>{}</p>")):
        for sentence, expected in EXAMPLES:
            if suffix == ".html" and "`" in sentence:
                continue
            found = paragraphs_of(Path("page" + suffix), around.format(sentence))
            faults = [fault for _, fault in (*faults_of_words(found, list_of_words), *faults_of_sentences(found))]
            if bool(faults) != bool(expected) or (expected and not any(expected in fault for fault in faults)):
                wrong.append(f"check-words: {sentence!r} in {suffix}: expected {expected}, found {faults}")
    return wrong


def checked_pages():
    pages = [ROOT / name for name in ("README.md", "DESIGN.md", "CONTRIBUTING.md", "CHANGELOG.md")]
    pages += sorted((ROOT / "docs").glob("*.md"))
    for folder in ("crates/isostudy/src/pipeline/pages", "crates/isostudy-serve/page"):
        pages += sorted(path for path in (ROOT / folder).rglob("*") if path.suffix in (".html", ".js"))
    for golden in sorted([*(ROOT / "crates").glob("*/tests/**/golden"), ROOT / "tests/golden"]):
        pages += sorted(path for path in golden.rglob("*") if path.suffix in (".md", ".html", ".txt"))
    pages += sorted((ROOT / "results/published").rglob("*.md"))
    return {str(page.relative_to(ROOT)): page for page in pages}


def main(arguments):
    options = {argument for argument in arguments if argument.startswith("--")}
    chosen = [argument for argument in arguments if not argument.startswith("--")]
    if options - {"--list", "--self-test"}:
        print(f"check-words: no such option: {sorted(options)[0]}", file=sys.stderr)
        return 2
    list_of_words = list(banned())
    wrong = self_test(list_of_words)
    if wrong or "--self-test" in options:
        print("\n".join([*wrong, f"check-words: {len(EXAMPLES)} examples, {len(wrong)} judged wrongly"]))
        return 1 if wrong else 0
    pages = checked_pages()
    for name in chosen:
        if name not in pages and Path(name).suffix in (".md", ".html", ".js", ".txt") and Path(name).is_file():
            pages[name] = Path(name)
        elif name not in pages:
            print(f"check-words: no such page: {name}; pages are {', '.join(pages)}", file=sys.stderr)
            return 2
    number = 0
    for name, page in pages.items():
        if chosen and name not in chosen:
            continue
        faults = faults_of(page.relative_to(ROOT) if page.is_relative_to(ROOT) else page, page.read_text(encoding="utf-8"), list_of_words)
        allowed = NOT_YET.get(name, 0)
        if len(faults) < allowed:
            faults.append((1, f"{len(faults)} faults, and NOT_YET has {allowed}: lower it"))
        elif len(faults) == allowed and "--list" not in options:
            faults = []
        for line, fault in faults:
            print(f"{name}:{line}: {fault}")
        number += len(faults)
    return 1 if number else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

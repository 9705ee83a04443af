"""A page of Markdown: its figures with their queries, its generated tables, and the numbers that have neither a query
nor a mark.

    0.62<!--q NAME; cells_per_second; median; /1e6 .2f-->   a figure; the comment follows its last digit
    <!--rows NAME = FILES; FILTER-->                          names rows for the queries of this page
    1.93<!--not measured-->                                    marks the number; its unit may stand between
    <!--not measured: WHY-->                                   marks its line; alone on a line, the next block
    <!--not measured below: WHY-->                             marks all up to a heading of the same or a higher level
    <!--not measured page: WHY-->                              marks the page
    <!-- table NAME ARGUMENTS --> ... <!-- end table -->       encloses the output of scripts/update_docs
"""
import re
from dataclasses import dataclass

from .errors import DocsError
from .numbers import NOTHING, numbers_to_cover
from .query import parse_rows

COMMENT = re.compile(r"<!--(.*?)-->", re.DOTALL)
FIGURE = re.compile(r"((?<![\d.])[-+]?(?<![\w.])\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?|(?<![\w-])[A-Za-z]+)\**\Z")
LAST_NUMBER = re.compile(r"(?<![\w.])(\d[\d,]*(?:\.\d+)?(?:e[-+]?\d+)?)\**(?:\s%|[\s-]+[A-Za-z]+|[A-Za-z]+)?\Z")
TABLE = re.compile(r"<!-- table (?P<call>[^\n]*?) -->\n(?P<body>.*?)<!-- end table -->", re.DOTALL)
HEADING = re.compile(r"^(#+) .*$", re.MULTILINE)
NO_PROSE = [
    re.compile(r"^(```|~~~).*?^\1[^\n]*$", re.MULTILINE | re.DOTALL),
    re.compile(r"(?<=\n\n)(?: {4}[^\n]*\n+)+"),
    re.compile(r"(`+)(?!`).*?(?<!`)\1(?!`)", re.DOTALL),
]
NO_TEXT = [
    re.compile(r"(?<=\])\([^)\s]*\)"), re.compile(r"<?https?://[^\s)>]*"), re.compile(r"doi:[^\s\]]+"), HEADING,
    re.compile(r"^\s*\d+\. ", re.MULTILINE), re.compile(r"^\|[-| :]+\|$", re.MULTILINE),
]
ROW = re.compile(r"^\|.*\|[ ]*$", re.MULTILINE)


@dataclass(frozen=True)
class Figure:
    start: int
    end: int
    text: str
    query: str


@dataclass(frozen=True)
class Table:
    start: int
    end: int
    name: str
    arguments: list
    body: str


class Page:
    """Holds `figures`, `tables`, `uncovered`, `num_marked` and `faults` of `text`; faults are (place, words)."""

    def __init__(self, text):
        self.text, self.faults, self.rows, self.figures = text, [], {}, []
        visible = text
        for pattern in NO_PROSE:
            visible = pattern.sub(_blank, visible)
        self._comments = [one for one in COMMENT.finditer(text) if visible[one.start():one.start() + 4] == "<!--"]
        self.tables = [Table(one.start("body"), one.end("body"), *_call(one["call"]), one["body"])
                       for one in TABLE.finditer(text) if visible[one.start():one.start() + 4] == "<!--"]
        self._covered = [(one.start, one.end) for one in self.tables]
        for comment in self._comments:
            self._read(comment)
        self._find_uncovered(visible)

    def line_of(self, place):
        return self.text.count("\n", 0, place) + 1

    def _read(self, comment):
        words, place = " ".join(comment[1].split()), comment.start()
        if "--" in words:
            self.faults.append((place, "'--' within a comment, which shows it on pages of older Markdown"))
        if words.startswith("q "):
            found = FIGURE.search(self.text[max(0, place - 60):place])
            if not found:
                self.faults.append((place, "a query without a figure right before it"))
                return
            start = place - (min(60, place) - found.start(1))
            end = start + len(found[1])
            self.figures.append(Figure(start, end, found[1], words[2:]))
            self._covered.append((start, end))
        elif words.startswith("rows "):
            self._name_rows(words[5:], place)
        elif words.startswith("not measured"):
            self._mark(comment, words.removeprefix("not measured"))
        elif words.startswith(("table ", "end table")):
            if not any(one.start - 1 <= comment.end() <= one.start or one.end == place for one in self.tables):
                self.faults.append((place, f"'{words}' without its other end"))

    def _name_rows(self, words, place):
        name, sign, rest = words.partition("=")
        try:
            if not sign or not re.fullmatch(r"\w+", name.strip()):
                raise DocsError(f"'{words}' is not NAME = FILES; FILTER")
            self.rows[name.strip()] = parse_rows(rest, self.rows)
        except DocsError as error:
            self.faults.append((place, str(error)))

    def _mark(self, comment, words):
        scope, sign, why = (part.strip() for part in words.partition(":"))
        before = self.text[:comment.start()]
        number = LAST_NUMBER.search(before[-60:])
        if scope not in ("", "below", "page") or bool(sign) != bool(why) or (scope or not number) and not why:
            self.faults.append((comment.start(), f"'not measured{words}': 'not measured' behind a number, or 'not "
                                                 "measured: WHY', 'not measured below: WHY', 'not measured page: WHY'"))
        elif not why:
            start = comment.start() - min(60, len(before)) + number.start(1)
            self._covered.append((start, start + len(number[1])))
        else:
            self._covered.append(self._extent(scope, comment))

    def _extent(self, scope, comment):
        """Returns (start, end) of the text that a mark with a reason covers."""
        line_start = self.text.rfind("\n", 0, comment.start()) + 1
        line_end = (self.text + "\n").index("\n", comment.end())
        if scope == "page":
            return 0, len(self.text)
        if scope == "below":
            return comment.start(), self._end_of_section(comment.start())
        if self.text[line_start:line_end].strip() == comment[0]:
            block_end = self.text.find("\n\n", line_end)
            return comment.end(), len(self.text) if block_end < 0 else block_end
        return line_start, line_end

    def _end_of_section(self, place):
        above = [one for one in HEADING.finditer(self.text) if one.start() < place]
        level = len(above[-1][1]) if above else 0
        return next((one.start() for one in HEADING.finditer(self.text)
                     if one.start() > place and len(one[1]) <= level), len(self.text))

    def _find_uncovered(self, visible):
        for comment in self._comments:
            visible = visible[:comment.start()] + NOTHING * len(comment[0]) + visible[comment.end():]
        for pattern in NO_TEXT:
            visible = pattern.sub(_blank, visible)
        numbers = list(numbers_to_cover(visible, list(_body_cells(visible))))
        self.uncovered = [one for one in numbers
                          if not any(start <= one.start and one.end <= end for start, end in self._covered)]
        generated = [*self.figures, *self.tables]
        self.num_marked = len(numbers) - len(self.uncovered) - sum(
            any(part.start <= one.start and one.end <= part.end for part in generated) for one in numbers)


def _body_cells(text):
    """Yields (start, end) of the cells below the heading of each table. The line below the heading is already blank."""
    last_end = None
    for row in ROW.finditer(text):
        is_body = last_end is not None and re.fullmatch(r"\n( +\n)?", text[last_end:row.start()])
        last_end = row.end()
        if is_body:
            place = row.start() + 1
            for cell in row[0].strip()[1:-1].split("|"):
                yield place, place + len(cell)
                place += len(cell) + 1


def _blank(found):
    return re.sub(r"[^\n]", " ", found[0])


def _call(text):
    name, *arguments = text.split()
    return name, arguments

"""Writes report.html and report.json: what was claimed, what was measured, what holds.

  report.py --log measured.jsonl --out FOLDER
            [--claims verify/README.md] [--junit tests.xml] [--tests tests.json]
            [--mutation mutation.json] [--parts parts.json] [--build build.json]
            [--title TEXT] [--repeat COMMAND]

The log is what crossbeam/verification/evidence.hpp writes. It may hold claims of its own and say
what is verified, any further fields of the subject being shown as they are:

  {"kind": "claim", "id", "statement", "source", "tolerance_reason", "area"}
  {"kind": "subject", "name", ...}

Claims come from the table, from the log or from both. A claim of the table holds when tests carry
its ID, all of them passed and all its comparisons are within their bounds; one of the log when it
was compared at all and all comparisons are within their bounds.

Exit status: 0 the page is green, 1 it is red (a claim, another test or a part of the run failed), 2
there is no report. A test that was skipped here, say for want of a processor that can run it, has not
failed; the page's first line says what the run left out.
Needs Jinja2 and matplotlib (Debian: python3-jinja2 python3-matplotlib).
"""

import argparse
import dataclasses
import datetime
import json
import math
import os
import platform
import re
import subprocess
import sys
import xml.etree.ElementTree
from collections import Counter
from pathlib import Path

sys.dont_write_bytecode = True  # the program may lie where nothing is to be written
try:
    import jinja2
    from markupsafe import Markup, escape

    import plots
except ImportError as error:
    print(f"report.py: {error}. Debian and Ubuntu: apt install python3-jinja2 python3-matplotlib; "
          "elsewhere: pip install jinja2 matplotlib", file=sys.stderr)
    sys.exit(2)

ID = re.compile(r"V-[A-Z0-9]+-[0-9]+")
REPEAT = "ctest --test-dir build/verify -R {id} --output-on-failure"


class BadInput(Exception):
    """Why there is no report."""


@dataclasses.dataclass
class Claim:
    id: str
    statement: str
    area: str
    source: str = ""
    reason: str = ""
    test_file: str = ""
    tested: bool = False  # whether a test has to carry it
    tests: list = dataclasses.field(default_factory=list)
    left_out: int = 0  # tests that exist and were not asked to run
    comparisons: list = dataclasses.field(default_factory=list)
    pictures: list = dataclasses.field(default_factory=list)

    @property
    def faults(self):
        """Why it does not hold; empty if it does."""
        out = [f"test {t['status']}: {t['name']}" for t in self.tests
               if t["status"] in ("failed", "not run")]
        out += [f"{c['note']}: {plain(c['measured'])} is not {sign(c)} {plain(c['tolerance'])}"
                for c in self.comparisons if not c["pass"]]
        if self.tested and not self.tests and not self.left_out:
            out.append("no test carries this ID")
        if not self.tested and not self.comparisons:
            out.append("nothing was measured")
        return out

    @property
    def verdict(self):
        if self.faults:
            return "does not hold"
        ran = [t for t in self.tests if t["status"] != "skipped"]
        return "holds" if ran or self.comparisons else "not run"

    @property
    def tightest(self):
        """The comparison closest to its bound, or None."""
        return max(self.comparisons, key=lambda c: c["used"], default=None)

    @property
    def seconds(self):
        return sum(t["seconds"] for t in self.tests)


# --------------------------------------------------------------------------------------------------
# Reading


def read_text(file):
    try:
        return Path(file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise BadInput(f"cannot read {file}: {error}") from error


def read_json(file):
    try:
        return json.loads(read_text(file))
    except json.JSONDecodeError as error:
        raise BadInput(f"{file}: no JSON: {error}") from error


NUMBER, TEXT, LIST = (int, float, type(None)), str, list
FIELDS = {
    "measurement": {"id": TEXT, "measured": NUMBER, "tolerance": NUMBER, "bound": TEXT,
                    "pass": bool, "note": TEXT},
    "plot": {"id": TEXT, "title": TEXT, "caption": TEXT, "style": TEXT, "x": TEXT, "y": TEXT,
             "log_x": bool, "log_y": bool, "curves": LIST},
    "map": {"id": TEXT, "title": TEXT, "caption": TEXT, "x": TEXT, "y": TEXT, "z": TEXT,
            "at_x": LIST, "at_y": LIST, "values": LIST},
    "claim": {"id": TEXT, "statement": TEXT, "source": TEXT, "tolerance_reason": TEXT,
              "area": TEXT},
    "subject": {"name": TEXT},
}


def check(line):
    """The kind of a line; a complaint if a field is missing or senseless."""
    if not isinstance(line, dict):
        raise BadInput("an object is wanted")
    kind = line.get("kind")
    if not isinstance(kind, str) or kind not in FIELDS:
        raise BadInput(f"kind is {kind!r}, not one of {', '.join(FIELDS)}")
    for name, types in FIELDS[kind].items():
        if name not in line:
            raise BadInput(f"{kind} without {name}")
        is_flag = isinstance(line[name], bool)
        if not isinstance(line[name], types) or is_flag != (types is bool):
            raise BadInput(f"{kind}: {name} is {line[name]!r}")
    if kind == "measurement":
        check_measurement(line)
    elif kind == "plot":
        check_curves(line)
    elif kind == "map":
        shape = [len(line["at_x"])] * len(line["at_y"])
        if not shape or not shape[0] or shape != [len(row) for row in line["values"]]:
            raise BadInput("map: values have to be rows of at_x, one for each of at_y")
    return kind


def check_measurement(line):
    if line["bound"] not in ("upper", "lower"):
        raise BadInput(f"measurement: bound is {line['bound']!r}, not upper or lower")
    if line["tolerance"] is None:
        raise BadInput("measurement: the tolerance is no number")
    # Not finite is logged as null: then the program's own word counts.
    if line["measured"] is not None:
        less, more = ("measured", "tolerance") if line["bound"] == "upper" else (
            "tolerance", "measured")
        if line["pass"] != (line[less] <= line[more]):
            raise BadInput("measurement: pass contradicts the numbers")


def check_curves(line):
    if line["style"] not in ("curves", "bars"):
        raise BadInput(f"plot: style is {line['style']!r}, not curves or bars")
    if not line["curves"]:
        raise BadInput("plot without curves")
    for curve in line["curves"]:
        for name in ("name", "style", "x", "y"):
            if name not in curve:
                raise BadInput(f"plot: curve without {name}")
        if curve["style"] not in ("line", "points", "guide"):
            raise BadInput(f"plot: style of a curve is {curve['style']!r}")
        if len(curve["x"]) != len(curve["y"]):
            raise BadInput(f"plot: {len(curve['x'])} x and {len(curve['y'])} y in a curve")


def read_log(file):
    """(line number, kind, line) for every line of the log."""
    out = []
    for number, text in enumerate(read_text(file).splitlines(), 1):
        if not text.strip():
            continue
        try:
            line = json.loads(text)
            out.append((number, check(line), line))
        except (json.JSONDecodeError, BadInput, TypeError) as error:
            raise BadInput(f"{file}, line {number}: {error}") from error
    return out


def read_table(file):
    """Claims from rows `| ID | statement | test file | source | tolerance |` under headings."""
    claims, area = {}, ""
    for number, line in enumerate(read_text(file).splitlines(), 1):
        if line.startswith("## "):
            area = line[3:].strip()
        if not line.startswith("| V-"):
            continue
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if len(cells) != 5:
            raise BadInput(f"{file}, line {number}: {len(cells)} columns instead of five")
        if cells[0] in claims:
            raise BadInput(f"{file}, line {number}: a second row for {cells[0]}")
        claims[cells[0]] = Claim(cells[0], cells[1], area, cells[3], cells[4],
                                 cells[2].replace("`", ""))
    if not claims:
        raise BadInput(f"{file}: no claims")
    return claims


def status_of(case):
    """passed, failed, skipped, or not run where a test should have run and could not."""
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    # CTest writes the status; others mark what did not pass by an element.
    skipped, status = case.find("skipped"), case.get("status")
    if status == "fail":
        return "failed"
    if status in ("run", None):
        return "passed" if skipped is None else "skipped"
    # CTest says "notrun" of a test that skipped itself as of one without a program to run.
    itself = skipped is not None and skipped.get("message", "").startswith("SKIP_")
    return "skipped" if itself or status == "disabled" else "not run"


def read_junit(file):
    """All tests, and how long they took together [s]."""
    try:
        root = xml.etree.ElementTree.fromstring(read_text(file))
    except xml.etree.ElementTree.ParseError as error:
        raise BadInput(f"{file}: no JUnit XML: {error}") from error
    tests = [{"name": case.get("name", ""), "status": status_of(case),
              "seconds": float(case.get("time") or 0)} for case in root.iter("testcase")]
    return tests, float(root.get("time") or 0)


def read_mutation(file):
    mutation = read_json(file)
    if not isinstance(mutation, dict) or not isinstance(mutation.get("score"), (int, float)):
        raise BadInput(f"{file}: no score")
    return {"recorded": False, "date": "unknown", "commit": "unknown", "changed": [], **mutation}


def read_parts(file):
    """Parts of the run beside the tests: [{"name", "status": passed|failed|left out, "note"}]."""
    parts = read_json(file)
    for part in parts if isinstance(parts, list) else [None]:
        if not isinstance(part, dict) or not isinstance(part.get("name"), str) or part.get(
                "status") not in ("passed", "failed", "left out"):
            raise BadInput(f"{file}: {part!r} is no part of a run")
    return parts


# --------------------------------------------------------------------------------------------------
# Putting together


def used(comparison):
    """Share of its tolerance that a comparison uses: at most 1 when it passes."""
    measured, bound = comparison["measured"], comparison["tolerance"]
    if comparison["bound"] == "lower":
        measured, bound = bound, measured
    if comparison["measured"] is None:
        return 0.0 if comparison["pass"] else math.inf
    if measured <= 0 <= bound:
        return 0.0
    if measured > 0 < bound:
        return measured / bound
    if measured < 0 > bound:
        return bound / measured
    return math.inf


def natural(text):
    """Sorts "9 sweeps" before "10 sweeps"."""
    return [(1, int(part), "") if part.isdigit() else (0, 0, part)
            for part in re.split(r"(\d+)", text)]


def gather(options):
    """All claims by ID, the subjects, the tests of no claim, the seconds of all tests, and the
    names of the tests that were left out or skipped."""
    claims = read_table(options.claims) if options.claims else {}
    tests, seconds = read_junit(options.junit) if options.junit else ([], None)
    for claim in claims.values():
        claim.tested = options.junit is not None
    log = read_log(options.log)

    subjects = []
    for number, kind, line in log:
        where = f"{options.log}, line {number}"
        if kind == "claim":
            claim = Claim(line["id"], line["statement"], line["area"], line["source"],
                          line["tolerance_reason"])
            if not re.fullmatch(r"\S+", claim.id):
                raise BadInput(f"{where}: the ID {claim.id!r} is no word")
            known = claims.setdefault(claim.id, claim)
            if (known.statement, known.area) != (claim.statement, claim.area):
                raise BadInput(f"{where}: another claim than before under {claim.id}")
        elif kind == "subject":
            subject = {k: v for k, v in line.items() if k != "kind"}
            if subject not in subjects:
                subjects.append(subject)

    for number, kind, line in log:
        if kind in ("claim", "subject"):
            continue
        if line["id"] not in claims:
            raise BadInput(f"{options.log}, line {number}: {kind} of an unknown claim {line['id']}")
        claim = claims[line["id"]]
        if kind == "measurement":
            row = {k: line[k] for k in ("measured", "tolerance", "bound", "pass", "note")}
            claim.comparisons.append({**row, "used": used(row)})
        else:
            claim.pictures.append(line)
    if not claims:
        raise BadInput(f"{options.log}: no claims, and no table of claims is given")

    others = []
    for test in tests:
        ids = [i for i in ID.findall(test["name"]) if i in claims]
        for i in ids:
            claims[i].tests.append(test)
        if not ids:
            others.append(test)
    ran = {test["name"] for test in tests}
    every = read_json(options.tests).get("tests", []) if options.tests else []
    left_out = [test["name"] for test in every if test.get("name", "") not in ran]
    for i in (i for name in left_out for i in ID.findall(name) if i in claims):
        claims[i].left_out += 1
    skipped = [test["name"] for test in tests if test["status"] == "skipped"]

    # Tests run side by side: the order of the log's lines means nothing.
    for claim in claims.values():
        claim.comparisons.sort(key=lambda c: (natural(c["note"]), c["bound"], c["tolerance"]))
        claim.pictures.sort(key=lambda p: (natural(p["title"]), json.dumps(p)))
        claim.tests.sort(key=lambda t: natural(t["name"]))
    subjects.sort(key=lambda s: natural(s["name"]))
    return claims, subjects, others, seconds, left_out, skipped


def processor():
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine() or "unknown"


def operating_system():
    try:
        name = platform.freedesktop_os_release()["PRETTY_NAME"]
    except (OSError, KeyError):
        name = platform.system()
    return f"{name}, {platform.system()} {platform.release()}"


def commit_of(folder):
    """The commit that a folder stands at, with a plus when files differ from it."""
    def git(*arguments):
        run = subprocess.run(["git", "-C", str(folder), *arguments], check=True,
                             capture_output=True, text=True)
        return run.stdout.strip()
    try:
        return git("rev-parse", "HEAD") + ("+" if git("status", "--porcelain") else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def summary_of(claims):
    verdicts = Counter(claim.verdict for claim in claims)
    return {"claims": len(claims), "held": verdicts["holds"],
            "not_held": verdicts["does not hold"], "not_run": verdicts["not run"],
            "comparisons": sum(len(claim.comparisons) for claim in claims)}


def count(number, noun):
    return f"{number} {noun}{'' if number == 1 else 's'}"


def what_was_left_out(left_out, skipped, parts):
    """One line, empty where the run had everything."""
    out = [count(len(left_out), "long test")] if left_out else []
    out += [part["name"] for part in parts if part["status"] == "left out"]
    if skipped:
        out.append(count(len(skipped), "test") + " skipped here: " + ", ".join(skipped))
    return ("left out of this run: " + ", ".join(out)) if out else ""


def areas_of(claims):
    """(name, claims) in the order of the table or, where there is none, of the IDs."""
    areas = {}
    for claim in claims:
        areas.setdefault(claim.area, []).append(claim)
    return list(areas.items())


def row_of(claim):
    """A claim as report.json has it."""
    tightest = claim.tightest or {}
    return {
        "id": claim.id,
        "area": claim.area,
        "statement": claim.statement,
        "independent_source": claim.source,
        "tolerance_reason": claim.reason,
        "measured": tightest.get("measured"),
        "tolerance": tightest.get("tolerance"),
        "bound": tightest.get("bound"),
        "pass": {"holds": True, "does not hold": False, "not run": None}[claim.verdict],
        "faults": claim.faults,
        "test_file": claim.test_file,
        "tests": len(claim.tests),
        "seconds": round(claim.seconds, 3),
        "comparisons": [{k: v for k, v in c.items() if k != "used"} for c in claim.comparisons],
        "plots": [p["title"] for p in claim.pictures],
    }


def document(options):
    """Everything the page needs; the part that goes to report.json is under "json"."""
    claims, subjects, others, seconds, left_out, skipped = gather(options)
    claims = list(claims.values())
    if not options.claims:
        claims.sort(key=lambda c: natural(c.id))
    build = read_json(options.build) if options.build else {}
    mutation = read_mutation(options.mutation) if options.mutation else None
    parts = read_parts(options.parts) if options.parts else []
    title = options.title or (
        "Verification of " + " and ".join(s["name"] for s in subjects) if subjects
        else "Verification of crossbeam")
    facts = {
        "title": title,
        "summary": summary_of(claims),
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
        "version": build.get("version", "unknown"),
        "commit": commit_of(Path(options.claims).parent if options.claims else Path.cwd()),
        "machine": {"processor": processor(), "cores": os.cpu_count(), "os": operating_system()},
        "compiler": build.get("compiler", "unknown"),
        "flags": build.get("flags", "unknown"),
        "eigen": build.get("eigen", "unknown"),
        "seconds": seconds,
        "subjects": subjects,
        "mutation": mutation or {"score": None},
        "other_tests": {"run": sum(t["status"] in ("passed", "failed") for t in others),
                        "failed": [t["name"] for t in others
                                   if t["status"] in ("failed", "not run")]},
        "parts": parts,
        "left_out": what_was_left_out(left_out, skipped, parts),
    }
    # The one verdict: headline and exit status both say this.
    facts["good"] = not (facts["summary"]["not_held"] or facts["other_tests"]["failed"]
                         or any(part["status"] == "failed" for part in parts))
    return {"json": {**facts, "claims": [row_of(claim) for claim in claims]}, "claims": claims,
            **facts}


# --------------------------------------------------------------------------------------------------
# The page


def plain(value):
    return "not finite" if value is None else f"{value:.3g}"


def sign(comparison):
    return "≤" if comparison["bound"] == "upper" else "≥"


def number(value):
    """1.67e-15 as 1.67 x 10^-15, with the exponent raised."""
    mantissa, _, exponent = plain(value).replace("-", "−").partition("e")
    if not exponent:
        return Markup(mantissa)
    power = str(int(exponent.replace("−", "-"))).replace("-", "−")
    factor = "" if mantissa == "1" else f"{mantissa}&thinsp;×&thinsp;"
    return Markup(f"{factor}10<sup>{power}</sup>")


def percent(share):
    """Never rounded up to 100 %."""
    return f"{math.floor(share * 1000) / 10:.1f}&#8239;%"


def prose(text):
    """`backticks` as <code>; numbers such as 1e-12 are not broken."""
    html = re.sub(r"`([^`]*)`", r"<code>\1</code>", str(escape(text)))
    return Markup(re.sub(r"(\d[\d.]*e-\d+)", r'<span class="num">\1</span>', html))


def slug(text):
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-") or "area"


def pictures_of(claim):
    """(title, caption, svg) of each picture of a claim."""
    for k, picture in enumerate(claim.pictures):
        key = f"{slug(claim.id)}-{k}"
        draw = plots.map_svg if picture["kind"] == "map" else plots.plot_svg
        try:
            yield picture["title"], picture["caption"], Markup(draw(picture, key))
        except (TypeError, ValueError) as error:
            raise BadInput(f"{claim.id}: the picture {picture['title']!r} cannot be drawn: "
                           f"{error}") from error


def page(facts, repeat):
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True,
        undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters.update(number=number, prose=prose, slug=slug, sign=sign,
                               percent=lambda share: Markup(percent(share)))
    areas = areas_of(facts["claims"])
    margins = [(name, [{"id": c.id, "pass": c.verdict == "holds", "comparisons": c.comparisons}
                       for c in claims if c.comparisons]) for name, claims in areas]
    margins = [(name, claims) for name, claims in margins if claims]
    return environment.get_template("report.html.j2").render(
        {key: value for key, value in facts.items() if key not in ("json", "claims")},
        areas=[(name, claims, summary_of(claims)) for name, claims in areas],
        broken=[c for c in facts["claims"] if c.verdict == "does not hold"],
        margins=Markup(plots.margins_svg(margins)) if margins else "",
        pictures_of=pictures_of, repeat=repeat)


def write(file, text):
    """Nobody finds half a report: the text goes to a neighbour that is then renamed."""
    partial = file.with_name(f".{file.name}.partial-{os.getpid()}")
    try:
        partial.write_text(text, encoding="utf-8")
        os.replace(partial, file)
    finally:
        partial.unlink(missing_ok=True)


def report(options):
    facts = document(options)
    # What follows ctest is what the tests' names are for; others say how they are run, or nothing.
    html = page(facts, options.repeat or (REPEAT if options.junit else ""))
    text = json.dumps(facts["json"], indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    folder = Path(options.out)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write(folder / "report.json", text)
        write(folder / "report.html", html)
    except OSError as error:
        raise BadInput(f"cannot write to {folder}: {error}") from error

    counts = facts["summary"]
    if facts["left_out"]:
        print(facts["left_out"][0].upper() + facts["left_out"][1:])
    for name in facts["other_tests"]["failed"]:
        print(f"FAILED {name}")
    for part in facts["parts"]:
        if part["status"] == "failed":
            print(f"FAILED {part['name']}")
    for claim in facts["claims"]:
        for fault in claim.faults:
            print(f"NOT HELD {claim.id}: {fault}")
    left = f", {counts['not_run']} not run" if counts["not_run"] else ""
    print(f"{counts['held']} of {counts['claims']} claims hold{left}; {counts['comparisons']} "
          f"comparisons; report.html and report.json in {folder}")
    return 0 if facts["good"] else 1


def main(arguments=None):
    parser = argparse.ArgumentParser(
        prog="report.py", description="Writes report.html and report.json of a verification.")
    add = parser.add_argument
    add("--log", required=True, metavar="FILE", help="lines of JSON: measurements, plots, maps")
    add("--out", required=True, metavar="FOLDER", help="where the report goes")
    add("--claims", metavar="FILE", help="table of claims in Markdown")
    add("--junit", metavar="FILE", help="JUnit XML of the tests that ran")
    add("--tests", metavar="FILE", help="all tests, as by ctest --show-only=json-v1: tells claims "
        "that were left out from claims without a test")
    add("--mutation", metavar="FILE", help="result of a mutation run, or the record of one, JSON")
    add("--parts", metavar="FILE", help="parts of the run beside the tests, and what became of each, "
        "JSON")
    add("--build", metavar="FILE", help="compiler, flags and versions, JSON")
    add("--title", metavar="TEXT", help="headline of the page")
    add("--repeat", metavar="COMMAND", help="what repeats one claim; {id} stands for its ID")
    options = parser.parse_args(arguments)
    try:
        return report(options)
    except BadInput as error:
        print(f"report.py: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())

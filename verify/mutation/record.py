"""The record of the mutation run, record.json: its score, and for which text of each header it counts.

    record.py --check       exit status 1 where the record does not count for the headers as they are
    record.py --out FILE    the record with the reasons of its survivors and what has changed since,
                            for the report (verify/report/report.py --mutation FILE)

`./run mutate --record` writes the record, `./run mutate --changed` brings it up to date with the
headers that have changed.
"""

import argparse
import hashlib
import json
import pathlib
import sys
import tomllib

import instrument

HERE = pathlib.Path(__file__).resolve().parent
INCLUDE = HERE.parent.parent / "include"
RECORD = HERE / "record.json"
SURVIVORS = HERE / "survivors.toml"
AIM = 0.97
COUNTS = ("mutants", "judged", "not_applicable", "killed", "survivors")


def fingerprint(source):
    """Of the code: comments, white space and the order of includes ask for no new run."""
    words = [text for kind, text, _ in instrument.tokenize(source)[0]
             if kind not in ("space", "comment") and
             not (kind == "directive" and text.split()[0] in ("#include", "#pragma"))]
    return hashlib.sha256(" ".join(" ".join(words).split()).encode()).hexdigest()[:16]


def fingerprints(include=INCLUDE):
    return {name: fingerprint(path.read_text())
            for name, path in instrument.covered(include).items()}


def read(path=RECORD):
    return json.loads(path.read_text()) if path.exists() else {"headers": {}, "survivors": []}


def write(path, document):
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(path.name + ".partial")
    partial.write_text(json.dumps(document, indent=1, ensure_ascii=False) + "\n")
    partial.rename(path)


def changed(record, now):
    """Headers whose code the record does not count for: {name: why}."""
    then = {name: header["hash"] for name, header in record["headers"].items()}
    out = {name: "changed" if name in then else "new" for name, hash in now.items()
           if then.get(name) != hash}
    return out | {name: "gone" for name in then if name not in now}


def key_of(survivor):
    return survivor["file"], survivor["text"], survivor["change"]


def read_explanations(path=SURVIVORS):
    """{(file, line of source, 'before => after'): reason}"""
    out = {}
    if not path.exists():
        return out
    for entry in tomllib.loads(path.read_text()).get("survivor", []):
        for change in entry["mutants"]:
            key = (entry["file"], entry["line"], change)
            if key in out:
                raise ValueError(f"{path.name}: {key} stands twice")
            out[key] = " ".join(entry["why"].split())
    return out


def add_up(headers):
    total = {field: sum(h[field] for h in headers) for field in COUNTS}
    judged = total["judged"] - total["not_applicable"]
    total["score"] = round(total["killed"] / judged, 4) if judged else 1.0
    total["sampled"] = total["judged"] < total["mutants"]
    return total


def merged(record, per_file, survivors, now, date, commit, explanations):
    """The record with the results of a run; what is gone from the library goes from the record."""
    headers = {name: h for name, h in record["headers"].items() if name in now and
               name not in per_file}
    for name, counts in per_file.items():
        headers[name] = {"hash": now[name], "date": date, "commit": commit} | {
            field: counts[field] for field in COUNTS}
    headers = dict(sorted(headers.items()))
    alive = [{k: s[k] for k in ("file", "text", "change", "kind", "note")} for s in survivors]
    for old in record["survivors"]:
        if old["file"] in headers and old["file"] not in per_file:
            alive.append(old)
    alive.sort(key=key_of)
    folders = sorted({name.split("/")[1] for name in headers})
    return {
        "date": date, "commit": commit, **add_up(headers.values()),
        "folders": {folder: add_up([h for name, h in headers.items()
                                    if name.split("/")[1] == folder]) for folder in folders},
        "headers": headers,
        "unexplained": [f"{s['file']}: {s['text']}: {s['change']}" for s in alive
                        if key_of(s) not in explanations],
        "survivors": alive,
    }


def status(record, now, explanations, include=INCLUDE):
    """The record for the report: places and reasons of the survivors, headers changed since."""
    survivors = []
    for s in record["survivors"]:
        before, _, after = s["change"].partition(" => ")
        lines = [line.strip() for line in (include / s["file"]).read_text().split("\n")] \
            if s["file"] in now else []
        survivors.append(s | {"before": before, "after": after,
                              "line": lines.index(s["text"]) + 1 if s["text"] in lines else "gone",
                              "explanation": explanations.get(key_of(s), "")})
    return record | {"recorded": True, "changed": sorted(changed(record, now)),
                     "mutants": record.get("judged", 0), "survivors": survivors,
                     "per_file": {name: h | {"mutants": h["judged"]}
                                  for name, h in record["headers"].items()},
                     "unexplained": [s for s in survivors if not s["explanation"]]}


def complaints(record, now, explanations):
    """Why the record does not say that the headers as they are pass."""
    out = [f"{name}: {why} since the record was made: run `./run mutate --changed`"
           for name, why in sorted(changed(record, now).items())]
    if record.get("score", 0) < AIM:
        out.append(f"the score, {100 * record.get('score', 0):.1f} %, is below {100 * AIM:.0f} %")
    alive = {key_of(s) for s in record["survivors"]}
    out += [f"a survivor has no reason in survivors.toml: {': '.join(key)}"
            for key in sorted(alive - set(explanations))]
    out += [f"a reason in survivors.toml has no survivor: {': '.join(key)}"
            for key in sorted(set(explanations) - alive)]
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--include", type=pathlib.Path, default=INCLUDE)
    parser.add_argument("--record", type=pathlib.Path, default=RECORD)
    parser.add_argument("--survivors", type=pathlib.Path, default=SURVIVORS)
    arguments = parser.parse_args()
    record, now = read(arguments.record), fingerprints(arguments.include)
    explanations = read_explanations(arguments.survivors)
    if arguments.out:
        write(arguments.out, status(record, now, explanations, arguments.include))
    if not arguments.check:
        return 0
    found = complaints(record, now, explanations)
    print("\n".join(found) or f"{100 * record['score']:.1f} % of {record['judged']} mutants, "
          f"{record['date']}, commit {record['commit']}; current for {len(now)} headers")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

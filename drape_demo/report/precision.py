"""Draws run time against error from precision.json: python3 precision.py OUTDIR

Writes OUTDIR/report.html (one file, plots as SVG inside), the plots as .svg and .png beside it, and
adds the table "for this error, use this setting" to precision.json. Needs matplotlib >= 3.6 and
Jinja2.
"""

import io
import json
import os
import pathlib
import sys

try:
    import jinja2
    import markupsafe
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
except ImportError as error:
    sys.exit(f"precision.py: {error}. Debian and Ubuntu: apt install python3-matplotlib "
             "python3-jinja2; elsewhere: pip install matplotlib jinja2")

# Okabe and Ito's colours, which stay apart for colour-blind readers.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
MARKERS = "osD^vPX"
GREY = "#8c8c8c"
STYLE = {"font.size": 10, "axes.spines.top": False, "axes.spines.right": False,
         "legend.frameon": False, "legend.fontsize": 9, "svg.fonttype": "none",
         "figure.constrained_layout.use": True, "savefig.dpi": 150}

MEASURES = (("position", "relative L2 error of positions [-]"),
            ("shear_rms_deg", "shear angle, area-weighted rms [deg]"),
            ("shear_quantile_deg", "shear angle, 99 % of the area below [deg]"),
            ("outline_mm", "largest distance of the outlines [mm]"))

PAGE = jinja2.Template("""<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>crossbeam: run time against error</title>
<style>
body { font: 16px/1.5 system-ui, sans-serif; max-width: 78rem; margin: 2rem auto; padding: 0 1rem; color: #1a1a1a }
h1, h2, h3 { line-height: 1.2 } h2 { margin-top: 2.5rem }
.plots { display: flex; flex-wrap: wrap; gap: 1rem } .plots svg { width: 37rem; max-width: 100%; height: auto }
.wide { overflow-x: auto } table { border-collapse: collapse; font-size: .82rem }
td, th { padding: .15rem .6rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap }
td:first-child, th:first-child, td:nth-child(2), th:nth-child(2) { text-align: left }
.front td { font-weight: 600 } .note { color: #555 }
@media print { body { max-width: none; font-size: 11px } }
</style></head><body>
<h1>Run time against error</h1>
<p>Every setting of the explicit drape, and three integrators of SUNDIALS, on two cases. Costs are
seconds of one core of this machine; float is float arithmetic with positions in double{% if brief %}; <b>the short version: coarse meshes, few runs</b>{% endif %}.
How the reference is built, and what it proves: docs/theory/reference.md.</p>
{% for c in cases %}
<h2>{{ c.case }}</h2>
<h3>For this error, use this setting</h3>
<p>All errors together (mesh, speed, time step, arithmetic), against {{ c.overall_reference }}, explicit, double.</p>
<div class="wide"><table><tr><th>error of positions below</th><th>setting</th><th>it costs [s]</th><th>positions</th>
<th>shear rms [deg]</th><th>99 % [deg]</th><th>outline [mm]</th></tr>
{% for r in c.advice %}<tr><td>{{ r.target }}</td><td>{{ r.family }}, {{ r.setting }}</td><td>{{ "%.2f"|format(r.processor_s) }}</td>
<td>{{ "%.1e"|format(r.error.position) }}</td><td>{{ "%.2f"|format(r.error.shear_rms_deg) }}</td>
<td>{{ "%.2f"|format(r.error.shear_quantile_deg) }}</td><td>{{ "%.2f"|format(r.error.outline_mm) }}</td></tr>
{% endfor %}</table></div>
<h3>All errors</h3><div class="plots">{% for svg in c.overall_plots %}{{ svg }}{% endfor %}</div>
<p class="note">Line: the settings that none beats in both. Dashed: the largest change by eight starts that differ by 1e-9 mm.</p>
<h3>Errors of time integration alone</h3>
<p>Against {{ c.time_reference }} on the same mesh at the same speed, worst of ten times; the second
opinion (Adams) is {{ "%.1e"|format(c.uncertainty_of_the_time_reference.position) }} away, {{
"%.1e"|format(c.uncertainty_of_the_time_reference.largest_mm) }} mm at most.</p>
<div class="plots">{% for svg in c.time_plots %}{{ svg }}{% endfor %}</div>
<h3>Every run</h3>
<div class="wide"><table><tr><th>varied</th><th>setting</th><th>[s]</th><th>steps</th><th>element evaluations</th>
<th>error of time</th><th>all errors: positions</th><th>shear rms [deg]</th><th>99 % [deg]</th><th>outline [mm]</th></tr>
{% for r in c.runs %}<tr{% if r.front %} class="front"{% endif %}><td>{{ r.family }}</td><td>{{ r.setting }}</td><td>{{ "%.2f"|format(r.processor_s) }}</td>
<td>{{ r.steps }}</td><td>{{ "%.2e"|format(r.element_evaluations) }}</td>
<td>{% if r.time_error %}{{ "%.1e"|format(r.time_error.position) }}{% endif %}</td>
{% if r.error %}<td>{{ "%.1e"|format(r.error.position) }}</td><td>{{ "%.2f"|format(r.error.shear_rms_deg) }}</td>
<td>{{ "%.2f"|format(r.error.shear_quantile_deg) }}</td><td>{{ "%.2f"|format(r.error.outline_mm) }}</td>{% else %}<td></td><td></td><td></td><td></td>{% endif %}</tr>
{% endfor %}</table></div>
{% endfor %}</body></html>
""", autoescape=True)


def front(runs, error):
    """The runs that no other beats in both cost and error, cheapest first."""
    best, out = float("inf"), []
    for run in sorted(runs, key=lambda r: (r["processor_s"], error(r))):
        if error(run) < best:
            best = error(run)
            out.append(run)
    return out


def work_precision(path, runs, error, label, floor, lines):
    """One diagram: error against seconds, families apart, the Pareto front as a line."""
    with plt.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(7.4, 4.0))
        families = list(dict.fromkeys(r["family"] for r in runs))
        for k, family in enumerate(families):
            points = sorted((r["processor_s"], error(r)) for r in runs if r["family"] == family)
            axes.plot(*zip(*points), linestyle="none", marker=MARKERS[k % len(MARKERS)], markersize=6,
                      color=COLOURS[k % len(COLOURS)], label=family)
        best = front(runs, error)
        axes.plot([r["processor_s"] for r in best], [error(r) for r in best], color=GREY,
                  linewidth=1, zorder=0)
        axes.set_xscale("log")
        axes.set_yscale("log")
        if floor > 0:
            axes.axhline(floor, color=GREY, linestyle="--", linewidth=1)
            axes.annotate("starts 1e-9 mm apart", (1, floor), xycoords=("axes fraction", "data"),
                          ha="right", va="bottom", fontsize=8, color=GREY)
        for k, (value, text) in enumerate(lines):
            axes.axhline(value, color=GREY, linestyle=":", linewidth=1)
            # Side by side: meshes often have nearly the same error.
            axes.annotate(text, (1 - 0.2 * k, value), xycoords=("axes fraction", "data"),
                          ha="right", va="bottom", fontsize=8, color=GREY)
        axes.set_xlabel("processor time [s]")
        axes.set_ylabel(label)
        axes.legend(loc="upper left", bbox_to_anchor=(1, 1))
        text = io.StringIO()
        figure.savefig(text, format="svg", metadata={"Date": None})
        for end in (".svg", ".png"):
            partial = path.with_name(path.name + ".partial" + end)
            figure.savefig(partial)
            os.replace(partial, path.with_name(path.name + end))
        plt.close(figure)
    return text.getvalue()[text.getvalue().index("<svg"):]


def advice(runs):
    """For each error, the cheapest setting that is below it."""
    out = []
    for target in (0.1, 0.05, 0.03, 0.02, 0.01, 0.005, 0.002, 0.001):
        good = [r for r in runs if r["error"]["position"] <= target]
        if good:
            run = min(good, key=lambda r: r["processor_s"])
            out.append({"target": target} | {k: run[k] for k in
                       ("family", "setting", "processor_s", "element_evaluations", "error")})
    return out


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: python3 precision.py OUTDIR (the folder of precision.json)")
    folder = pathlib.Path(sys.argv[1])
    data = json.loads((folder / "precision.json").read_text())
    for key, case in data["cases"].items():
        overall = [r for r in case["runs"] if "error" in r]
        timed = [r for r in case["runs"] if "time_error" in r and r["family"] != "second opinion"]
        case["advice"] = advice(overall)
        best = front(overall, lambda r: r["error"]["position"])
        for run in case["runs"]:
            run["front"] = run in best
        # What the mesh alone costs in precision: the slowest run of each mesh but the reference's.
        slowest = {}
        for r in overall:
            if r["family"] == "mesh and speed":
                mesh, speed = r["setting"].split(", ")
                if mesh == case["overall_reference"].split(", ")[0]:
                    continue
                if mesh not in slowest or float(speed.split()[0]) < slowest[mesh][0]:
                    slowest[mesh] = (float(speed.split()[0]), r)
        print(f"\n{case['case']}: for this error of positions, use this setting (all errors, against "
              f"{case['overall_reference']})")
        for row in case["advice"]:
            print(f"  {row['target']:<6g} {row['family']}, {row['setting']:22} {row['processor_s']:8.2f} s   "
                  f"shear rms {row['error']['shear_rms_deg']:.2f} deg, 99 % "
                  f"{row['error']['shear_quantile_deg']:.2f} deg, outline "
                  f"{row['error']['outline_mm']:.2f} mm")
        case["plots"] = {"overall": [], "time": []}
        for name, label in MEASURES:
            lines = [(r["error"][name], f"mesh of {mesh}") for mesh, (_, r) in slowest.items()]
            case["plots"]["overall"].append(work_precision(
                folder / f"{key}_overall_{name}", overall, lambda r: r["error"][name], label,
                case["chaos_floor"][name], lines))
        for name, label in MEASURES[:2]:
            case["plots"]["time"].append(work_precision(
                folder / f"{key}_time_{name}", timed, lambda r: r["time_error"][name], label,
                case["chaos_floor"][name],
                [(case["uncertainty_of_the_time_reference"][name], "second opinion")]))
    page = PAGE.render(brief=data["brief"], cases=[
        c | {"overall_plots": map(markupsafe.Markup, c["plots"]["overall"]),
             "time_plots": map(markupsafe.Markup, c["plots"]["time"])}
        for c in data["cases"].values()])
    for case in data["cases"].values():
        del case["plots"]
    for name, text in (("report.html", page), ("precision.json", json.dumps(data, indent=1) + "\n")):
        partial = folder / (name + ".partial")
        partial.write_text(text)
        os.replace(partial, folder / name)
    print(f"\nplots and table: {folder / 'report.html'}")


if __name__ == "__main__":
    main()

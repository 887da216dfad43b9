"""The plots and maps of the report, drawn by matplotlib as SVG to stand inside an HTML page.

Each comes back as text: no prologue, no metadata, ids of its own, words as text. Needs
matplotlib >= 3.6.
"""

import io
import math
import re
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

# Okabe and Ito's colours, which stay apart for colour-blind readers.
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000")
DASHES = ("-", "--", "-.", ":")
MARKERS = "osD^vPX"
GREY, LIGHT = "#8c8c8c", "#d9d9d9"
FAILS = "#b3260e"

WIDTH, HEIGHT = 5.6, 3.5  # inch
FEW = 24  # points of a line that are worth a marker each

STYLE = {
    "font.size": 10.5,
    "font.family": "sans-serif",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "axes.formatter.limits": (-3, 4),
    "lines.linewidth": 1.6,
    "lines.markersize": 4,
    "legend.frameon": False,
    "legend.fontsize": 9.5,
    "legend.handlelength": 2.2,
    "figure.constrained_layout.use": True,
    "savefig.dpi": 150,  # of the pixels of a map
    "svg.fonttype": "none",
    # A dollar in somebody's label is a dollar.
    "text.parse_math": False,
}

SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def label(value, _position=None):
    """A number on a logarithmic axis, 2e-5 as 2·10⁻⁵: plain text, not matplotlib's mathematics."""
    if 0.01 <= value <= 1000:
        return f"{value:g}"
    mantissa, exponent = f"{value:.0e}".split("e")
    factor = "" if mantissa == "1" else mantissa + "·"
    return factor + "10" + str(int(exponent)).translate(SUPERSCRIPT)


def numbers(values):
    """None, as which NaN is logged, leaves a gap."""
    return np.array([math.nan if v is None else v for v in values], dtype=float)


def positive(values):
    """What a logarithmic axis can show."""
    return np.where(values > 0, values, math.nan)


def logarithmic(axis):
    """Decades as powers of ten; between them numbers only where there are fewer than two."""
    low, high = sorted(axis.get_view_interval())
    decades = math.log10(high / low) if low > 0 and math.isfinite(high) else 1
    axis.set_major_locator(LogLocator(numticks=9))
    axis.set_major_formatter(FuncFormatter(label))
    if decades < 2:
        axis.set_minor_locator(LogLocator(subs=(2, 5)))
        axis.set_minor_formatter(FuncFormatter(label))
    else:
        axis.set_minor_formatter(NullFormatter())


def inline_svg(figure, key):
    """The figure as an <svg> element whose ids begin with `key`."""
    text = io.StringIO()
    with matplotlib.rc_context({"svg.hashsalt": key}):
        figure.savefig(text, format="svg", metadata={"Date": None})
    plt.close(figure)
    svg = text.getvalue()
    svg = svg[svg.index("<svg"):]
    svg = re.sub(r"<metadata>.*?</metadata>", "", svg, count=1, flags=re.DOTALL)
    svg = re.sub(r' xmlns(:xlink)?="[^"]*"', "", svg)
    svg = re.sub(r'\bid="', f'id="{key}-', svg)
    svg = svg.replace("url(#", f"url(#{key}-")
    svg = re.sub(r'(<use[^>]*?xlink:href="#)', rf"\g<1>{key}-", svg)
    svg = re.sub(r"<!--.*?-->", "", svg, flags=re.DOTALL)
    # Hundredths of a point are enough; words stay as they are.
    svg = re.sub(r"<[^>]*>", lambda tag: re.sub(r"(\d\.\d\d)\d+", r"\1", tag[0]), svg)
    # The page sets the size, the view box keeps the proportions.
    return re.sub(r'(<svg[^>]*?) width="[^"]*"', r"\1", re.sub(
        r'(<svg[^>]*?) height="[^"]*"', r"\1", svg, count=1), count=1)


def legend_above(figure, axes):
    """A legend above the axes, which make room for it: it never covers data."""
    handles, labels = axes.get_legend_handles_labels()
    if len(labels) < 2:
        return
    widest = max(len(name) for name in labels)
    columns = max(1, min(len(labels), int(72 / (widest + 7))))
    legend = figure.legend(handles, labels, loc="upper left", ncol=columns,
                           borderaxespad=0.2, columnspacing=1.2)
    height = legend.get_window_extent(figure.canvas.get_renderer()).height / figure.dpi + 0.08
    figure.set_size_inches(WIDTH, HEIGHT + height)
    share = height / (HEIGHT + height)
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - share))


def draw_bars(axes, curve):
    x, y = numbers(curve["x"]), numbers(curve["y"])
    gaps = np.diff(np.unique(x[np.isfinite(x)]))
    axes.bar(x, y, width=0.85 * (gaps.min() if gaps.size else 1), color=COLOURS[0])


def draw_curves(axes, curves, log_x, log_y):
    few = max(len(curve["x"]) for curve in curves) <= FEW
    coloured = 0
    for curve in curves:
        x, y = numbers(curve["x"]), numbers(curve["y"])
        x, y = positive(x) if log_x else x, positive(y) if log_y else y
        name = curve["name"] or None
        if curve["style"] == "guide":
            axes.plot(x, y, color=GREY, linewidth=0.8, label=name, zorder=1)
            continue
        style = {"color": COLOURS[coloured % len(COLOURS)], "label": name}
        turn = coloured // len(COLOURS)
        marker = MARKERS[coloured % len(MARKERS)]
        coloured += 1
        if curve["style"] == "points":
            axes.plot(x, y, linestyle="none", marker=marker, **style)
        else:
            axes.plot(x, y, linestyle=DASHES[turn % len(DASHES)],
                      marker=marker if few else None, **style)


def plot_svg(plot, key):
    """A "plot" line of the log."""
    with matplotlib.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(WIDTH, HEIGHT))
        log_x, log_y = plot["log_x"], plot["log_y"]
        if log_x:
            axes.set_xscale("log")
        if log_y:
            axes.set_yscale("log")
        if plot["style"] == "bars":
            draw_bars(axes, plot["curves"][0])
        else:
            draw_curves(axes, plot["curves"], log_x, log_y)
        for on, axis in ((log_x, axes.xaxis), (log_y, axes.yaxis)):
            if on:
                logarithmic(axis)
        if not log_x and all(v is None or v == round(v) for c in plot["curves"] for v in c["x"]):
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
        axes.set_xlabel(textwrap.fill(plot["x"], 60))
        axes.set_ylabel(textwrap.fill(plot["y"], 36))
        axes.grid(True, color=LIGHT, linewidth=0.5)
        axes.set_axisbelow(True)
        legend_above(figure, axes)
        return inline_svg(figure, key)


def map_svg(field, key):
    """A "map" line of the log; places without a value stay grey."""
    with matplotlib.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(WIDTH, HEIGHT + 0.4))
        values = np.ma.masked_invalid([numbers(row) for row in field["values"]])
        colours = matplotlib.colormaps["cividis"].with_extremes(bad=LIGHT)
        image = axes.pcolormesh(numbers(field["at_x"]), numbers(field["at_y"]), values,
                                shading="nearest", cmap=colours, rasterized=True)
        axes.set_facecolor(LIGHT)
        axes.set_xlabel(field["x"])
        axes.set_ylabel(field["y"])
        bar = figure.colorbar(image, ax=axes, label=field["z"])
        bar.outline.set_visible(False)
        return inline_svg(figure, key)


LEAST = 1e-6  # share of a tolerance below which the overview does not look


def margins_svg(areas, key="margins"):
    """How much of its tolerance each claim uses: one row per claim, dots that link to the claims.

    `areas`: (name, claims), each claim with "id", "pass" and "comparisons", each of those with
    "used", its share of the tolerance.
    """
    rows = sum(len(claims) for _, claims in areas)
    with matplotlib.rc_context(STYLE):
        figure, axes = plt.subplots(figsize=(6.4, 0.9 + 0.046 * rows + 0.12 * len(areas)))
        axes.set_xscale("log")
        nothing = LEAST / 6  # the column of those that differ by exactly nothing
        middles, small, large = [], [], []  # of small and large: place, row; claim too
        row = 0.0
        for number, (name, claims) in enumerate(areas):
            top = row
            row += 1.3
            for claim in claims:
                places = [min(max(c["used"], LEAST), 1e3) if c["used"] > 0 else nothing
                          for c in claim["comparisons"]]
                small += [(place, row) for place in places]
                large.append((max(places), row, claim))
                row += 1
            row += 1.3
            if number % 2 == 0:
                axes.axhspan(top, row, color="#f3f3f0", zorder=0, linewidth=0)
            middles.append((0.5 * (top + row), name))
        axes.plot(*zip(*small), "o", color=GREY, alpha=0.45, markersize=2.2, markeredgewidth=0)
        for good, size, marker, colour in ((True, 11, "o", COLOURS[0]), (False, 34, "X", FAILS)):
            those = [(x, y, "#" + claim["id"]) for x, y, claim in large if claim["pass"] == good]
            if those:
                x, y, links = zip(*those)
                dots = axes.scatter(x, y, s=size, marker=marker, color=colour, linewidths=0,
                                    zorder=3)
                dots.set_urls(links)
        axes.axvline(1, color="#222222", linewidth=1)
        axes.set_ylim(max(row, 1), 0)
        axes.set_yticks([m for m, _ in middles], [n for _, n in middles])
        axes.tick_params(axis="y", length=0)
        worst = max(place for place, _ in small)
        axes.set_xlim(nothing / 2, max(2.5, 2 * worst))
        decades = [10.0**k for k in range(-6, 4) if k <= 0 or 10.0**k <= worst]
        axes.set_xticks([nothing] + decades, ["0"] + [label(d) for d in decades])
        axes.xaxis.set_minor_locator(plt.NullLocator())
        axes.grid(True, axis="x", color=LIGHT, linewidth=0.5)
        axes.set_axisbelow(True)
        for side in ("left", "right", "top"):
            axes.spines[side].set_visible(False)
        axes.set_xlabel("share of the tolerance that is used")
        svg = inline_svg(figure, key)
    # Say on hovering which claim a dot is.
    return re.sub(r'(<a xlink:href="#([^"]+)">)', r"\1<title>\2</title>", svg)

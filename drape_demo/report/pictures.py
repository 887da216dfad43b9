"""Draws the pictures of one double-dome run: python3 pictures.py OUTDIR

Reads summary.json, the .csv files and the first and last frame of drape.pvd in OUTDIR and writes
formed_part, outline, shear_angles and energy_ledger there, each as .png and .svg. A picture
appears complete or not at all. Needs matplotlib >= 3.6, numpy and meshio.
"""

import csv
import json
import os
import sys
import xml.etree.ElementTree
from pathlib import Path

try:
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    import meshio
    import numpy as np
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.patheffects import withStroke
    from matplotlib.ticker import FixedLocator, FormatStrFormatter
    from matplotlib.tri import LinearTriInterpolator, Triangulation
except ImportError as error:
    sys.exit(
        f"pictures.py: {error}. Debian and Ubuntu: apt install python3-matplotlib python3-meshio; "
        "elsewhere: pip install matplotlib meshio"
    )

# Okabe and Ito's colours, which stay apart for colour-blind readers.
BLACK, ORANGE, SKY, GREEN, YELLOW, BLUE, RED, PURPLE = (
    "#000000",
    "#e69f00",
    "#56b4e9",
    "#009e73",
    "#f0e442",
    "#0072b2",
    "#d55e00",
    "#cc79a7",
)
GREY = "#8c8c8c"

FIBRE_SPACING = 10.0  # between the fibre lines drawn [mm]
SCREEN_DPI = 180

STYLE = {
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.labelsize": 10,
    "legend.fontsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.8,
    "lines.linewidth": 1.6,
    "figure.dpi": 100,
    "savefig.dpi": SCREEN_DPI,
    "svg.fonttype": "none",
}


def save(figure, folder, name):
    """Writes name.png and name.svg under temporary names first."""
    for kind in ("png", "svg"):
        partial = folder / f".{name}.partial-{os.getpid()}.{kind}"
        try:
            figure.savefig(partial, facecolor="white")
            os.replace(partial, folder / f"{name}.{kind}")
        finally:
            partial.unlink(missing_ok=True)
    plt.close(figure)
    enter_in_manifest(folder, [f"{name}.{kind}" for kind in ("png", "svg")])


def enter_in_manifest(folder, names):
    """manifest.json lists what the next result in the folder replaces: pictures, too."""
    file = folder / "manifest.json"
    manifest = json.loads(file.read_text(encoding="utf-8"))
    entries = [entry for entry in manifest["files"] if entry["name"] not in names]
    for name in names:
        status = (folder / name).stat()
        entries.append(
            {"name": name, "bytes": status.st_size, "modified_ns": status.st_mtime_ns})
    manifest["files"] = entries
    partial = folder / "manifest.json.partial"
    partial.write_text(json.dumps(manifest, indent=1) + "\n", encoding="utf-8")
    os.replace(partial, file)


# --------------------------------------------------------------------------------------------------
# The run


def table(file):
    """The columns of a .csv file by name, without their units."""
    with open(file, newline="", encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    names = [name.split(" [")[0] for name in rows[0]]
    values = np.array(rows[1:], dtype=float).reshape(-1, len(names))
    return {name: values[:, i] for i, name in enumerate(names)}


class Part:
    """Flat and formed quarter of the blank."""

    def __init__(self, folder):
        collection = xml.etree.ElementTree.parse(folder / "drape.pvd").getroot()
        files = [folder / item.get("file") for item in collection.iter("DataSet")]
        flat, formed = meshio.read(files[0]), meshio.read(files[-1])
        if np.ptp(flat.points[:, 2]) > 0.1:
            sys.exit(f"pictures.py: {files[0]} is not the flat blank: fibre lines start from there")
        self.flat = flat.points[:, :2]
        self.points = formed.points
        self.quads = formed.cells_dict["quad"]
        self.angle = np.asarray(formed.point_data["shear_angle"]).ravel()
        self.element_angle = np.asarray(formed.cell_data["shear_angle"][0]).ravel()
        self.size = self.flat.max(axis=0)
        # Where the flat blank's points have gone, linear on the halves of the elements.
        halves = np.vstack([self.quads[:, [0, 1, 2]], self.quads[:, [0, 2, 3]]])
        triangulation = Triangulation(self.flat[:, 0], self.flat[:, 1], halves)
        self.to_formed = [
            LinearTriInterpolator(triangulation, self.points[:, axis]) for axis in range(3)
        ]

    def formed(self, x, y):
        """Formed places of points of the full flat blank, by symmetry."""
        inside = np.minimum(np.abs([x, y]), self.size[:, None] * (1 - 1e-9))
        place = np.column_stack([f(inside[0], inside[1]).filled(np.nan) for f in self.to_formed])
        place[:, 0] *= np.where(x < 0, -1, 1)
        place[:, 1] *= np.where(y < 0, -1, 1)
        return place

    def fibre_lines(self, direction_deg):
        """Formed fibre lines of the full blank; direction from the x axis of the flat blank."""
        angle = np.radians(direction_deg)
        along = np.round([np.cos(angle), np.sin(angle)], 12)
        across = np.array([-along[1], along[0]])
        lines = []
        count = int(np.hypot(*self.size) / FIBRE_SPACING)
        for k in range(-count, count + 1):
            start = k * FIBRE_SPACING * across
            # The line start + t along is on the blank for t between these two.
            with np.errstate(divide="ignore", invalid="ignore"):
                ends = np.sort([(-self.size - start) / along, (self.size - start) / along], axis=0)
            on_blank = np.abs(start) <= self.size
            ends[:, (along == 0) & on_blank] = [[-np.inf], [np.inf]]
            first, last = ends[0].max(), ends[1].min()
            if not np.isfinite([first, last]).all() or last - first < 1:
                continue
            t = np.linspace(first, last, max(2, int((last - first) / 2.5) + 1))
            xy = start + np.outer(t, along)
            lines.append(self.formed(xy[:, 0], xy[:, 1]))
        return lines

    def full(self):
        """Formed elements of all four quarters, their node angles' means and their height."""
        corners = self.points[self.quads]
        all_corners, all_angles = [], []
        for sx in (1, -1):
            for sy in (1, -1):
                all_corners.append(corners * np.array([sx, sy, 1]))
                all_angles.append(self.angle[self.quads].mean(axis=1))
        return np.concatenate(all_corners), np.abs(np.concatenate(all_angles))


def title(summary):
    case = summary["case"]
    blank, process, contact = case["blank"], case["process"], case["contact"]
    fibres = "0/90" if blank["layout"] == 0 else "±45°"
    return (
        f"{case['name'] or 'unnamed case'}, {fibres}, {blank['element_size']:g} mm, "
        f"{process['speed']:g} m/s, friction {contact['friction']:g}, "
        f"holder {1000 * process['holder_force']:g} N"
    )


# --------------------------------------------------------------------------------------------------
# The pictures


def camera(points):
    """Perspective projection of points (..., 3): picture plane (..., 2) and distance (...)."""
    elevation, azimuth, distance = np.radians(33), np.radians(-58), 1100.0
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0])
    ahead = np.cos(elevation)
    back = np.array([ahead * np.cos(azimuth), ahead * np.sin(azimuth), np.sin(elevation)])
    up = np.cross(back, right)
    far = distance - points @ back
    plane = np.stack([points @ right, points @ up], axis=-1) * (distance / far)[..., None]
    return plane, far


def shaded(corners, colours):
    """Colours darkened where an element turns away from the light."""
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    light = np.array([-0.35, -0.35, 0.87])
    result = colours.copy()
    result[:, :3] *= (0.6 + 0.4 * np.abs(normal @ light))[:, None]
    return result


def draw_perspective(axes, corners, colours, lines):
    """Elements and pieces of the fibre lines, painted from far to near."""
    pieces = np.concatenate([np.stack([line[:-1], line[1:]], axis=1) for line in lines])
    element_plane, element_far = camera(corners)
    piece_plane, piece_far = camera(pieces)
    # The fibres lie on the elements: half an element towards the viewer puts them in front.
    lift = 0.6 * np.linalg.norm(corners[:, 2] - corners[:, 0], axis=1).max()
    far = np.concatenate([element_far.mean(axis=1), piece_far.mean(axis=1) - lift])
    order = np.argsort(-far)
    shapes = list(element_plane) + list(piece_plane)
    fill = np.concatenate([shaded(corners, colours), np.zeros((len(pieces), 4))])
    edge = np.concatenate([shaded(corners, colours), np.tile([1, 1, 1, 0.75], (len(pieces), 1))])
    width = np.concatenate([np.full(len(corners), 0.3), np.full(len(pieces), 0.45)])
    painted = PolyCollection(
        [shapes[i] for i in order],
        facecolors=fill[order],
        edgecolors=edge[order],
        linewidths=width[order],
        closed=False,
    )
    painted.set_rasterized(True)
    axes.add_collection(painted)
    low, high = element_plane.reshape(-1, 2).min(axis=0), element_plane.reshape(-1, 2).max(axis=0)
    axes.set(xlim=(low[0] - 3, high[0] + 3), ylim=(low[1] - 3, high[1] + 3), aspect="equal")
    axes.set_axis_off()


def draw_formed_part(part, summary, folder):
    corners, angles = part.full()
    layout = summary["case"]["blank"]["layout"]
    lines = part.fibre_lines(layout) + part.fibre_lines(layout + 90)
    scale = plt.Normalize(0, max(5.0, 5 * np.ceil(angles.max() / 5)))
    colours = plt.get_cmap("viridis")

    figure = plt.figure(figsize=(11.5, 6.6))
    figure.suptitle(f"Formed part, coloured by shear angle\n{title(summary)}", y=0.98)
    plan = figure.add_axes([0.06, 0.09, 0.32, 0.78])
    patches = PolyCollection(
        corners[:, :, :2], array=angles, cmap=colours, norm=scale, edgecolors="face", linewidths=0.3
    )
    patches.set_rasterized(True)
    plan.add_collection(patches)
    plan.add_collection(
        LineCollection([line[:, :2] for line in lines], colors="white", linewidths=0.4, alpha=0.8)
    )
    reach = np.abs(corners[:, :, :2]).max(axis=(0, 1)) + 6
    plan.set(xlim=(-reach[0], reach[0]), ylim=(-reach[1], reach[1]), aspect="equal")
    plan.set(xlabel="x [mm]", ylabel="y [mm]")
    for number, point in enumerate(summary["shear_points"], start=1):
        plan.plot(
            point["x"], point["y"], marker="o", markersize=3.4, color="white",
            markeredgecolor=BLACK, markeredgewidth=0.7,
        )
        plan.annotate(
            str(number), (point["x"], point["y"]), xytext=(3.5, 2), textcoords="offset points",
            fontsize=7.5, color="white", path_effects=[withStroke(linewidth=1.4, foreground=BLACK)],
        )

    draw_perspective(
        figure.add_axes([0.385, 0.05, 0.53, 0.84]), corners, colours(scale(angles)), lines
    )
    bar = figure.add_axes([0.925, 0.2, 0.014, 0.55])
    figure.colorbar(
        plt.cm.ScalarMappable(scale, colours), cax=bar, label="magnitude of the shear angle [deg]"
    )
    figure.text(
        0.65, 0.03, f"white: fibre lines, {FIBRE_SPACING:g} mm apart on the flat blank; "
        "circles: points 1-10", ha="center", fontsize=9, color="#404040",
    )
    save(figure, folder, "formed_part")


def draw_outline(outline, summary, folder):
    case, net = summary["case"], summary["references"]["net"]
    aligned = case["blank"]["layout"] == 0
    width, length = case["blank"]["half_width"], case["blank"]["half_length"]

    figure, axes = plt.subplots(figsize=(5.3, 7.6), constrained_layout=True)
    axes.plot(
        [0, width, width], [length, length, 0], color=GREY, linestyle=(0, (6, 3)), linewidth=1.1,
        label="flat blank",
    )
    axes.plot(outline["x"], outline["y"], color=BLUE, linewidth=2.2, label="this run")
    if aligned:
        for edge, label in (("long_edge", "pin-jointed net"), ("short_edge", None)):
            x, y = np.array(net[edge]).T
            axes.plot(
                x, y, color=RED, linewidth=1.0, marker="o", markersize=4.5, markerfacecolor="white",
                label=label, clip_on=False,
            )
    axes.plot([0, width], [length, 0], color=BLACK, linewidth=0.7, linestyle=":")
    points = summary["shear_points"]
    axes.plot(
        [p["x"] for p in points], [p["y"] for p in points], color=BLACK, linestyle="none",
        marker="+", markersize=7, label="points 1-10",
    )
    for number, p in enumerate(points, start=1):
        axes.annotate(
            str(number), (p["x"], p["y"]), xytext=(-4, -4), textcoords="offset points", ha="right",
            va="top", fontsize=8.5,
        )
    draw_in = summary["draw_in"]
    note = f"draw-in on x and y\nthis run: {draw_in['x']:.1f} and {draw_in['y']:.1f} mm"
    if aligned:
        note += f"\nnet: {net['draw_in']['x']:.1f} and {net['draw_in']['y']:.1f} mm"
    axes.text(5, 8, note, fontsize=9, va="bottom")
    axes.set(xlim=(0, width + 8), ylim=(0, length + 8), aspect="equal")
    axes.set(xlabel="x [mm]", ylabel="y [mm]")
    axes.set_title(f"Formed outline, quarter\n{title(summary)}", fontsize=10)
    axes.legend(loc="center left", bbox_to_anchor=(0.02, 0.3), frameon=False)
    save(figure, folder, "outline")


def draw_shear_angles(summary, folder):
    case, references = summary["case"], summary["references"]
    net, study, second = references["net"], references["study"], references["second_code"]
    aligned = case["blank"]["layout"] == 0

    figure, axes = plt.subplots(figsize=(7.6, 4.8), constrained_layout=True)
    numbers = np.arange(1, 11)
    if aligned:
        axes.plot(
            numbers, net["shear_deg"], color=RED, linestyle="--", linewidth=1.1, marker="o",
            markersize=5, markerfacecolor="white", label="pin-jointed net (kinematics only)",
        )
        count = len(study["shear_deg"])
        axes.errorbar(
            numbers[:count] - 0.13, study["shear_deg"], yerr=study["shear_band"], color=ORANGE,
            linestyle="none", marker="s", markersize=5.5, capsize=4, elinewidth=1.3, zorder=6,
            label="study with its bands (case realistic)",
        )
        bound = study["slack_flange_shear_deg"]
        axes.fill_between(
            [count + 0.6, 10.4], -bound, bound, color=ORANGE, alpha=0.18, linewidth=0,
            label="study: magnitude in the slack flange",
        )
        axes.plot(
            numbers[: len(second["shear_deg"])] + 0.13, second["shear_deg"], color=GREEN,
            linestyle="none", marker="^", markersize=6.5,
            label=f"{second['name']} (case realistic)",
        )
    run = [p["shear_deg"] for p in summary["shear_points"]]
    axes.plot(
        numbers[: len(run)], run, color=BLUE, linewidth=1.8, marker="D", markersize=5,
        label="this run", zorder=5,
    )
    axes.axhline(0, color=BLACK, linewidth=0.6)
    axes.set(xlim=(0.6, 10.4), xlabel="point, from (0, 235) to (135, 0) in the formed plan")
    axes.set(ylabel="shear angle [deg]")
    axes.set_xticks(numbers)
    axes.grid(axis="y", color="#dddddd", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.set_title(f"Shear angles: {title(summary)}")
    axes.set_ylim(top=axes.get_ylim()[1] + 2)
    handles, names = axes.get_legend_handles_labels()
    order = sorted(range(len(names)), key=lambda i: names[i] != "this run")
    axes.legend(
        [handles[i] for i in order], [names[i] for i in order], loc="upper right", frameon=True,
        framealpha=0.9, edgecolor="none",
    )
    save(figure, folder, "shear_angles")


LEDGER = (
    ("friction", ("friction",), "#999999"),
    ("damping and viscosity", ("contact_damping", "mass_damping", "bulk_viscosity"), "#cccccc"),
    ("shear", ("shear",), BLUE),
    ("yarns", ("yarn",), ORANGE),
    ("bending", ("bending",), GREEN),
    ("kinetic", ("kinetic",), PURPLE),
    ("hourglass and contact", ("hourglass", "contact"), YELLOW),
)


def draw_energy_ledger(energy, summary, folder):
    to_newton = 1000.0
    stroke, time = energy["stroke"], energy["time"]
    # The hold has no stroke of its own: it gets a panel over time beside the main one.
    top = stroke.max()
    end = int(np.argmax(stroke >= top * (1 - 1e-9)))
    has_hold = time[-1] - time[end] > 1e-9 and end + 1 < len(time)
    columns = 2 if has_hold else 1
    figure, axes = plt.subplots(
        2, columns, figsize=(8.6, 6.0), sharey="row", sharex="col", squeeze=False,
        gridspec_kw={"height_ratios": [4, 1], "width_ratios": [9, 1.3][:columns]},
    )
    figure.subplots_adjust(left=0.09, right=0.74, top=0.91, bottom=0.1, wspace=0.05, hspace=0.1)

    stacks = [to_newton * sum(energy[term] for term in terms) for _, terms, _ in LEDGER]
    labels = [label for label, _, _ in LEDGER]
    colours = [colour for _, _, colour in LEDGER]
    punch = to_newton * energy["punch_work"]
    holder = to_newton * energy["holder_work"]
    largest_punch = max(abs(punch).max(), 1e-30)
    share = to_newton * energy["residual"] / largest_punch
    spans = [(stroke, slice(0, end + 1))]
    if has_hold:
        spans.append((time - time[end], slice(end, None)))
    for column, (x, part) in enumerate(spans):
        upper, lower = axes[0, column], axes[1, column]
        upper.stackplot(
            x[part], [stack[part] for stack in stacks], colors=colours, labels=labels, linewidth=0
        )
        upper.plot(x[part], punch[part], color=BLACK, linewidth=1.8, label="punch work")
        upper.plot(
            x[part], (punch + holder)[part], color=BLACK, linewidth=1.2, linestyle=(0, (4, 2)),
            label="punch and holder work",
        )
        lower.plot(x[part], share[part], color=RED, linewidth=1.2)
        lower.axhline(0, color=BLACK, linewidth=0.6)
        lower.set_xlim(x[part][0], x[part][-1])
        lower.set_xlabel("stroke [mm]" if column == 0 else "hold [ms]")
    axes[0, 0].set_ylabel("energy of the quarter [N mm]")
    axes[1, 0].set_ylabel("residual /\npunch work [-]")
    axes[1, 0].ticklabel_format(axis="y", style="sci", scilimits=(-2, 2))
    axes[0, 0].set_ylim(bottom=min(0, axes[0, 0].get_ylim()[0]))
    if has_hold:
        for row in (0, 1):
            axes[row, 1].tick_params(left=False)
            axes[row, 1].spines["left"].set_color(GREY)
        axes[1, 1].xaxis.set_major_locator(FixedLocator([time[-1] - time[end]]))
        axes[1, 1].xaxis.set_major_formatter(FormatStrFormatter("%.3g"))
    handles, names = axes[0, 0].get_legend_handles_labels()
    stacked = len(LEDGER)
    order = list(range(stacked, len(names))) + list(reversed(range(stacked)))
    figure.legend(
        [handles[i] for i in order], [names[i] for i in order], loc="upper left",
        bbox_to_anchor=(0.745, 0.9), frameon=False,
    )
    largest = summary["ledger"]["residual_over_punch_work"]
    figure.text(0.755, 0.14, f"largest residual\n{largest:.1e} of the\npunch work", fontsize=9)
    figure.suptitle(f"Energy ledger: {title(summary)}", fontsize=11)
    save(figure, folder, "energy_ledger")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = Path(arguments[0])
    try:
        summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
        outline, energy = table(folder / "outline.csv"), table(folder / "energy.csv")
        part = Part(folder)
    except (OSError, KeyError, IndexError, ValueError) as error:
        sys.exit(f"pictures.py: {folder} holds no complete result of crossbeam-drape: {error!r}")
    plt.rcParams.update(STYLE)
    draw_formed_part(part, summary, folder)
    draw_outline(outline, summary, folder)
    draw_shear_angles(summary, folder)
    draw_energy_ledger(energy, summary, folder)


if __name__ == "__main__":
    main(sys.argv[1:])

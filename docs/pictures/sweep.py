#!/usr/bin/env python3
"""Draws sweep.svg, the picture of docs/glossary.md: python3 docs/pictures/sweep.py"""

import os

COLOURS = ["#9ecae1", "#fdd0a2", "#c7e9c0", "#dadaeb", "#fdae6b", "#bcbddc"]
GREY, LINE = "#eeeeee", "#444444"
out = []


def rect(x, y, width, height, fill, stroke=LINE, stroke_width=1):
    out.append(f'<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}" '
               f'stroke="{stroke}" stroke-width="{stroke_width}"/>')


def text(x, y, words, size=13, anchor="start", weight="normal", fill="#111111"):
    out.append(f'<text x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}" '
               f'font-weight="{weight}" fill="{fill}">{words}</text>')


def line(x1, y1, x2, y2, width=1.0):
    out.append(f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" stroke="{LINE}" '
               f'stroke-width="{width}"/>')


def heading(y, words):
    text(20, y, words, 16, weight="bold")


def mesh_rows(top):
    """Five elements to a row, so six nodes; four lanes: three batches hold two rows."""
    heading(top, "1  Mesh rows to batches (4 lanes)")
    cell = 46
    for row in range(4):
        for e in range(5):
            lane = 6 * row + e  # the element's first node
            x, y = 40 + e * cell, top + 28 + row * cell
            rect(x, y, cell, cell, COLOURS[lane // 4])
            text(x + cell / 2, y + cell / 2 + 5, str(5 * row + e), 13, "middle")
        for n in range(6):
            text(40 + n * cell + 3, top + 24 + row * cell + 15, str(6 * row + n), 9, fill="#666666")
    text(40, top + 232, "small: nodes, numbered along the row", 12)
    text(40, top + 248, "large: elements = tuples of 4 nodes", 12)
    for b in range(6):
        y = top + 30 + 34 * b
        text(330, y + 18, f"batch {b}")
        for l in range(4):
            lane = 4 * b + l
            row, e = divmod(lane, 6)
            idle = e == 5
            rect(395 + 40 * l, y, 40, 26, GREY if idle else COLOURS[b])
            text(415 + 40 * l, y + 18, "idle" if idle else str(5 * row + e), 12, "middle")
    text(575, top + 50, "A lane holds one tuple; the batch's columns are the", 12)
    text(575, top + 66, "corners: column k of batch b is one load of 4 nodes,", 12)
    text(575, top + 82, "because the nodes of neighbouring lanes are neighbours.", 12)
    text(575, top + 106, "Between two rows of the mesh a lane stays idle.", 12)
    text(575, top + 130, "Where nodes are not neighbours, a batch gathers them", 12)
    text(575, top + 146, "one by one from a table.", 12)


def chunk(top):
    heading(top, "2  Consecutive batches form a chunk, which one loop after the other goes through")
    slot = 30
    for b in range(6):
        for l in range(4):
            s = 4 * b + l
            idle = s % 6 == 5
            rect(200 + slot * s, top + 18, slot, 22, GREY if idle else COLOURS[b])
            text(200 + slot * s + slot / 2, top + 33, str(s), 10, "middle")
    text(40, top + 33, "slots of the chunk")
    loops = ["strains", "elongations", "warp", "weft", "balance of the cell", "shear", "forces"]
    for i, name in enumerate(loops):
        y = top + 52 + 20 * i
        text(40, y + 11, name, 12)
        rect(200, y, 24 * slot, 14, "#ffffff")
        for b in range(6):
            line(200 + 4 * slot * b, y, 200 + 4 * slot * b, y + 14)
    text(40, top + 212, "Each loop leaves rows of numbers in the first-level cache. Columns "
         "whose nodes are less than 8 "
         "apart form a line: a node gets", 12)
    text(40, top + 228, "all their forces at once. Here the corners' nodes n, n + 1, n + 6, n + "
         "7 make one "
         "line; in a mesh with longer rows they make two.", 12)


def levels(top):
    heading(top, "3  Levels of nodes, stages of batches, bands of levels")
    width = 44
    for l in range(18):
        x = 110 + width * l
        rect(x, top + 20, width, 24, COLOURS[l // 6])
        text(x + width / 2, top + 37, str(l), 12, "middle")
    text(40, top + 37, "level")
    for band in range(3):
        x = 110 + 6 * width * band
        line(x, top + 14, x, top + 100, 2.5)
        text(x + 3 * width, top + 96, f"band {band}", 13, "middle", "bold")
    line(110 + 18 * width, top + 14, 110 + 18 * width, top + 100, 2.5)
    text(40, top + 67, "stage")
    for s in range(18):
        seam = s in (6, 12)
        x = 110 + max(width * s - width / 2, 0)
        wide = width if s else width / 2  # stage 0: batches inside level 0
        rect(x + 2, top + 52, wide - 4, 22, "#fb6a4a" if seam else "#ffffff")
        text(x + wide / 2, top + 68, str(s), 12, "middle")
    text(40, top + 122, "A batch touches one level or two neighbours; its stage is the higher "
         "one. When "
         "stage s is done, level s - 1 has all its forces", 12)
    text(40, top + 138, "and is finished: contact, velocities, positions. Threads take a band "
         "each; a stage "
         "that reads two bands is a seam (red) and waits.", 12)


def flights(top):
    heading(top, "4  Steps in flight: step n + 1 begins before step n has ended, a lag behind it")
    width, lag = 44, 3
    order = [0, 1, 2, 3, 4, 5, 7, 6, 8, 9, 10, 11, 13, 12, 14, 15, 16, 17]  # seams one turn later
    for flight in range(3):
        y = top + 24 + 34 * flight
        text(40, y + 17, ["step n", "step n + 1", "step n + 2"][flight])
        for turn in range(18):
            x = 130 + width * turn
            at = turn - lag * flight
            live = 0 <= at < 18
            rect(x, y, width, 24, COLOURS[flight] if live else "#ffffff", "#bbbbbb")
            if live:
                text(x + width / 2, y + 17, str(order[at]), 12, "middle")
    text(130, top + 142, "time; the number is the stage whose turn it is. A seam comes one turn "
         "later. The steps "
         "work within a few levels, which", 12)
    text(130, top + 158, "stay in the cache.", 12)


mesh_rows(30)
chunk(320)
levels(590)
flights(770)
here = os.path.dirname(os.path.abspath(__file__))
with open(os.path.join(here, "sweep.svg"), "w", encoding="utf-8") as file:
    file.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 940" width="960" '
               'height="940" font-family="sans-serif">\n'
               '<rect x="0" y="0" width="960" height="940" fill="#ffffff"/>\n'
               + "\n".join(out) + "\n</svg>\n")

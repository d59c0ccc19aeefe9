# SPDX-License-Identifier: BSD-3-Clause
"""Figures as PNG. Every function takes rows or series and a file; none keeps state."""
import textwrap

from . import stats, tables

SIZE = (7.0, 4.0)
DPI = 110


def subplots(*counts, **options):
    """pyplot's, without a window; loaded here so that --list does not need it."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    return pyplot.subplots(*counts, **options)


def save(figure, path):
    from matplotlib import pyplot
    figure.tight_layout()
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    pyplot.close(figure)


def finish(figure, axes, path, xlabel, ylabel, log=False):
    axes.set_xlabel(xlabel)
    axes.set_ylabel(ylabel)
    axes.grid(alpha=0.3)
    if log:
        axes.set_yscale("log")
    handles, labels = axes.get_legend_handles_labels()
    if labels:
        axes.legend(handles, labels, fontsize=8)
    save(figure, path)


def middle_and_arms(values):
    """Median and its distances to the quartiles."""
    middle, low, high = (stats.quantile(values, s) for s in (0.5, 0.25, 0.75))
    return middle, middle - low, high - middle


def bars(path, rows, x, group, value, ylabel, log=False):
    """Groups of bars: medians, with arms to the quartiles."""
    figure, axes = subplots(figsize=SIZE)
    places = list(dict.fromkeys(r[x] for r in rows))
    names = list(dict.fromkeys(r[group] for r in rows))
    width = 0.8 / max(1, len(names))
    for n, name in enumerate(names):
        for p, place in enumerate(places):
            values = stats.present(r.get(value) for r in rows if r[group] == name and r[x] == place)
            if not values:
                continue
            middle, down, up = middle_and_arms(values)
            axes.bar(p + (n - (len(names) - 1) / 2) * width, middle, width, color=f"C{n}", yerr=[[down], [up]],
                     capsize=2, label=name if f"{name}" not in axes.get_legend_handles_labels()[1] else None)
    axes.set_xticks(range(len(places)), [str(p) for p in places])
    finish(figure, axes, path, x, ylabel, log)


def lines(path, rows, x, group, value, xlabel, ylabel, log=False, limit=None):
    """Medians over x, one line a group, with a band between the quartiles; `limit`: a dashed level."""
    figure, axes = subplots(figsize=SIZE)
    for name in dict.fromkeys(r[group] for r in rows):
        points = []
        for (place,), members in tables.grouped([r for r in rows if r[group] == name], [x]):
            values = stats.present(r.get(value) for r in members)
            if values:
                points.append((place, *middle_and_arms(values)))
        points.sort()
        if not points:
            continue
        places, middle, down, up = zip(*points)
        line, = axes.plot(places, middle, marker="o", label=str(name))
        axes.fill_between(places, [m - d for m, d in zip(middle, down)], [m + u for m, u in zip(middle, up)],
                          color=line.get_color(), alpha=0.2)
    if limit is not None:
        axes.axhline(limit, color="grey", linestyle="--")
    finish(figure, axes, path, xlabel, ylabel, log)


def boxes(path, rows, group, value, ylabel, limits=(), log=False):
    """A box a group: quartiles, whiskers to the extremes."""
    figure, axes = subplots(figsize=SIZE)
    groups = [(k, stats.present(r.get(value) for r in g)) for (k,), g in tables.grouped(rows, [group])]
    groups = [(k, v) for k, v in groups if v]
    axes.boxplot([v for _, v in groups], whis=(0, 100))
    axes.set_xticks(range(1, len(groups) + 1), [textwrap.fill(str(k), 12) for k, _ in groups], fontsize=8)
    for limit in limits:
        axes.axhline(limit, color="grey", linestyle="--")
    finish(figure, axes, path, "", ylabel, log)


def over_time(path, panels, ylabel):
    """One panel a title: {title: {label: [(seconds, value)]}}; a value that is None leaves a gap."""
    figure, panel_axes = subplots(len(panels), 1, figsize=(SIZE[0], 0.8 + 1.7 * len(panels)), squeeze=False)
    for axes, (title, series) in zip(panel_axes[:, 0], panels.items()):
        for label, points in series.items():
            axes.plot([t for t, _ in points], [float("nan") if v is None else v for _, v in points],
                      linewidth=1, label=label)
        axes.set_title(title, fontsize=9)
        axes.set_ylabel(ylabel)
        axes.set_ylim(-0.02, 1.02)
        axes.grid(alpha=0.3)
    panel_axes[0, 0].legend(fontsize=8)
    panel_axes[-1, 0].set_xlabel("s")
    save(figure, path)

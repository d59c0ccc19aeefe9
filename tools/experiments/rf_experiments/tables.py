# SPDX-License-Identifier: BSD-3-Clause
"""Rows (dictionaries) to CSV and to Markdown with medians and quartiles."""
import csv

from . import stats


def text_of(value):
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


def value_of(text):
    """The inverse of text_of for numbers, words, and truth values."""
    if text == "":
        return None
    if text in ("True", "False"):
        return text == "True"
    try:
        return int(text)
    except ValueError:
        pass
    try:
        return float(text)
    except ValueError:
        return text


def columns_of(rows):
    """All keys in the order of their first appearance."""
    return list(dict.fromkeys(key for row in rows for key in row))


def write_csv(path, rows):
    columns = columns_of(rows)
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([text_of(row.get(c)) for c in columns] for row in rows)


def read_csv(path):
    with open(path, newline="") as file:
        return [{k: value_of(v) for k, v in row.items()} for row in csv.DictReader(file)]


def markdown(head, body):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in body]) + "\n"


def spread(values, digits):
    """`median [lower quartile, upper quartile]`, the value alone when there is one, a dash when there is none."""
    known = stats.present(values)
    if not known:
        return "-"
    middle, low, high = (stats.quantile(known, s) for s in (0.5, 0.25, 0.75))
    if len(known) == 1:
        return f"{middle:.{digits}f}"
    return f"{middle:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


def grouped(rows, by):
    """[(values of `by`, rows)], in the order of first appearance."""
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row.get(b) for b in by), []).append(row)
    return list(groups.items())


def table(rows, by, columns):
    """One line a group. `columns`: (head, key, digits), or (head, function of the group's rows giving text)."""
    body = []
    for key, group in grouped(rows, by):
        cells = [text_of(k) for k in key] + [str(len(group))]
        for column in columns:
            cells.append(column[1](group) if callable(column[1]) else
                         spread([r.get(column[1]) for r in group], column[2]))
        body.append(cells)
    return markdown([*by, "n", *(c[0] for c in columns)], body)


def per_cent(key):
    """A column function: share of the rows in which the key is true."""
    def cell(rows):
        part = stats.share(r.get(key) for r in rows)
        return "-" if part is None else f"{100 * part:.0f} %"
    return cell


def total(key):
    def cell(rows):
        return str(sum(r.get(key) or 0 for r in rows))
    return cell

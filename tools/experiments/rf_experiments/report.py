# SPDX-License-Identifier: BSD-3-Clause
"""What an experiment writes: text with tables, and pictures beside it."""
from . import plots, tables


class Report:
    def __init__(self, folder, name, title):
        self.folder = folder
        self.name = name
        self.parts = [f"# {title}\n"]

    def text(self, words):
        self.parts.append(words + "\n")

    def table(self, rows, by, columns):
        self.parts.append(tables.table(rows, by, columns))

    def plot(self, suffix, draw, *arguments, **options):
        """Draws with a function of plots.py into <name>-<suffix>.png."""
        file = f"{self.name}-{suffix}.png"
        draw(self.folder / file, *arguments, **options)
        self.parts.append(f"![{suffix}]({file})\n")

    def write(self, rows):
        tables.write_csv(self.folder / f"{self.name}.csv", rows)
        (self.folder / f"{self.name}.md").write_text("\n".join(self.parts))


CAMERA_COLUMNS = [("ATE 1st, cm", "camera_ate_first_cm", 2), ("ATE SE3, cm", "camera_ate_se3_cm", 2),
                  ("RPE, cm/s", "camera_rpe_cm_per_s", 2), ("RPE, deg/s", "camera_rpe_deg_per_s", 2)]
OBJECT_COLUMNS = [("object ATE, cm", "object_ate_first_cm", 2), ("object RPE, cm/s", "object_rpe_cm_per_s", 2)]
MASK_COLUMNS = [("IoU", "iou_moving", 3), ("acc. static", "static_accuracy_moving", 3),
                ("acc. dynamic", "dynamic_accuracy_moving", 3)]

bars, lines, boxes, over_time = plots.bars, plots.lines, plots.boxes, plots.over_time

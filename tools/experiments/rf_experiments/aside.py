# SPDX-License-Identifier: BSD-3-Clause
"""Files and folders in the making. Their names say which process makes them, so that what a call that was
killed has left can be told from what another one works on."""
import os
import pathlib
import shutil

PREFIX = ".rf-experiments-"


def path(folder, name):
    """Where `name` of that folder is made before it is renamed; nothing is there."""
    aside = folder / f"{PREFIX}{name}-{os.getpid()}"
    shutil.rmtree(aside, ignore_errors=True)
    return aside


def remove_left(folder):
    """Removes what processes that are no more have left in a folder."""
    for item in folder.glob(f"{PREFIX}*"):
        process = item.name.split(".")[1].rsplit("-", 1)[1]
        if pathlib.Path("/proc", process).exists():
            continue
        if item.is_dir():
            shutil.rmtree(item, ignore_errors=True)
        else:
            item.unlink(missing_ok=True)

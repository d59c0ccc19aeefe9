#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fails when a room of common/ links or includes what it must not know.

usage: check_rooms.py LINKS_FILE COMMON_DIR

LINKS_FILE lists, in the build's order of rooms, each room's targets and all that they link.
Rules: a room knows only rooms before it; only messaging links LCM or includes lcm or lcmtypes.
"""
import pathlib
import re
import sys

LCM = re.compile(r"(^|[:/_.-])(lib)?lcm(types)?($|[:/_.-])", re.IGNORECASE)
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
KNOWS_LCM = {"messaging"}


def read_links(path):
    """[(room, target, [linked])] in the order of the build."""
    rows, room = [], None
    for line in path.read_text().splitlines():
        if not line.startswith(" "):
            room = line.rstrip(":")
            rows.append((room, None, []))
        else:
            target, _, linked = line.strip().partition(":")
            rows.append((room, target, linked.split()))
    return rows


def check_links(rows):
    order = list(dict.fromkeys(room for room, _, _ in rows))
    owner = {target: room for room, target, _ in rows if target}
    for room, target, linked in rows:
        for library in linked:
            if room not in KNOWS_LCM and LCM.search(library):
                yield f"{target} (room {room}) links {library}: only messaging may know LCM"
            other = owner.get(library.replace("rf::", "rf_"))
            if other and order.index(other) > order.index(room):
                yield f"{target} (room {room}) links {library} of the later room {other}"


def check_includes(rows, common):
    order = list(dict.fromkeys(room for room, _, _ in rows))
    for room in order:
        for source in sorted((common / room).rglob("*.[ch]pp")):
            for name in INCLUDE.findall(source.read_text()):
                first = name.split("/")[0]
                if room not in KNOWS_LCM and re.match(r"(lcm|lcmtypes|rigidfusion|bot_core|pronto)$", first):
                    yield f"{source}: includes {name}: only messaging may know LCM"
                if first in order and order.index(first) > order.index(room):
                    yield f"{source}: includes {name} of the later room {first}"


def main():
    rows = read_links(pathlib.Path(sys.argv[1]))
    if not any(target for _, target, _ in rows):
        sys.exit(f"{sys.argv[1]}: names no target: the check would prove nothing")
    problems = [*check_links(rows), *check_includes(rows, pathlib.Path(sys.argv[2]))]
    print("\n".join(problems) or f"{len(rows)} rows, all arrows point one way")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Table of llvm-cov's export: lines, regions and branches of onboard-core per module.

    tests/coverage.py EXPORT.json COMPILER [--write]

Called by tests/coverage.sh, which says what is counted.
"""
import json
import pathlib
import re
import sys

SOURCE = pathlib.Path("onboard-core/src")
PAGE = pathlib.Path("docs/validation/coverage.md")
BEGIN, END = "<!-- table -->\n", "<!-- end of table -->\n"
# A region is [line, column, end line, end column, runs, file, expanded file, kind]; a branch has its
# runs taken and not taken in places 4 and 5.
CODE = 0


def test_files():
    """Files that are tests alone: their `mod` stands behind `#[cfg(test)]`."""
    for path in SOURCE.rglob("*.rs"):
        home = path.parent if path.stem in ("lib", "mod") else path.with_suffix("")
        for name in re.findall(r"#\[cfg\(test\)\]\s*(?:pub(?:\([a-z]+\))? )?mod (\w+);", path.read_text()):
            yield (home / f"{name}.rs").resolve()


def flight_lines(path):
    """Lines before the first `#[cfg(test)]` on a module or function; tests stand at the file's foot."""
    previous = ""
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if re.match(r"mod \w+ \{", line) and previous == "#[cfg(test)]":
            return number
        previous = line.strip()
    return sys.maxsize


def add(counts, place, runs):
    counts[place] = counts.get(place, 0) + runs


def main():
    export = json.loads(pathlib.Path(sys.argv[1]).read_text())["data"][0]
    tests = set(test_files())
    ends, files = {}, {}
    for function in export["functions"]:
        for index, name in enumerate(function["filenames"]):
            path = pathlib.Path(name).resolve()
            if SOURCE.resolve() not in path.parents or path in tests:
                continue
            end = ends.setdefault(path, flight_lines(path))
            regions, branches = files.setdefault(path, ({}, {}))
            for region in function["regions"]:
                if region[5] == index and region[7] == CODE and region[0] < end:
                    add(regions, tuple(region[:4]), region[4])
            for branch in function["branches"]:
                if branch[6] == index and branch[0] < end:
                    add(branches, (*branch[:4], True), branch[4])
                    add(branches, (*branch[:4], False), branch[5])
    rows = {}
    for path, (regions, branches) in files.items():
        module = path.relative_to(SOURCE.resolve()).parts[0].removesuffix(".rs")
        lines = {}
        # The innermost region that covers a line says whether it was run: the last by its start.
        for (first, _, last, _), runs in sorted(regions.items()):
            for line in range(first, last + 1):
                lines[line] = runs
        counts = rows.setdefault(module, [0] * 6)
        for place, measured in enumerate((lines, regions, branches)):
            counts[2 * place] += sum(runs > 0 for runs in measured.values())
            counts[2 * place + 1] += len(measured)
    total = [sum(column) for column in zip(*rows.values())]
    table = [
        f"{sys.argv[2]}.",
        "",
        "| module | lines | regions | branches |",
        "|---|---|---|---|",
    ]
    for module, counts in [*sorted(rows.items()), ("**all**", total)]:
        cells = [
            f"{run} of {all} ({100 * run / all:.1f} %)" if all else "none"
            for run, all in zip(counts[::2], counts[1::2])
        ]
        table.append(f"| {module} | {' | '.join(cells)} |")
    text = "\n".join(table) + "\n"
    if "--write" in sys.argv:
        page = PAGE.read_text()
        head, rest = page.split(BEGIN)
        PAGE.write_text(head + BEGIN + text + END + rest.split(END)[1])
    else:
        print(text, end="")
    for path, (regions, branches) in sorted(files.items()):
        if "--missed" in sys.argv:
            name = path.relative_to(SOURCE.resolve())
            for (line, column, *_), runs in sorted(regions.items()):
                if runs == 0:
                    print(f"{name}:{line}:{column} not run")
            for (line, column, _, _, taken), runs in sorted(branches.items()):
                if runs == 0:
                    print(f"{name}:{line}:{column} never {str(taken).lower()}")


main()

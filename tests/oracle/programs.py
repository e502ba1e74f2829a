"""Optima of the programmes in planner/tests/program.rs, by HiGHS.

    cargo run --release -p planner --example programmes -- folder
    python3 tests/oracle/programs.py folder > tests/data/program_optima.csv

Needs highspy 1.15 from PyPI. Each file holds one programme: the values, then a row per line, its
limit first, then choice:coefficient. Columns: name, best value, proved bound.
"""

import pathlib
import sys

import highspy
import numpy


def solve(path, seconds):
    lines = path.read_text().splitlines()
    values = [float(word) for word in lines[0].split()]
    starts, indices, coefficients, limits = [0], [], [], []
    for line in lines[1:]:
        limit, *terms = line.split()
        limits.append(float(limit))
        for term in terms:
            choice, coefficient = term.split(":")
            indices.append(int(choice))
            coefficients.append(float(coefficient))
        starts.append(len(indices))
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = len(values), len(limits)
    lp.sense_ = highspy.ObjSense.kMaximize
    lp.col_cost_ = numpy.array(values)
    lp.col_lower_ = numpy.zeros(len(values))
    lp.col_upper_ = numpy.ones(len(values))
    lp.row_lower_ = numpy.full(len(limits), -highspy.kHighsInf)
    lp.row_upper_ = numpy.array(limits)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
    lp.a_matrix_.start_ = numpy.array(starts)
    lp.a_matrix_.index_ = numpy.array(indices)
    lp.a_matrix_.value_ = numpy.array(coefficients)
    lp.integrality_ = [highspy.HighsVarType.kInteger] * len(values)
    highs = highspy.Highs()
    highs.setOptionValue("output_flag", False)
    highs.setOptionValue("mip_rel_gap", 1e-9)
    highs.setOptionValue("time_limit", seconds)
    highs.setOptionValue("threads", 1)
    highs.passModel(lp)
    highs.run()
    info = highs.getInfo()
    return info.objective_function_value, info.mip_dual_bound, highs.getRunTime()


def main():
    print("# remade by tests/oracle/programs.py, HiGHS", highspy.Highs().version())
    print("name,best,bound")
    for path in sorted(pathlib.Path(sys.argv[1]).glob("*.txt")):
        best, bound, seconds = solve(path, float(sys.argv[2]) if len(sys.argv) > 2 else 600.0)
        print(f"{path.stem},{best:.6f},{bound:.6f}", flush=True)
        print(f"{path.stem}: {seconds:.1f} s", file=sys.stderr)


main()

"""casadi_optimum.py PROBLEMS RESULTS: solves the problems of an .npz by CasADi with IPOPT, a row each, and writes the
controls to another. A process of its own, since CasADi does not load into one that has loaded OpenSim.

    least sum |x|^exponent   with   matrix x = wanted,   low <= x <= high"""

import sys

import casadi
import numpy

OPTIONS = {
    "print_time": False,
    "ipopt": {"print_level": 0, "sb": "yes", "tol": 1e-13, "constr_viol_tol": 1e-13, "bound_relax_factor": 0.0},
}


def optimum(matrix, wanted, low, high, exponent):
    # Controls of size one and rows of size one, or the tolerances would mean nothing.
    size = numpy.abs(matrix).max(axis=1, keepdims=True)
    x = casadi.MX.sym("x", matrix.shape[1])
    cost = casadi.sum1(casadi.fabs(x) ** exponent)
    solver = casadi.nlpsol("s", "ipopt", {"x": x, "f": cost, "g": casadi.DM(matrix / size) @ x}, OPTIONS)
    goal = wanted / size[:, 0]
    found = solver(x0=numpy.clip(0.1, low, high), lbx=low, ubx=high, lbg=goal, ubg=goal)
    assert solver.stats()["return_status"] == "Solve_Succeeded", solver.stats()["return_status"]
    return numpy.array(found["x"])[:, 0]


def main(problems, results):
    p = numpy.load(problems)
    rows = [optimum(m, w, p["low"], p["high"], p["exponent"]) for m, w in zip(p["matrix"], p["wanted"], strict=True)]
    numpy.savez(results, controls=rows)


if __name__ == "__main__":
    main(*sys.argv[1:])

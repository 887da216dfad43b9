// The unit cell as a differential-algebraic system: masses at the yarns' ends obey Newton's law,
// the crimp heights are algebraic unknowns that keep the yarns in equilibrium at every instant
// (index 1). IDA solves both together; the condensed cell solves the heights inside its own call.
// They have to agree. The tangent jumps where the yarns lose contact: a root function finds the
// instant, and the integration starts anew with the other equation for the contact. Needs SUNDIALS.
// Units kN, mm, ms, kg.

#include "crossbeam/crossbeam.hpp"

#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.hpp>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

using Cell = crossbeam::CrossedBeamCell<double>;

constexpr double mass = 1e-3, damping = 2e-2;  // at the end of each yarn

constexpr double stretched = 0.02;  // both yarns at the start [mm]

/// What the solver's functions share.
struct Problem {
  const Cell& cell;
  double force[2];     // that hold the yarns at the start [kN]
  bool closed = true;  // contact

  explicit Problem(const Cell& c) : cell(c) {
    const auto at = cell.solve(stretched, stretched);
    force[0] = at.forces.F1;
    force[1] = at.forces.F2;
  }
  /// Lets go of both yarns until they are slack, and pulls again.
  [[nodiscard]] double pull(int yarn, double t) const {
    return force[yarn] *
           (yarn == 0 ? 0.48 + 0.52 * std::cos(0.8 * t) : 0.5 + 0.5 * std::cos(0.7 * t));
  }
};

/// Unknowns y = (u1, u2, v1, v2, w1, w2): elongations, velocities, crimp heights.
int residual(double t, N_Vector y_, N_Vector dy_, N_Vector r_, void* data) {
  const Problem& p = *static_cast<const Problem*>(data);
  const Cell& cell = p.cell;
  const double *y = N_VGetArrayPointer(y_), *dy = N_VGetArrayPointer(dy_);
  double* r = N_VGetArrayPointer(r_);
  const crossbeam::YarnState<double> warp(cell.warp(), y[0], y[4]), weft(cell.weft(), y[1], y[5]);
  const double q = p.closed ? -cell.contact_stiffness() * (y[4] + y[5]) : 0;
  r[0] = dy[0] - y[2];
  r[1] = dy[1] - y[3];
  r[2] = mass * dy[2] + damping * y[2] + warp.horizontal_force(cell.warp()) - p.pull(0, t);
  r[3] = mass * dy[3] + damping * y[3] + weft.horizontal_force(cell.weft()) - p.pull(1, t);
  r[4] = warp.vertical_force(cell.warp()) - q;
  r[5] = weft.vertical_force(cell.weft()) - q;
  return 0;
}

/// Gap between the yarns: its sign says whether they touch.
int gap(double, N_Vector y, N_Vector, double* g, void*) {
  g[0] = N_VGetArrayPointer(y)[4] + N_VGetArrayPointer(y)[5];
  return 0;
}

/// The condensed cell under the same pull: central differences in small steps, damping centred.
struct Condensed {
  const Problem& problem;
  double u[2] = {stretched, stretched}, v[2] = {0, 0}, t = 0;

  void advance(double until, double step) {
    for (; t < until - step / 2; t += step) {
      const auto at = problem.cell.solve(u[0], u[1]);
      const double force[2] = {at.forces.F1, at.forces.F2};
      const double a = damping / mass * step / 2, first = t == 0 ? 0.5 : 1;
      for (int i = 0; i < 2; ++i) {
        v[i] = ((1 - a) * v[i] + first * step * (problem.pull(i, t) - force[i]) / mass) / (1 + a);
        u[i] += step * v[i];
      }
    }
  }
};

}  // namespace

int main() {
  const Cell cell{crossbeam::CellParameters<double>{}};
  Problem problem(cell);
  Condensed condensed{problem};

  sundials::Context context;
  N_Vector y = N_VNew_Serial(6, context), dy = N_VClone(y), kind = N_VClone(y);
  N_VConst(0, y);  // at rest under the forces that hold it: consistent
  N_VConst(0, dy);
  N_VConst(1, kind);
  double* h = N_VGetArrayPointer(y);
  const auto start = cell.solve(stretched, stretched);
  h[0] = h[1] = stretched;
  h[4] = start.forces.w1;
  h[5] = start.forces.w2;
  N_VGetArrayPointer(kind)[4] = N_VGetArrayPointer(kind)[5] = 0;  // algebraic
  SUNMatrix matrix = SUNDenseMatrix(6, 6, context);
  SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
  void* ida = IDACreate(context);
  bool good = IDAInit(ida, residual, 0.0, y, dy) == IDA_SUCCESS &&
              IDASStolerances(ida, 1e-10, 1e-12) == IDA_SUCCESS &&
              IDASetUserData(ida, &problem) == IDA_SUCCESS && IDASetId(ida, kind) == IDA_SUCCESS &&
              IDASetMaxNumSteps(ida, 1000000) == IDA_SUCCESS &&
              IDARootInit(ida, 1, gap) == IDA_SUCCESS &&
              IDASetLinearSolver(ida, solver, matrix) == IDA_SUCCESS;

  std::printf("time [ms]  u_warp [mm]  u_weft [mm]  w_warp [mm]  contact\n");
  double worst = 0;
  int changes = 0;
  for (int k = 1; k <= 8 && good; ++k) {
    double t = 0;
    int flag = IDA_ROOT_RETURN;
    while ((flag = IDASolve(ida, k, &t, y, dy, IDA_NORMAL)) == IDA_ROOT_RETURN) {
      problem.closed = !problem.closed;
      ++changes;
      if (IDAReInit(ida, t, y, dy) != IDA_SUCCESS) break;
    }
    good = flag == IDA_SUCCESS;
    condensed.advance(k, 1e-5);
    const auto at = cell.solve(condensed.u[0], condensed.u[1]);
    std::printf("%9d  %11.6f  %11.6f  %11.6f  %s\n", k, h[0], h[1], h[4],
                problem.closed ? "closed" : "open");
    const double expected[] = {condensed.u[0], condensed.u[1], at.forces.w1, at.forces.w2};
    const int index[] = {0, 1, 4, 5};
    for (int i = 0; i < 4; ++i) worst = std::max(worst, std::abs(h[index[i]] - expected[i]));
  }
  // The scheme's own error, (step times frequency)^2 of some 1e-6, is the larger one.
  const bool agree = good && changes >= 2 && worst < 1e-6;
  std::printf("heights as unknowns and condensed: %s\n", agree ? "agree to 1e-6 mm" : "DISAGREE");

  IDAFree(&ida);
  SUNLinSolFree(solver);
  SUNMatDestroy(matrix);
  N_VDestroy(kind);
  N_VDestroy(dy);
  N_VDestroy(y);
  return agree ? EXIT_SUCCESS : EXIT_FAILURE;
}

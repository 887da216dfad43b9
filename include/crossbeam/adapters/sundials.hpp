#pragma once
/// @file
/// Reference integrators and statics by SUNDIALS (6.4 or later, 7 included): opt-in, not part of the
/// umbrella. A program that includes it links crossbeam::sundials (find_package(crossbeam COMPONENTS
/// sundials)). Theory: docs/theory/reference.md, [R-3].

#include "crossbeam/base/scalar.hpp"
#include "crossbeam/model/first_order_system.hpp"
#include "crossbeam/model/statics.hpp"

#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <ida/ida.h>
#include <kinsol/kinsol.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_context.hpp>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace crossbeam::reference {

namespace detail {

inline void ensure(int flag, const std::string& call) {
  if (flag < 0) throw RunError("SUNDIALS: " + call + " returned " + std::to_string(flag));
}
template <class P>
P* ensure(P* pointer, const std::string& call) {
  if (!pointer) throw RunError("SUNDIALS: " + call + " returned nothing");
  return pointer;
}

/// @name Vector operations in one pass each; those of the library take several
/// @{
inline int linear_combination(int count, sunrealtype* c, N_Vector* X, N_Vector z) {
  constexpr int most = 16;
  if (count > most) return -1;
  const sunrealtype* x[most];
  for (int k = 0; k < count; ++k) x[k] = N_VGetArrayPointer(X[k]);
  sunrealtype* out = N_VGetArrayPointer(z);
  const sunindextype n = N_VGetLength(z);
  // In strips that stay in the cache; z may be one of the X, so a strip is summed before it is
  // stored.
  constexpr sunindextype strip = 256;
  sunrealtype sum[strip];
  for (sunindextype begin = 0; begin < n; begin += strip) {
    const sunindextype width = minimum(strip, n - begin);
    for (sunindextype i = 0; i < width; ++i) sum[i] = c[0] * x[0][begin + i];
    for (int k = 1; k < count; ++k)
      for (sunindextype i = 0; i < width; ++i) sum[i] += c[k] * x[k][begin + i];
    std::copy(sum, sum + width, out + begin);
  }
  return 0;
}
inline void linear_sum(sunrealtype a, N_Vector X, sunrealtype b, N_Vector Y, N_Vector Z) {
  const sunrealtype *x = N_VGetArrayPointer(X), *y = N_VGetArrayPointer(Y);
  sunrealtype* z = N_VGetArrayPointer(Z);
  const sunindextype n = N_VGetLength(Z);
  for (sunindextype i = 0; i < n; ++i) z[i] = a * x[i] + b * y[i];
}
inline void scale(sunrealtype c, N_Vector X, N_Vector Z) {
  const sunrealtype* x = N_VGetArrayPointer(X);
  sunrealtype* z = N_VGetArrayPointer(Z);
  const sunindextype n = N_VGetLength(Z);
  for (sunindextype i = 0; i < n; ++i) z[i] = c * x[i];
}
inline sunrealtype wrms_norm(N_Vector X, N_Vector W) {
  const sunrealtype *x = N_VGetArrayPointer(X), *w = N_VGetArrayPointer(W);
  const sunindextype n = N_VGetLength(X);
  constexpr int lanes = 8;  // independent sums, which a compiler may not make of one
  sunrealtype sum[lanes] = {};
  sunindextype i = 0;
  for (; i + lanes <= n; i += lanes)
    for (int l = 0; l < lanes; ++l) sum[l] += (x[i + l] * w[i + l]) * (x[i + l] * w[i + l]);
  for (; i < n; ++i) sum[0] += (x[i] * w[i]) * (x[i] * w[i]);
  sunrealtype total = 0;
  for (sunrealtype s : sum) total += s;
  return std::sqrt(total / static_cast<sunrealtype>(n));
}
/// @}

}  // namespace detail

/// A serial vector with fast operations, which its clones inherit.
class Vector {
 public:
  Vector(std::int64_t n, SUNContext context)
      : v_(detail::ensure(N_VNew_Serial(n, context), "N_VNew_Serial")) {
    v_->ops->nvlinearcombination = detail::linear_combination;
    v_->ops->nvlinearsum = detail::linear_sum;
    v_->ops->nvscale = detail::scale;
    v_->ops->nvwrmsnorm = detail::wrms_norm;
    N_VConst(0, v_);
  }
  ~Vector() { N_VDestroy(v_); }
  Vector(const Vector&) = delete;
  Vector& operator=(const Vector&) = delete;

  operator N_Vector() const { return v_; }
  [[nodiscard]] double* data() { return N_VGetArrayPointer(v_); }
  [[nodiscard]] const double* data() const { return N_VGetArrayPointer(v_); }

 private:
  N_Vector v_;
};

namespace detail {

/// Sparse matrix and KLU solver of one pattern, which the first Jacobian fixes.
class SparseSolver {
 public:
  SparseSolver(N_Vector y, std::int64_t n, std::int64_t entries, SUNContext context)
      : matrix_(ensure(SUNSparseMatrix(n, n, entries, CSC_MAT, context), "SUNSparseMatrix")),
        solver_(ensure(SUNLinSol_KLU(y, matrix_, context), "SUNLinSol_KLU")) {
    constexpr int approximate_minimum_degree = 0;
    ensure(SUNLinSol_KLUSetOrdering(solver_, approximate_minimum_degree), "KLUSetOrdering");
  }
  ~SparseSolver() {
    SUNLinSolFree(solver_);
    SUNMatDestroy(matrix_);
  }
  SparseSolver(const SparseSolver&) = delete;
  SparseSolver& operator=(const SparseSolver&) = delete;
  [[nodiscard]] SUNMatrix matrix() const { return matrix_; }
  [[nodiscard]] SUNLinearSolver solver() const { return solver_; }

 private:
  SUNMatrix matrix_;
  SUNLinearSolver solver_;
};

/// Copies a compressed matrix; SUNDIALS reallocates where it has more entries than fit.
template <class Matrix>
int copy_to(const Matrix& from, SUNMatrix to) {
  if (SUNSparseMatrix_NNZ(to) < from.nonZeros() &&
      SUNSparseMatrix_Reallocate(to, from.nonZeros()) != 0)
    return -1;
  std::copy(from.outerIndexPtr(), from.outerIndexPtr() + from.outerSize() + 1,
            SUNSparseMatrix_IndexPointers(to));
  std::copy(from.innerIndexPtr(), from.innerIndexPtr() + from.nonZeros(),
            SUNSparseMatrix_IndexValues(to));
  std::copy(from.valuePtr(), from.valuePtr() + from.nonZeros(), SUNSparseMatrix_Data(to));
  return 0;
}

inline bool all_finite(const double* x, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += x[i] * 0;
  return sum == 0;
}

}  // namespace detail

/// Error control of an integrator: |error in y_i| against relative |y_i| + absolute.
struct Tolerances {
  double relative = 1e-8;
  double absolute = 1e-8;  ///< [mm], [mm/ms]
};

struct Statistics {
  long long steps = 0, evaluations = 0, jacobians = 0;
};

/// An integrator of a model with its own step control. One per thread.
class Integrator {
 public:
  virtual ~Integrator() = default;
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  /// Integrates to time t [ms] and puts the model there.
  /// @throws RunError with what SUNDIALS says when it cannot
  void advance(double t) {
    if (t > time_) evolve(t);
    system_.write(time_, y_.data());
  }
  [[nodiscard]] double time() const { return time_; }
  [[nodiscard]] Statistics statistics() const {
    return {steps(), system_.evaluations(), system_.jacobians()};
  }
  [[nodiscard]] FirstOrderSystem& system() { return system_; }

 protected:
  Integrator(Model<double>& model, const Tolerances& tolerances)
      : system_(model), y_(system_.size(), context_), tolerances_(tolerances) {
    require_positive("tolerances.relative", tolerances.relative, "-");
    require_positive("tolerances.absolute", tolerances.absolute, "mm");
    system_.read(y_.data());
  }

  virtual void evolve(double t) = 0;
  [[nodiscard]] virtual long long steps() const = 0;

  /// Right-hand side; an answer that is NaN asks for a smaller step.
  static int rate(sunrealtype t, N_Vector y, N_Vector dy, void* self) {
    FirstOrderSystem& system = static_cast<Integrator*>(self)->system_;
    double* out = N_VGetArrayPointer(dy);
    system.rate(t, N_VGetArrayPointer(y), out);
    return detail::all_finite(out, system.size()) ? 0 : 1;
  }

  static constexpr long no_limit = 2'000'000'000;

  ::sundials::Context context_;
  FirstOrderSystem system_;
  Vector y_;
  Tolerances tolerances_;
  double time_ = 0;
};

/// Explicit Runge-Kutta of order 5 by its table's name: the default table of that order changes
/// between releases.
class RungeKutta5 final : public Integrator {
 public:
  explicit RungeKutta5(Model<double>& model, const Tolerances& tolerances = {})
      : Integrator(model, tolerances),
        memory_(detail::ensure(ERKStepCreate(rate, 0.0, y_, context_), "ERKStepCreate")) {
    detail::ensure(ERKStepSetTableName(memory_, "ARKODE_CASH_KARP_6_4_5"), "ERKStepSetTableName");
    detail::ensure(ERKStepSStolerances(memory_, tolerances.relative, tolerances.absolute),
                   "ERKStepSStolerances");
    detail::ensure(ERKStepSetUserData(memory_, static_cast<Integrator*>(this)),
                   "ERKStepSetUserData");
    detail::ensure(ERKStepSetMaxNumSteps(memory_, no_limit), "ERKStepSetMaxNumSteps");
  }
  ~RungeKutta5() override { ERKStepFree(&memory_); }

 private:
  void evolve(double t) override {
    detail::ensure(ERKStepSetStopTime(memory_, t), "ERKStepSetStopTime");
    detail::ensure(ERKStepEvolve(memory_, t, y_, &time_, ARK_NORMAL), "ERKStepEvolve");
  }
  [[nodiscard]] long long steps() const override {
    long n = 0;
    ERKStepGetNumSteps(memory_, &n);
    return n;
  }
  void* memory_;
};

/// Multistep methods of variable order.
class Multistep : public Integrator {
 public:
  ~Multistep() override { CVodeFree(&memory_); }

 protected:
  Multistep(Model<double>& model, const Tolerances& tolerances, int method)
      : Integrator(model, tolerances),
        memory_(detail::ensure(CVodeCreate(method, context_), "CVodeCreate")) {
    detail::ensure(CVodeInit(memory_, rate, 0.0, y_), "CVodeInit");
    detail::ensure(CVodeSStolerances(memory_, tolerances.relative, tolerances.absolute),
                   "CVodeSStolerances");
    detail::ensure(CVodeSetUserData(memory_, static_cast<Integrator*>(this)), "CVodeSetUserData");
    detail::ensure(CVodeSetMaxNumSteps(memory_, no_limit), "CVodeSetMaxNumSteps");
  }
  void evolve(double t) override {
    detail::ensure(CVodeSetStopTime(memory_, t), "CVodeSetStopTime");
    detail::ensure(CVode(memory_, t, y_, &time_, CV_NORMAL), "CVode");
  }
  [[nodiscard]] long long steps() const override {
    long n = 0;
    CVodeGetNumSteps(memory_, &n);
    return n;
  }
  void* memory_;
};

/// Adams-Moulton, order 1 to 12, corrected by a fixed-point iteration.
class Adams final : public Multistep {
 public:
  explicit Adams(Model<double>& model, const Tolerances& tolerances = {})
      : Multistep(model, tolerances, CV_ADAMS),
        corrector_(
            detail::ensure(SUNNonlinSol_FixedPoint(y_, 0, context_), "SUNNonlinSol_FixedPoint")) {
    detail::ensure(CVodeSetNonlinearSolver(memory_, corrector_), "CVodeSetNonlinearSolver");
  }
  ~Adams() override { SUNNonlinSolFree(corrector_); }

 private:
  SUNNonlinearSolver corrector_;
};

/// Backward differences, order 1 to 5, with the consistent tangent and KLU.
class BackwardDifferences final : public Multistep {
 public:
  explicit BackwardDifferences(Model<double>& model, const Tolerances& tolerances = {})
      : Multistep(model, tolerances, CV_BDF), linear_(y_, system_.size(), 1, context_) {
    detail::ensure(CVodeSetLinearSolver(memory_, linear_.solver(), linear_.matrix()),
                   "CVodeSetLinearSolver");
    detail::ensure(CVodeSetJacFn(memory_, jacobian), "CVodeSetJacFn");
  }

 private:
  static int jacobian(sunrealtype t, N_Vector y, N_Vector, SUNMatrix J, void* self, N_Vector,
                      N_Vector, N_Vector) {
    auto& integrator = *static_cast<BackwardDifferences*>(static_cast<Integrator*>(self));
    integrator.system_.jacobian(t, N_VGetArrayPointer(y), integrator.J_);
    return detail::copy_to(integrator.J_, J);
  }
  detail::SparseSolver linear_;
  FirstOrderSystem::Matrix J_;
};

/// The same by residuals, F(t, y, y') = y' - rate(t, y) = 0, with IDA: for models that a user
/// extends by algebraic equations.
class ResidualForm final : public Integrator {
 public:
  explicit ResidualForm(Model<double>& model, const Tolerances& tolerances = {})
      : Integrator(model, tolerances),
        dy_(system_.size(), context_),
        rate_(static_cast<std::size_t>(system_.size())),
        memory_(detail::ensure(IDACreate(context_), "IDACreate")),
        linear_(y_, system_.size(), 1, context_) {
    system_.rate(0, y_.data(), dy_.data());
    detail::ensure(IDAInit(memory_, residual, 0.0, y_, dy_), "IDAInit");
    detail::ensure(IDASStolerances(memory_, tolerances.relative, tolerances.absolute),
                   "IDASStolerances");
    detail::ensure(IDASetUserData(memory_, static_cast<Integrator*>(this)), "IDASetUserData");
    detail::ensure(IDASetMaxNumSteps(memory_, no_limit), "IDASetMaxNumSteps");
    detail::ensure(IDASetLinearSolver(memory_, linear_.solver(), linear_.matrix()),
                   "IDASetLinearSolver");
    detail::ensure(IDASetJacFn(memory_, jacobian), "IDASetJacFn");
  }
  ~ResidualForm() override { IDAFree(&memory_); }

 private:
  static ResidualForm& of(void* self) {
    return *static_cast<ResidualForm*>(static_cast<Integrator*>(self));
  }
  static int residual(sunrealtype t, N_Vector y, N_Vector dy, N_Vector r, void* self) {
    ResidualForm& me = of(self);
    me.system_.rate(t, N_VGetArrayPointer(y), me.rate_.data());
    const double* d = N_VGetArrayPointer(dy);
    double* out = N_VGetArrayPointer(r);
    for (std::size_t i = 0; i < me.rate_.size(); ++i) out[i] = d[i] - me.rate_[i];
    return detail::all_finite(out, static_cast<int>(me.rate_.size())) ? 0 : 1;
  }
  static int jacobian(sunrealtype t, sunrealtype c, N_Vector y, N_Vector, N_Vector, SUNMatrix J,
                      void* self, N_Vector, N_Vector, N_Vector) {
    ResidualForm& me = of(self);
    me.system_.jacobian(t, N_VGetArrayPointer(y), me.J_);
    FirstOrderSystem::Matrix identity(me.J_.rows(), me.J_.cols());
    identity.setIdentity();
    me.J_ = c * identity - me.J_;
    return detail::copy_to(me.J_, J);
  }
  void evolve(double t) override {
    detail::ensure(IDASetStopTime(memory_, t), "IDASetStopTime");
    detail::ensure(IDASolve(memory_, t, &time_, y_, dy_, IDA_NORMAL), "IDASolve");
  }
  [[nodiscard]] long long steps() const override {
    long n = 0;
    IDAGetNumSteps(memory_, &n);
    return n;
  }
  Vector dy_;
  std::vector<double> rate_;
  void* memory_;
  detail::SparseSolver linear_;
  FirstOrderSystem::Matrix J_;
};

struct StaticOptions {
  double tolerance = 1e-10;  ///< largest unbalanced force over the norm of the internal forces [-]
  int iterations = 200;      ///< at most
  static constexpr double no_bound = std::numeric_limits<double>::infinity();
  /// Bound of one iteration's step, the norm over all unknowns [mm]; > 0, or `no_bound`.
  double largest_step = no_bound;
};

struct StaticResult {
  bool converged = false;
  double residual = 0;          ///< relative, as StaticOptions::tolerance
  std::vector<double> history;  ///< norm of the unbalanced forces at every iterate [kN]
  int iterations = 0, backtracks = 0;
};

/// Equilibrium by Newton's method with a line search (KINSOL) and the consistent tangent (KLU). The
/// model is left in the last iterate, converged or not.
inline StaticResult find_equilibrium(StaticProblem& problem, const StaticOptions& options = {}) {
  struct Call {
    StaticProblem& problem;
    StaticProblem::Matrix K;
    std::vector<double> history;

    static int residual(N_Vector q, N_Vector r, void* self) {
      Call& me = *static_cast<Call*>(self);
      me.problem.residual(N_VGetArrayPointer(q), N_VGetArrayPointer(r));
      return detail::all_finite(N_VGetArrayPointer(r), me.problem.unknowns()) ? 0 : 1;
    }
    static int tangent(N_Vector q, N_Vector r, SUNMatrix J, void* self, N_Vector, N_Vector) {
      Call& me = *static_cast<Call*>(self);
      me.history.push_back(std::sqrt(N_VDotProd(r, r)));
      me.problem.tangent(N_VGetArrayPointer(q), me.K);
      return detail::copy_to(me.K, J);
    }
  };
  require_positive("statics.tolerance", options.tolerance, "-");
  const bool is_bounded = options.largest_step != StaticOptions::no_bound;
  if (is_bounded) require_positive("statics.largest_step", options.largest_step, "mm");

  ::sundials::Context context;
  const int n = problem.unknowns();
  Vector q(n, context), ones(n, context), scale(n, context);
  Call call{problem, {}, {}};
  problem.read(q.data());
  N_VConst(1.0, ones);
  StaticResult out;
  std::unique_ptr<void, void (*)(void*)> memory(detail::ensure(KINCreate(context), "KINCreate"),
                                                [](void* m) { KINFree(&m); });
  void* kin = memory.get();
  detail::ensure(KINInit(kin, Call::residual, q), "KINInit");
  detail::ensure(KINSetUserData(kin, &call), "KINSetUserData");
  const detail::SparseSolver linear(q, n, 1, context);
  detail::ensure(KINSetLinearSolver(kin, linear.solver(), linear.matrix()), "KINSetLinearSolver");
  detail::ensure(KINSetJacFn(kin, Call::tangent), "KINSetJacFn");
  detail::ensure(KINSetMaxSetupCalls(kin, 1), "KINSetMaxSetupCalls");  // a new tangent every time
  detail::ensure(KINSetNumMaxIters(kin, options.iterations), "KINSetNumMaxIters");
  detail::ensure(KINSetFuncNormTol(kin, options.tolerance), "KINSetFuncNormTol");
  detail::ensure(KINSetScaledStepTol(kin, 1e-15), "KINSetScaledStepTol");
  // Where yarns pass between taut and slack, short steps are the way and no failure.
  detail::ensure(KINSetMaxBetaFails(kin, options.iterations), "KINSetMaxBetaFails");
  // The result says what came of it, not a line on the terminal.
#if SUNDIALS_VERSION_MAJOR >= 7
  SUNContext_ClearErrHandlers(context);
#else
  detail::ensure(KINSetErrFile(kin, nullptr), "KINSetErrFile");
#endif
  if (is_bounded)
    detail::ensure(KINSetMaxNewtonStep(kin, options.largest_step), "KINSetMaxNewtonStep");

  // The internal forces of the start may be far from those of the end: once more with the latter.
  double internal = problem.internal_force(q.data());
  for (int round = 0; round < 3 && !out.converged; ++round) {
    N_VConst(internal > 0 ? 1 / internal : 1.0, scale);
    const int flag = KINSol(kin, q, KIN_LINESEARCH, ones, scale);
    long iterations = 0, backtracks = 0;
    KINGetNumNonlinSolvIters(kin, &iterations);
    KINGetNumBacktrackOps(kin, &backtracks);
    out.iterations += static_cast<int>(iterations);
    out.backtracks += static_cast<int>(backtracks);
    std::vector<double> r(static_cast<std::size_t>(n));
    internal = problem.internal_force(q.data());
    problem.residual(q.data(), r.data());
    double largest = 0, squared = 0;
    for (double f : r) {
      largest = maximum(largest, std::abs(f));
      squared += f * f;
    }
    out.residual = internal > 0 ? largest / internal : largest;
    out.converged = out.residual <= options.tolerance;
    out.history = call.history;
    out.history.push_back(std::sqrt(squared));
    if (flag != KIN_SUCCESS && flag != KIN_INITIAL_GUESS_OK) break;
  }
  return out;
}

}  // namespace crossbeam::reference
